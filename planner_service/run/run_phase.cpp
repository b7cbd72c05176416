#include "planner_service/run/run_phase.h"

namespace coppice {

namespace {

const RunEnd* end_of(const RunPhase& phase) {
  if (const auto* collecting = std::get_if<CollectingTracks>(&phase)) return &collecting->end;
  if (const auto* finished = std::get_if<Finished>(&phase)) return &finished->end;
  return nullptr;
}

bool ended_by(const RunPhase& phase, RunEnd cause) {
  const RunEnd* const end = end_of(phase);
  return end != nullptr && *end == cause;
}

}  // namespace

BegunRun* run_of(RunPhase& phase) {
  if (auto* running = std::get_if<Running>(&phase)) return &running->run;
  if (auto* collecting = std::get_if<CollectingTracks>(&phase)) return &collecting->run;
  return nullptr;
}

const FleetClock* clock_of(const RunPhase& phase) {
  if (const auto* running = std::get_if<Running>(&phase)) return &running->run.clock;
  if (const auto* collecting = std::get_if<CollectingTracks>(&phase)) return &collecting->run.clock;
  if (const auto* finished = std::get_if<Finished>(&phase)) return &finished->clock;
  return nullptr;
}

bool has_ended(const RunPhase& phase) {
  return end_of(phase) != nullptr || std::holds_alternative<NeverBegan>(phase);
}

bool was_interrupted(const RunPhase& phase) {
  if (const auto* waiting = std::get_if<WaitingForTrees>(&phase)) return waiting->interrupted;
  if (const auto* running = std::get_if<Running>(&phase)) return running->interrupted;
  return ended_by(phase, RunEnd::interrupted) || std::holds_alternative<NeverBegan>(phase);
}

bool timed_out(const RunPhase& phase) {
  return ended_by(phase, RunEnd::timed_out);
}

void interrupt(RunPhase& phase) {
  std::visit(
      [](auto& p) {
        if constexpr (requires { p.interrupted; }) p.interrupted = true;
        if constexpr (requires { p.end; }) p.end = RunEnd::interrupted;
      },
      phase);
}

}  // namespace coppice
