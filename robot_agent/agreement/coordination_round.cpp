#include "robot_agent/agreement/coordination_round.h"

#include <algorithm>
#include <utility>

#include "robot_agent/agreement/joint_tasks.h"

namespace coppice {

namespace {

// Timeouts: see timing.h.
constexpr double soon = Timing::round_again;
constexpr double long_delay = Timing::plan_delivery;
constexpr double longest_wait_for_plan = Timing::longest_wait_for_plan;
constexpr double least_wait_for_plan = Timing::least_wait_for_plan;

constexpr double cluster_radii = 8;  // between two robots of one cluster

}  // namespace

void CoordinationRound::join(const RoundId& id) {
  leave();
  id_ = id;
  note_epoch(id.epoch);
  stage_ = Stage::waiting;
  waiting_since_.reset();
  planned_since_.reset();
  plan_.reset();
  stranded_ = false;
}

void CoordinationRound::note_epoch(std::uint32_t epoch) {
  if (is_later_epoch(epoch, latest_epoch_)) latest_epoch_ = epoch;
}

void CoordinationRound::leave() {
  stage_ = Stage::free;
  maker_.reset();
  taken_up_.reset();
}

void CoordinationRound::hear(const RobotState& state, const std::optional<Point2>& position) {
  note_epoch(state.round.epoch);
  const bool called_on = state.round != id_ && calls_this(state.round);
  if (called_on && state.stage == Stage::waiting && position && state.round.includes(*position))
    join(state.round);
}

void CoordinationRound::hear(std::shared_ptr<const JointPlanMessage> plan) {
  const bool member =
      std::ranges::find(plan->members, robot_, &JointPlanMessage::Member::robot) != plan->members.end();
  if (calls_this(plan->round) && member) join(plan->round);
  if (plan->round == id_) plan_ = std::move(plan);
}

/// A cluster that was not sorted out, or that formed again, is wider than it seemed.
void CoordinationRound::call(const FleetMember& self, const Path& way, const Fleet& fleet,
                             const MapRoadmaps& roadmaps, double now) {
  if (fleet.known() < 2 || !roadmaps.can_pack(self.radius)) return leave();
  const bool again = called_at_ && now - *called_at_ < soon;
  const double cluster = fleet.cluster_reach(self.position, way, cluster_radii * self.radius);
  const double with_somebody = fleet.nearest(self.position) + self.radius;
  begin(self, std::min(everywhere, std::max({cluster, with_somebody, again ? 2 * id_.reach : 0})), now);
}

void CoordinationRound::call_everybody(const FleetMember& self, double now) {
  begin(self, everywhere, now);
}

void CoordinationRound::begin(const FleetMember& self, double reach, double now) {
  const bool moved = (self.position - called_from_).norm() > self.radius / 2;
  calls_in_vain_ = moved ? 0 : calls_in_vain_ + 1;
  if (moved) called_from_ = self.position;
  join({epoch_after(latest_epoch_), robot_, self.position, reach});
  waiting_since_ = now;
  called_at_ = now;
}

void CoordinationRound::wait(const FleetMember& self, const Fleet& fleet, const Reserver& reserver,
                             MapRoadmaps& roadmaps, double now) {
  if (!waiting_since_) waiting_since_ = now;
  if (plan_) {
    if (!self.stands) return;
    leave();
    taken_up_ = std::exchange(plan_, nullptr);
    const auto own = std::ranges::find(taken_up_->members, robot_, &JointPlanMessage::Member::robot);
    stranded_ = own != taken_up_->members.end() && own->stranded;
    return;
  }
  if (id_.leader == robot_) {
    lead(self, fleet, reserver, roadmaps, now);
    return;
  }
  const auto leader = fleet.find(id_.leader);
  const bool leaderless = !leader || leader->failed || leader->round != id_;
  const bool planned = !leaderless && leader->stage != Stage::waiting;
  if (planned && !planned_since_) planned_since_ = now;
  if ((leaderless && now - *waiting_since_ > fleet.second()) || waits_too_long(fleet, now)) {
    call(self, {self.position}, fleet, roadmaps, now);
  } else if (planned && now - *planned_since_ > long_delay * fleet.second()) {
    leave();  // it came too late for the plan
  }
}

bool CoordinationRound::waits_too_long(const Fleet& fleet, double now) const {
  return now - *waiting_since_ > std::max(longest_wait_for_plan, least_wait_for_plan * fleet.second());
}

/// Plans as soon as all robots within reach that are not failed wait in this round and stand. A robot that
/// stands elsewhere and wants to go nowhere is an obstacle. A robot that reports a position off the map is
/// neither a member nor an obstacle. Calls anew if somebody does not wait in time.
void CoordinationRound::lead(const FleetMember& self, const Fleet& fleet, const Reserver& reserver,
                             MapRoadmaps& roadmaps, double now) {
  if (maker_) {
    if (maker_->step(now, id_.reach < everywhere)) publish(self, now);
    return;
  }
  if (!self.stands || !fleet.all_wait(id_)) {
    // A robot that an operator halted for a moment has left the round, and takes part in the next one.
    if (waits_too_long(fleet, now)) call(self, {self.position}, fleet, roadmaps, now);
    return;
  }
  std::vector<FleetMember> members{self};
  std::vector<JointTask> obstacles;
  std::vector<KnownReservation> others;
  for (const FleetMember& m : fleet.others()) {
    if (m.failed || !is_on_map(roadmaps.field(), m.position)) continue;
    if (m.round == id_ && m.stage == Stage::waiting) {
      members.push_back(m);
    } else if (m.wants_to_stay) {
      obstacles.push_back({m.position, std::nullopt, m.radius, false});
    } else if (auto reservation = reserver.reservation_of(m)) {
      others.push_back(*std::move(reservation));
    }
  }
  for (const Disc& failed : fleet.zones_of_failed(self.position, now)) {
    if (is_on_map(roadmaps.field(), failed.centre, failed.radius))
      obstacles.push_back({failed.centre, std::nullopt, failed.radius, false});
  }
  maker_ = std::make_unique<PlanMaker>(roadmaps, std::move(members), std::move(obstacles), others,
                                       Random(id_.epoch), now);
}

void CoordinationRound::publish(const FleetMember& self, double now) {
  if (maker_->strands() && id_.reach < everywhere) return call_everybody(self, now);
  JointPlanMessage message = maker_->message();
  maker_.reset();
  message.round = id_;
  plan_ = std::make_shared<const JointPlanMessage>(message);
  own_plan_ = std::move(message);
}

}  // namespace coppice
