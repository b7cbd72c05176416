#include "robot_agent/agreement/reserver.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "messages/validation.h"
#include "motion/trajectory/space_time.h"
#include "robot_agent/agreement/priority.h"
#include "robot_agent/agreement/reservation_pair.h"
#include "robot_agent/timing.h"

namespace coppice {

namespace {

constexpr double lead = 2 * control_period;  // between the plan and the departure
constexpr double recent_state = Timing::recent_state;
constexpr double same_place = 0.01;  // metres between where a plan begins and where the robot stands

/// Seconds from a decision until the robot that made it stands, at most: it takes effect a period later, and
/// the robot brakes a period after that.
double longest_window(const Fleet& fleet) {
  return fleet.longest_braking() + 2 * control_period;
}

bool may_plan(const FleetMember& m) {
  return !m.failed && !m.wants_to_stay && m.stage != Stage::waiting;
}
/// The robot waits for its turn.
bool is_wish(const ReservationMessage& r) {
  return r.trajectory.empty() && r.way > 0;
}
bool plans_first(const ReservationMessage& a, const ReservationMessage& b) {
  return plans_first(a.priority, a.way, a.robot, b.priority, b.way, b.robot);
}

}  // namespace

/// Numbers grow, also over restarts of the process.
std::uint32_t Reserver::next_number(double now) {
  number_ = std::max(number_ + 1, static_cast<std::uint32_t>(std::max(0.0, now) / control_period) + 1);
  return number_;
}

void Reserver::say(ReservationMessage message, const FleetMember& self, double now,
                   std::vector<Outgoing>& out) {
  message.robot = robot_;
  message.radius = self.radius;
  message.number = message.first_number = next_number(now);
  message.run = run_;
  out.emplace_back(std::move(message));
}

void Reserver::want(const Path& path, const FleetMember& self, const ClearanceField& field, double now,
                    std::vector<Outgoing>& out) {
  const Wanted wanted{is_urgent_ ? Priority::urgent : priority_of(path, self.radius, field), length_of(path),
                      now};
  say({.robot = {}, .way = wanted.way, .priority = wanted.priority, .run = {}}, self, now, out);
  state_ = wanted;
}

/// Another robot may rely on this one to stay in its strip. Its last decision that does is made
/// `recent_state` from now on, at the latest.
void Reserver::leave_strip(const Fleet& fleet, double now) {
  if (!holds()) return;
  std::erase_if(rely_on_strip_, [&](const Relies& other) { return now >= other.until; });
  const double until = now + (1 + clock_drift) * (recent_state + longest_window(fleet));
  for (const FleetMember& m : fleet.others()) {
    if (may_rely(m.robot)) rely_on_strip_.push_back({m.robot, number(), until});
  }
}

/// A robot may leave this one out of its decisions, wherever its own way leads, once this robot has told it
/// that it heeds its reservation: perhaps under an earlier number, for the other one may have renewed it on
/// its way; and perhaps before this process was started. A robot without a reservation stands.
bool Reserver::may_rely(const RobotName& robot) const {
  const ReservationMessage* const r = others_->find(robot, run_);
  if (r != nullptr && r->trajectory.empty()) return false;
  const auto told = told_.find(robot);
  const bool was_told = r != nullptr && told != told_.end() && told->second.number >= r->first_number;
  return was_told || has_begun_anew_;
}

/// The process before this one may have held a reservation.
void Reserver::begin_anew(const Fleet& fleet, double last_state, double now) {
  state_ = nothing;
  number_ = next_number(now);
  is_news_ = has_begun_anew_ = true;
  rely_on_strip_.clear();
  if (fleet.size_of_the_run() < 2) return;
  // Without a name: it is not known who relies on it.
  rely_on_strip_.push_back(
      {RobotName(), 0, last_state + (1 + clock_drift) * (recent_state + longest_window(fleet))});
}

/// A robot that says that it has heard may still brake on a line for which it relied on the strip: until it
/// comes to rest by the promise of that state, at the latest.
void Reserver::note_who_heard(const Fleet& fleet, double now) {
  for (Relies& other : rely_on_strip_) {
    const auto knows = knows_this_.find(other.robot);
    if (other.has_heard || knows == knows_this_.end() || knows->second <= other.number) continue;
    const auto m = fleet.find(other.robot, now);
    if (!m) continue;
    other.until = std::min(other.until, rests_at(*m) + m->clock_error);
    other.has_heard = true;
  }
}

/// It does not matter that the other robot relies on the strip if the two cannot meet before that is over.
bool Reserver::may_be_met(const Relies& other, const FleetMember& self, const Fleet& fleet,
                          double now) const {
  const auto m = fleet.find(other.robot, now);
  if (now >= other.until || (m && m->failed)) return false;
  if (!m || m->limits.max_speed == 0) return true;  // nothing is known of where it is
  const double age = now - m->promise.stamp + m->clock_error;
  const double gap = (m->promise.position - self.position).norm() - self.radius - m->radius;
  return gap <= m->max_speed * age + (m->max_speed + self.limits.max_speed) * (other.until - now);
}

bool Reserver::may_leave_strip(const FleetMember& self, const Fleet& fleet, double now) const {
  return std::ranges::none_of(rely_on_strip_,
                              [&](const Relies& other) { return may_be_met(other, self, fleet, now); });
}

void Reserver::hear(const RobotState& state) {
  for (const ReservationId& known : state.knows) {
    if (known.robot == robot_) knows_this_[state.robot] = std::max(knows_this_[state.robot], known.number);
  }
}

/// Each number is told to its robot several times, and then from time to time.
std::vector<ReservationId> Reserver::knows(std::span<const RobotName> robots) {
  std::vector<ReservationId> known;
  for (std::size_t k = 0; k < robots.size() && known.size() < most_known_reservations; ++k) {
    const RobotName& robot = robots[(next_told_ + k) % robots.size()];
    const ReservationMessage* const r = others_->find(robot, run_);
    if (r == nullptr) continue;
    Told& told = told_[robot];
    if (told.number != r->number) told = {r->number, 0};
    ++told.times;
    if (told.times > 10 && told.times % 16 != 0) continue;
    known.push_back({robot, r->number});
  }
  next_told_ += most_known_reservations;
  return known;
}

void Reserver::drop(const FleetMember& self, const Fleet& fleet, double now, std::vector<Outgoing>& out) {
  if (std::holds_alternative<None>(state_) && !std::exchange(is_news_, false)) return;
  if (holds() && held().finished()) is_urgent_ = false;
  leave_strip(fleet, now);
  say({.robot = {}, .run = {}}, self, now, out);
  state_ = nothing;
}

bool Reserver::may_try(double now) const {
  const auto* const none = std::get_if<None>(&state_);
  return none != nullptr &&
         now - none->tried_at >=
             (others_->news() != none->news ? Timing::reserve_again : Timing::reserve_again_without_news);
}

/// The robot whose turn it is, as far as this robot knows. Empty: a robot of which nothing was heard.
RobotName Reserver::next_to_plan(const Wanted& wanted, const Fleet& fleet) const {
  const auto counts = [&](const RobotName& robot) {
    const auto m = fleet.find(robot);
    return m && may_plan(*m) && !wanted.passed_over.contains(robot);
  };
  const ReservationMessage own{.robot = robot_, .way = wanted.way, .priority = wanted.priority, .run = {}};
  const ReservationMessage* next = &own;
  std::size_t heard = 1;  // robots, with this one
  for (const auto& [robot, r] : *others_) {
    if (r->run != run_) continue;
    ++heard;
    if (is_wish(*r) && plans_first(*r, *next) && counts(robot)) next = r.get();
  }
  if (heard >= fleet.known() || wanted.passed_over.contains({})) return next->robot;
  const auto is_unheard = [&](const FleetMember& m) {
    return others_->find(m.robot, run_) == nullptr && counts(m.robot);
  };
  return std::ranges::any_of(fleet.others(), is_unheard) ? RobotName() : next->robot;
}

bool Reserver::is_turn(Wanted& wanted, const Fleet& fleet, double now) const {
  for (;;) {
    const RobotName next = next_to_plan(wanted, fleet);
    if (next == robot_) return true;
    if (wanted.next && *wanted.next != next) wanted.since = now;
    wanted.next = next;
    if (now - wanted.since <= Timing::longest_turn * fleet.second()) return false;
    wanted.passed_over.insert(next);
  }
}

void Reserver::plan(const Path& path, double ready, const FleetMember& self, const Limits& limits,
                    const Fleet& fleet, MapRoadmaps& roadmaps, double now, std::vector<Outgoing>& out) {
  auto* const wanted = std::get_if<Wanted>(&state_);
  if (wanted == nullptr || !self.stands || !is_turn(*wanted, fleet, now)) return;
  const double begin = std::max(now + lead, ready) + speeding_up(limits);
  TrajectoryPlanner planner(roadmaps, path, self.radius, limits, begin, others_to_reckon_with(fleet, now),
                            fleet.zones_of_failed(self.position, now));
  auto found = planner.around_all();
  if (!found) {
    is_urgent_ = true;
    found = planner.around_most();
  }
  if (!found) {
    drop(self, fleet, now, out);
    state_ = None{now, others_->news()};
    return;
  }
  hold({.robot = robot_,
        .radius = self.radius,
        .way = wanted->way,
        .trajectory = *std::move(found),
        .basis = planner.basis(),
        .priority = is_urgent_ ? Priority::urgent : wanted->priority,
        .run = run_},
       limits, now, out)
      .goes_on_along(planner.rest());
}

/// Those that wait for their turn set off one after the other: each reservation must reach the next one.
std::vector<OtherRobot> Reserver::others_to_reckon_with(const Fleet& fleet, double now) const {
  const std::vector<FleetMember> members = fleet.others();
  std::vector<const ReservationMessage*> queue;
  for (const FleetMember& m : members) {
    const ReservationMessage* const r = others_->find(m.robot, run_);
    if (may_plan(m) && r != nullptr && is_wish(*r)) queue.push_back(r);
  }
  std::ranges::sort(queue, [](const auto* a, const auto* b) { return plans_first(*a, *b); });
  const double there_and_back = 2 * fleet.clock_error(now);  // of a message, about
  std::vector<OtherRobot> others;
  for (const FleetMember& m : members) {
    if (m.failed) continue;
    const auto before = std::ranges::find(queue, others_->find(m.robot, run_)) - queue.begin();
    const double sets_off = now + Timing::sets_off_within + there_and_back * static_cast<double>(before);
    others.push_back({.position = m.position,
                      .radius = m.radius,
                      .reservation = reservation_of(m),
                      .stands_until = m.wants_to_stay ? SpaceTime::forever : sets_off});
    if (!others.back().reservation) continue;
    const ReservationMessage& r = *others_->find(m.robot, run_);
    others.back().may_give_way = !m.wants_to_stay && !is_of_plan(r) && r.priority != Priority::urgent;
  }
  return others;
}

/// The other robot drives on from where it is, as late as it is: gates hold it up, or its trajectory was
/// planned around somebody that has gone. It does not come again where it has been.
std::optional<KnownReservation> Reserver::reservation_of(const FleetMember& m) const {
  const ReservationMessage* const r = others_->find(m.robot, run_);
  const bool keeps_to_it =
      r != nullptr && !r->trajectory.empty() && m.reservation <= r->number && m.stage != Stage::waiting;
  if (!keeps_to_it) return std::nullopt;
  KnownReservation known{{m.robot, r->number, m.clock_offset}, r->trajectory, r->radius};
  if (m.reservation == r->number) {
    known.trajectory = rest_of(r->trajectory, m.reservation_progress);
    const double late = m.promise.decision_time - (known.trajectory.front().time + m.clock_offset);
    if (late > room_in_time) known.basis.offset += late;
  }
  known.trajectory = shifted(std::move(known.trajectory), known.basis.offset);
  return known;
}

/// From now on the robot drives by this reservation. The message has all but its numbers.
HeldReservation& Reserver::hold(ReservationMessage message, const Limits& limits, double now,
                                std::vector<Outgoing>& out) {
  std::erase_if(message.basis, [&](const ReservationBasis& b) {
    const ReservationMessage* const r = others_->find(b.robot, run_);
    return r == nullptr || r->trajectory.empty() || !come_near(message, *r);
  });
  message.number = message.first_number = next_number(now);
  auto own = std::make_shared<const ReservationMessage>(std::move(message));
  out.emplace_back(*own);
  return state_.emplace<HeldReservation>(std::move(own), limits, *others_);
}

void Reserver::name_those_beside(double now, std::vector<Outgoing>& out) {
  if (!holds() || !held().has_unnamed()) return;
  ReservationMessage message = held().message();
  message.basis = held().basis();
  message.number = next_number(now);
  auto own = std::make_shared<const ReservationMessage>(std::move(message));
  out.emplace_back(*own);
  held().renew(std::move(own));
}

void Reserver::adopt(const JointPlanMessage& plan, const FleetMember& self, const Fleet& fleet, double now,
                     std::vector<Outgoing>& out) {
  const auto part = std::ranges::find(plan.members, robot_, &JointPlanMessage::Member::robot);
  // It begins in the strip of its part.
  const double there = std::min(same_place, reserved_stray_radii * self.radius);
  const bool has_part = part != plan.members.end() && path_of(part->trajectory).size() > 1 &&
                        (part->trajectory.front().position - self.position).norm() < there;
  is_news_ = true;
  if (!has_part) return drop(self, fleet, now, out);
  leave_strip(fleet, now);
  const auto leader = fleet.find(plan.round.leader);
  const double shift = leader ? leader->clock_offset : 0;
  ReservationMessage message{.robot = robot_,
                             .radius = self.radius,
                             .way = length_of(path_of(part->trajectory)),
                             .trajectory = shifted(part->trajectory, shift),
                             .basis = plan.basis,
                             .plan = {plan.round.leader, plan.round.epoch, shift},
                             .run = run_};
  for (ReservationBasis& b : message.basis) b.offset += shift;
  hold(std::move(message), self.limits, now, out).expect_members_of(plan);
}

bool Reserver::passes(const RobotState& other, double age, double now) {
  if (!holds() || age > recent_state) return false;
  const auto heard = knows_this_.find(other.robot);
  return held().passes(other, heard != knows_this_.end() ? heard->second : 0, now - age);
}

}  // namespace coppice
