#include "robot_agent/process/agent_loop.h"

#include <stdexcept>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace coppice {

namespace {

constexpr std::size_t room_for_states = 64 << 10;  // bytes: half a minute of a robot that drives

}  // namespace

std::optional<TrackingSettings> tracking_of(const RosOptions& options) {
  if (!options.drives()) return std::nullopt;
  return TrackingSettings{.patience = options.patience};
}

RestoredProcess restored_process(const RobotName& robot, const AgentOptions& options,
                                 const std::function<void()>& meanwhile) {
  RestoredProcess restored{journal_in(options.process.state, "robot-" + robot, room_for_states, meanwhile),
                           StateKeeper(robot, options.ros.drives())};
  if (!options.black_boxes.empty()) restored.black_box.emplace(options.black_boxes, robot);
  if (!restored.journal) return restored;
  if (!restored.journal->complete()) {
    throw std::runtime_error(
        fmt::format("{}: the disk was full when it was written, so that it does not say where the robot is: "
                    "remove it once the robot stands where its next mission starts",
                    restored.journal->file().string()));
  }
  restored.journal->for_each([&](const Message& message) {
    restored.chooser.restore({&message, 1});
    meanwhile();
  });
  restored.saved_state = restored.chooser.saved_state();
  if (restored.saved_state && restored.saved_state->mission.robot != robot)
    throw std::runtime_error(fmt::format("{}: is of robot {}: remove it, or name another folder",
                                         restored.journal->file().string(),
                                         restored.saved_state->mission.robot));
  return restored;
}

Listeners::Listeners(RestoredProcess& restored, const AgentOptions& options, DdsBus& bus,
                     const RobotName& robot, const RobotAgent& own, ProcessClock& own_clock)
    : keeper(restored.keeper()),
      ros(options.ros.on ? std::make_unique<RosLink>(bus, robot, options.ros.robot) : nullptr),
      event_log(robot),
      agent(own),
      clock(own_clock),
      black_box(std::move(restored.black_box)) {}

void Listeners::heard(const Message& message) {
  keeper.heard(message);
  event_log.heard(message);
  if (ros) ros->heard(message);
}

void Listeners::said(const Message& message) {
  keeper.said(message);
  // Each decision is said before it takes effect.
  const auto* const state = std::get_if<RobotState>(&message);
  if (black_box && state != nullptr && !state->passed_on && state->copy == 0) {
    if (const auto rest = agent.run()->rest_of_track()) black_box->keep(*rest);
  }
  for (const EventLog::Line& line : event_log.said(message, clock.now()))
    spdlog::log(line.is_warning ? spdlog::level::warn : spdlog::level::info, "{}", line.text);
  if (ros) ros->said(message);
}

void Listeners::tidy() {
  keeper.tidy();
}

}  // namespace coppice
