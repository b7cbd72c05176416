#include "planner_service/run/sole_service.h"

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "planner_service/timing.h"

namespace coppice {

namespace {

constexpr std::size_t most_others = 1000;

/// `one` has precedence over `other`.
bool outranks(const ServiceStatus& one, const ServiceStatus& other) {
  const auto rank = [](const ServiceStatus& s) { return std::tuple(-s.run.epoch, s.since, s.service); };
  return rank(one) < rank(other);
}

}  // namespace

std::string description_of(const ServiceStatus& s, WallTime now) {
  const std::string run = s.run ? fmt::format("its run began {:.0f} s ago", std::max(0.0, now - s.run.epoch))
                                : "it has begun no run yet";
  return fmt::format("process {} on host {} ({})", s.process, s.host, run);
}

void SoleService::on(const Arrival& arrival) {
  if (const auto* other = std::get_if<ServiceStatus>(arrival.message.get())) receive(*other, arrival.at);
  if (const auto* status = std::get_if<AgentStatus>(arrival.message.get())) receive(*status, arrival.at);
}

void SoleService::receive(const ServiceStatus& other, WallTime now) {
  if (other.service == self_.service) return;
  if (others_.size() >= most_others && !others_.contains(other.service)) return;
  const auto [known, is_new] = others_.insert_or_assign(other.service, other);
  if (is_new && outranks(self_, other)) inferiors_.push_back(other);
  next_wake_ = std::min(next_wake_, now);
}

/// An agent that was stopped takes part in no run any more.
void SoleService::receive(const AgentStatus& status, WallTime) {
  const bool drives = status.run && status.phase != Phase::stopped;
  if (drives && !is_of_run(status, self_.run)) agents_have_another_run_ = true;
}

void SoleService::begin(RunId run) {
  if (self_.run == run) return;
  self_.run = run;
  next_wake_ = 0;
}

void SoleService::tell(std::string problem) {
  if (self_.problem == problem) return;
  self_.problem = std::move(problem);
  next_wake_ = 0;
}

std::vector<Message> SoleService::step(WallTime now) {
  next_wake_ = now + service_timing.service_status_interval;
  return {self_};
}

bool SoleService::may_begin(WallTime now) const {
  return now - listens_since_ >=
         (agents_have_another_run_ ? service_timing.listening_for_unknown_run : service_timing.listening);
}

std::optional<ServiceStatus> SoleService::superior() const {
  std::optional<ServiceStatus> first;
  for (const auto& [id, other] : others_) {
    if (outranks(other, first.value_or(self_))) first = other;
  }
  return first;
}

std::vector<ServiceStatus> SoleService::take_inferiors() {
  return std::exchange(inferiors_, {});
}

}  // namespace coppice
