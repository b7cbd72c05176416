// What a robot agent does in each control period: it brings its body up to the present, listens, drives, and
// tells the others.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "robot_agent/limits.h"
#include "robot_agent/robot_agent.h"

namespace coppice {

namespace {

constexpr double period = control_period;
// A robot whose agent slept for so long, or that was cut off, stands as long again before it moves on: the
// others may have come to think it failed, and hear of it first.
constexpr WallTime own_silence = 1;
constexpr std::uint32_t repeat_change = 5;  // control periods in which a robot that stands says so in each
// The same of its part in a round, to all in it: in as many turns as listeners share a state's copies
// (Fleet::copies), so that each of them hears one.
constexpr std::uint32_t repeat_round_news = sure_witnesses - 1;
constexpr WallTime longest_startup = 10;  // seconds to wait for the others' missions before setting off
// Of one that was started anew about where somebody is; then it says that it is stuck.
constexpr double longest_ignorance = 120;
constexpr WallTime least_ignorance = 30;         // likewise, of the wall's clock: others must find it first
constexpr std::uint32_t heartbeats_between_relays = 2;  // of the silent
constexpr double asks_for_news = 1.5;            // seconds, of one that was out of touch
constexpr double decisions_counted = 16;         // of those that may be late: a pause is one
constexpr double share_of_overload = 0.25;
constexpr int most_times_stranded = 5;  // joint plans that may fail a robot before it gives up
// Seconds until it tries again, if another is wanted elsewhere meanwhile: its attempts stop the others.
constexpr double between_retries = 300;
constexpr int most_calls_in_vain = 30;  // rounds from one place, likewise
constexpr double stall = 3;             // seconds without progress that make a robot call a round
// The same, however often it has bound itself to stand meanwhile: two that push each other back to and fro
// let each other go first for ever.
constexpr double longest_stall = 30;
constexpr double around_radii = 16;  // within these, others' joint plans concern a robot
constexpr double stall_radii = 0.5;  // metres that count as progress, in radii
constexpr double stall_share = 0.5;  // the same, at most so much of what its limits allow
// A robot that has no reason to move binds itself to stand for so long, seconds: others may pass it closely.
// It takes them as long as a sample is under way to hear of it, and they allow for clocks that are as far
// off.
constexpr double idle_lease = 1;
constexpr double waiting_lease = 0.3;
constexpr double longest_lease = 2;
constexpr double lease_for_delay = 4;
constexpr double longest_delay = 5;  // seconds: whose clock seems further off is at fault, or lies
constexpr double fair_pace = 0.5;    // of the preferred speed
constexpr double beside = 1.3;       // sums of radii between two that hinder each other
constexpr double level = 0.1;        // the same, of the lead of one that is not ahead
constexpr double crawl = 0.05;       // of the largest speed: what is slower is held up
// Two robots that meet head-on see no reason to prefer a side; all lean a little to their right. Many that
// meet in one place lean more and more while they come no further: what was a jam turns like a roundabout.
constexpr double least_lean = 0.05;  // radians
constexpr double most_lean = 1.5;
constexpr double leans_after = 0.3;            // seconds without progress
constexpr double lean_rate = 3;                // radians a second
constexpr double open_radii = 8;               // to the next obstacle: between walls, leaning leads into them
constexpr double end_radii = 2;                // of the way: there it stops exactly
constexpr double recorded_after_the_end = 60;  // seconds

Point2 leaning_right(const Point2& v, double stalled) {
  const double lean = std::clamp(least_lean + lean_rate * (stalled - leans_after), least_lean, most_lean);
  return {std::cos(lean) * v.x() + std::sin(lean) * v.y(), -std::sin(lean) * v.x() + std::cos(lean) * v.y()};
}

/// Metres that count as progress.
double least_gain(double radius, const Limits& limits) {
  const double speeds_up = std::min(stall, limits.max_speed / limits.max_acceleration);
  const double most =
      limits.max_acceleration * speeds_up * speeds_up / 2 + limits.max_speed * (stall - speeds_up);
  return std::min(stall_radii * radius, stall_share * most);
}

}  // namespace

/// Brings the body up to the present, and decides once for the newest period.
void RobotAgent::control(double fleet_now, std::vector<Outgoing>& out) {
  if (fleet_now < body_->time()) return;
  bool due = std::exchange(first_control_, false);
  // Its journal begins with its first state, and so does its track.
  if (due && fleet_now - body_->time() >= period) pass_over(fleet_now);
  if (fleet_now - body_->time() > grace()) listen_anew(fleet_now);
  // Where it wakes late it leaves out no number, if it drives, and no heartbeat: gaps are what others have lost.
  const std::uint32_t next_heartbeat = sequence_ - sequence_ % heartbeat_interval + heartbeat_interval;
  int periods = 0;
  while (body_->time() + period <= fleet_now) {
    if (body_->stands() && fleet_now - body_->time() > longest_sleep) {
      pass_over(fleet_now);
      continue;
    }
    ++periods;
    if (!tracking_ && records(fleet_now))
      track_.push_back({body_->time(), body_->position(), body_->velocity()});
    status_.driven_length += period * body_->velocity().norm();
    body_->advance();
    trail_.go_on(body_->position(), ground_->field, body_->radius());
    sequence_ += (body_->stands() || !due) && sequence_ < next_heartbeat;
    due = true;
  }
  if (!due) return;

  load_.periods += static_cast<std::uint32_t>(periods);
  load_.periods_missed += static_cast<std::uint32_t>(std::max(0, periods - periods_expected_));
  late_ += ((periods > periods_expected_ ? 1 : 0) - late_) / decisions_counted;
  decide(fleet_now);
  watch_coming_on(fleet_now, periods * period);
  // Counted by periods and not by steps: one that sleeps, or wakes late, misses none.
  const std::uint32_t heartbeats = sequence_ / heartbeat_interval;
  const bool heartbeat = heartbeats != std::exchange(last_heartbeat_, heartbeats);
  speak(fleet_now, heartbeat, out);
  if (heartbeat) relay_states(fleet_now, out);
  if (auto plan = round_.take_own_plan()) {
    plan->run = mission_->clock.epoch;
    out.emplace_back(*std::move(plan));
  }
  periods_expected_ = periods_to_next_control();
}

/// All missions are cancelled, and whoever reports on the run has had time to hear the last of it: agents may
/// live for months.
bool RobotAgent::records(double fleet_now) const {
  return fleet_now < stopped_at_ + recorded_after_the_end * fleet_.second() || !fleet_.run_is_over();
}

double RobotAgent::grace() const {
  return own_silence * std::max(1.0, mission_->clock.scale);
}

void RobotAgent::listen_anew(double fleet_now) {
  heard_again_at_ = fleet_now + grace();
}

/// It stood all that time, and goes on standing now.
void RobotAgent::pass_over(double fleet_now) {
  body_ = Driver(body_->position(), std::floor(fleet_now / period) * period, body_->radius(), body_->limits(),
                 period);
}

void RobotAgent::relay_states(double fleet_now, std::vector<Outgoing>& out) {
  for (RobotState& last : fleet_.last_words(fleet_now)) out.emplace_back(std::move(last));
  if (last_heartbeat_ % heartbeats_between_relays != 0) return;
  const std::vector<RobotName> to = fleet_.peers_to_inform(fleet_now);
  if (to.empty()) return;
  // As often as it takes that one of these hears it, for nobody says to have heard that.
  for (const RobotState& last : fleet_.states_of_silent_peers(fleet_now))
    for (int copy = 0; copy < fleet_.copies(); ++copy) out.emplace_back(Message(last), to);
}

/// Of not knowing where all are.
bool RobotAgent::is_too_long(double seconds) const {
  return seconds > std::max(longest_ignorance, least_ignorance * fleet_.second());
}

/// Others may be anywhere by now, and not where their missions begin.
bool RobotAgent::stands_as_newcomer(double fleet_now) {
  if (!is_new_) return false;
  if (!may_set_off(fleet_now)) listen_anew(fleet_now);  // whom it met last is to tell it who died
  is_new_ = fleet_now < heard_again_at_;
  if (!is_new_) {
    if (status_.phase != Phase::no_path) status_.reason.clear();
    retry_after_change();
    return false;
  }
  if (body_->stands()) stand_for(fleet_now, waiting_lease);
  if (status_.phase == Phase::driving)
    status_.reason = "its agent was started in mid-run, and has not heard where all others are";
  if (status_.phase == Phase::driving && is_too_long(fleet_now - startup_since_))
    give_up("its agent was started in mid-run, and nobody who is alive knows where all others are");
  return true;  // its body brakes
}

bool RobotAgent::is_under_way() const {
  return status_.phase == Phase::planning || status_.phase == Phase::driving;
}

/// Pushed to and fro it does not come on either.
void RobotAgent::watch_coming_on(double fleet_now, double lived) {
  const double gain = least_gain(body_->radius(), body_->limits());
  if (!is_under_way() || (body_->position() - came_to_).norm() >= gain) {
    came_to_ = body_->position();
    status_.came_on_at = fleet_now;
  }
  if (does_not_come_on(fleet_now)) status_.waited += lived;
}

bool RobotAgent::does_not_come_on(double fleet_now) const {
  return is_under_way() && fleet_now - status_.came_on_at > stall;
}

/// Others hear one that this robot does not: where that is it cannot know, and stands. Processes may never
/// find each other.
void RobotAgent::watch_isolation(double fleet_now) {
  const auto unfound = fleet_.heard_by_others_only();
  if (!unfound) {
    isolated_since_ = std::numeric_limits<double>::infinity();
    if (std::exchange(is_isolated_, false)) retry_after_change();
    return;
  }
  isolated_since_ = std::min(isolated_since_, fleet_now);
  if (status_.phase != Phase::driving || !is_too_long(fleet_now - isolated_since_)) return;
  is_isolated_ = true;
  give_up(fmt::format("hears nothing of {}, which others hear: the two do not reach each other", *unfound));
}

/// As in a pause: nothing is decided, and so the body brakes where that is known to be clear.
bool RobotAgent::waits_for_its_robot(double fleet_now) {
  if (!tracking_ || tracking_->keeps_up(mission_->clock.wall_time(fleet_now))) return false;
  last_gain_time_ = fleet_now;
  if (body_->stands()) stand_for(fleet_now, waiting_lease);
  return true;
}

/// Chooses the velocity of the next period.
void RobotAgent::decide(double fleet_now) {
  const bool holds = round_.stage() == Stage::waiting;
  fleet_.detect_failures(fleet_now, body_->position(), holds ? round_.id() : RoundId{}, ground_->field);
  if (fleet_.cut_off()) listen_anew(fleet_now);
  if (fleet_.out_of_touch()) asks_for_news_until_ = fleet_now + asks_for_news * fleet_.second();
  if (stands_as_newcomer(fleet_now) || waits_for_its_robot(fleet_now)) return;
  watch_isolation(fleet_now);
  const std::span<const Neighbour> others =
      body_->bound_to_stand() ? std::span<const Neighbour>() : neighbours(fleet_now);
  const bool listens = fleet_now < heard_again_at_;
  if (!listens && status_.phase != Phase::stopped && round_.stage() == Stage::waiting)
    round_.hold(self(), fleet_, ground_->places, fleet_now);
  if (!listens && status_.phase != Phase::stopped && std::exchange(has_left_round_, false) &&
      round_.stage() == Stage::free)
    round_.call(self(), fleet_, fleet_now);
  const bool free = round_.stage() == Stage::free;
  lets_others_finish_ = lets_others_finish_ && !all_free_around();
  if (listens) {
    // Its body brakes: one that the others miss is not reckoned with where it would evade to.
    last_gain_time_ = fleet_now;
    if (body_->stands()) stand_for(fleet_now, waiting_lease);
  } else if (status_.phase == Phase::driving && free && !round_.stranded() && !lets_others_finish_ &&
             may_set_off(fleet_now)) {
    // One that the joint plan cannot help stands out of the others' way until they are done.
    drive_freely(fleet_now, others);
  } else {
    last_gain_time_ = fleet_now;
    if (status_.phase != Phase::stopped && round_.stage() == Stage::executing) {
      execute_plan(fleet_now, others);
    } else {
      body_->choose(Point2::Zero(), others, ground_->field);
      // A robot that plans, or waits for news of the others, will set off any moment.
      const bool ready = status_.phase == Phase::driving && !may_set_off(fleet_now);
      if (status_.phase != Phase::planning && !ready) stand_for(fleet_now, free ? idle_lease : waiting_lease);
    }
  }
  if (status_.phase != Phase::stopped) watch_arrival(fleet_now);
}

void RobotAgent::drive_freely(double fleet_now, std::span<const Neighbour> neighbours) {
  const Point2 next = body_->position() + period * body_->velocity();
  const Point2 preferred = follower_->preferred_velocity(next, ground_->field, body_->limits(), period);
  if (follower_->lost()) {  // it was pushed to where it does not see its path
    look_for_a_path(way_back_to_the_path());
    enter(Phase::planning);
    return body_->choose(Point2::Zero(), neighbours, ground_->field);
  }
  trail_.begin(next);
  const double r = body_->radius();
  const bool open = ground_->field.lower_bound(next) >= open_radii * r;
  const bool leans = follower_->remaining(next) > end_radii * r;
  Point2 wanted = leans ? leaning_right(preferred, open ? stalled_for(fleet_now) : 0) : preferred;
  if (body_->velocity().norm() >= fair_pace * preferred.norm()) last_pace_time_ = fleet_now;
  if (fleet_now - last_pace_time_ > waiting_lease && lets_go_first(preferred)) {
    wanted = Point2::Zero();
    stand_for(fleet_now, waiting_lease);
  }
  body_->choose(wanted, neighbours, ground_->field);
  if (body_->bound_to_stand()) last_bound_time_ = fleet_now;
  if (follower_->progress() >= last_gain_ + least_gain(body_->radius(), body_->limits())) {
    last_gain_ = follower_->progress();
    last_gain_time_ = fleet_now;
  }
  // Not while a joint plan is being driven: it may be what clears the way, and a new round would end it.
  const bool stalls = stalled_for(fleet_now) > stall || fleet_now - last_gain_time_ > longest_stall;
  if (stalls && all_free_around() && !fleet_.is_suspected_near(body_->position(), around_radii * body_->radius()))
    round_.call(self(), fleet_, fleet_now);
}

/// Seconds; those in which it is bound to stand do not count.
double RobotAgent::stalled_for(double fleet_now) const {
  return fleet_now - std::max(last_gain_time_, last_bound_time_);
}

/// Of two that drive side by side each fears that the other turns, and both slow down. The one that is
/// behind, or has the later name, stands until the other has gone.
bool RobotAgent::lets_go_first(const Point2& preferred) const {
  const Point2 ahead = preferred / std::max(preferred.norm(), 1e-9);
  const auto close = fleet_.beside(body_->position(), body_->radius(), beside);
  return std::ranges::any_of(close, [&](const FleetMember& m) {
    if (m.stands || m.stage != Stage::free) return false;
    const Point2 gap = m.position - body_->position();
    const double reach = body_->radius() + m.radius;
    const bool same_way = m.velocity.dot(ahead) > m.velocity.norm() / 2;
    const double lead = gap.dot(ahead);
    const bool goes_first = std::abs(lead) < level * reach ? m.robot < name_ : lead > 0;
    return same_way && goes_first;
  });
}

void RobotAgent::execute_plan(double fleet_now, std::span<const Neighbour> neighbours) {
  const Point2 next = body_->position() + period * body_->velocity();
  const Point2 wanted = round_.preferred_velocity(self(), fleet_, next, body_->limits(), fleet_now);
  if (wanted.isZero(0)) {
    body_->follow(wanted, neighbours, ground_->field);
    stand_for(fleet_now, std::clamp(round_.waits_until() - fleet_now, waiting_lease, longest_lease));
  } else if (!body_->bound_to_stand()) {
    round_.led_past(body_->follow(wanted, neighbours, ground_->field));
    // Of several that fear each other's next move, one must go.
    if (body_->commitment().next_velocity.norm() > crawl * body_->limits().max_speed)
      last_drive_time_ = fleet_now;
    const bool held_up = fleet_now - last_drive_time_ > waiting_lease;
    if (held_up && round_.gives_way(self(), fleet_, fleet_now)) {
      body_->follow(Point2::Zero(), neighbours, ground_->field);
      stand_for(fleet_now, waiting_lease);
    }
  }
}

void RobotAgent::stand_for(double fleet_now, double seconds) {
  const double delay = std::min(fleet_.clock_error(fleet_now), longest_delay);
  body_->stay(body_->time() + seconds + lease_for_delay * delay);
}

/// A robot has arrived when it stands at its goal with no more moves to make; one that is asked to give way
/// is under way again.
void RobotAgent::watch_arrival(double fleet_now) {
  const bool at_goal = (body_->position() - mission_->goal).norm() <= arrives_within(*mission_);
  if (status_.phase == Phase::arrived && !at_goal) {
    status_.arrival_time = 0;
    enter(Phase::driving);
  }
  const bool others_go_elsewhere = gave_up_ && fleet_.new_goals() != new_goals_ &&
                                   fleet_now - gave_up_at_ > between_retries * fleet_.second();
  if (fleet_.recoveries() != recoveries_ || others_go_elsewhere) retry_after_change();
  const bool may_become_better = fleet_.is_suspected_near(body_->position(), everywhere);
  if (status_.phase == Phase::driving && round_.calls_in_vain() > most_calls_in_vain && !may_become_better)
    return give_up(fmt::format("a way past the others was not found within {} joint plans from this place",
                               most_calls_in_vain));
  if (status_.phase != Phase::driving || round_.stage() != Stage::free || !body_->stands()) return;
  if (at_goal) {
    const bool is_there =
        !tracking_ || (*tracking_->position() - mission_->goal).norm() <= arrives_within(*mission_);
    if (!is_there) {
      last_gain_time_ = body_->time();  // it is on its way
      return;
    }
    if (status_.arrival_time == 0) status_.arrival_time = body_->time();
    enter(Phase::arrived);
  } else if (round_.stranded() && !may_become_better && fleet_.all_free(body_->position(), everywhere)) {
    // Where the others are now, another attempt may succeed.
    if (++times_stranded_ < most_times_stranded) return round_.call_everybody(self(), fleet_now);
    give_up(fmt::format("a joint plan that brings this robot to its goal was not found within {} attempts",
                        most_times_stranded));
  }
}

void RobotAgent::give_up(std::string reason) {
  if (is_new_ || is_isolated_) round_.leave();
  status_.reason = std::move(reason);
  gave_up_ = true;
  gave_up_at_ = body_->time();
  new_goals_ = fleet_.new_goals();
  enter(Phase::no_path);
}

/// One that counted as failed is back, or is known to be, or somebody goes elsewhere: what it closed may be
/// open.
void RobotAgent::retry_after_change() {
  recoveries_ = fleet_.recoveries();
  times_stranded_ = 0;
  round_.retry_after_change();
  if (!std::exchange(gave_up_, false) || status_.phase != Phase::no_path) return;
  status_.reason.clear();
  enter(Phase::driving);
}

bool RobotAgent::all_free_around() const {
  return fleet_.all_free(body_->position(), around_radii * body_->radius());
}

void RobotAgent::enter(Phase phase) {
  status_.phase = phase;
  status_changed_ = true;
}

/// A robot sets off when it knows where all others are, and what their clocks say. The missions say how many
/// there are.
bool RobotAgent::may_set_off(double fleet_now) {
  const bool startup_is_over = fleet_now - startup_since_ > longest_startup * std::max(1.0, mission_->clock.scale);
  return fleet_.complete(startup_is_over ? 0 : mission_->fleet_size);
}

/// All who may come near while this robot looks ahead, or brakes.
std::span<const Neighbour> RobotAgent::neighbours(double fleet_now) {
  const Limits& limits = body_->limits();
  const double horizon = std::max(Driver::horizon, limits.max_speed / limits.max_acceleration) + 3 * period;
  const double reach = body_->radius() + horizon * limits.max_speed;
  fleet_.collect_neighbours(body_->position(), reach, horizon, fleet_now, ages_, near_);
  return near_;
}

FleetMember RobotAgent::self() const {
  const bool has_given_up = status_.phase == Phase::no_path;
  return {.robot = name_,
          .position = body_->position(),
          .goal = has_given_up ? std::nullopt : std::optional(mission_->goal),
          .arrives_within = arrives_within(*mission_),
          .wants_to_stay = status_.phase == Phase::arrived,
          .radius = body_->radius(),
          .stands = body_->stands(),
          .round = round_.id(),
          .stage = round_.stage(),
          .progress = round_.progress()};
}

/// One that is bound to stand need not look again before it has something to say.
int RobotAgent::periods_to_next_control() const {
  if (first_control_) return 0;
  const bool rests = since_change_ > repeat_change && !round_.plans() && body_->bound_to_stand(heartbeat_interval);
  return rests ? heartbeat_interval - static_cast<int>(sequence_ % heartbeat_interval) : 1;
}

/// Tells the others. Who goes on standing as it has said does so less often.
void RobotAgent::speak(double fleet_now, bool heartbeat, std::vector<Outgoing>& out) {
  const Steady steady{body_->stands(), status_.phase, round_.id(), round_.stage(), round_.waits_for()};
  const bool same_part = steady.round == last_said_.round && steady.stage == last_said_.stage;
  since_change_ = steady.stands && steady == last_said_ ? since_change_ + 1 : 0;
  since_round_change_ = same_part ? since_round_change_ + 1 : 0;
  last_said_ = steady;
  const bool rests = since_change_ > repeat_change;
  if (rests && !heartbeat) return;
  const std::uint32_t turn = rests ? sequence_ - sequence_ % heartbeat_interval : sequence_;
  const RoundId* news = since_round_change_ <= repeat_round_news ? &round_.id() : nullptr;
  auto [agents, echoes, misses] = fleet_.address(turn, news, round_.waits_for(), fleet_now);
  RobotState said = state(fleet_now, std::move(echoes));
  said.misses = std::move(misses);
  const int copies = std::max(said.copies, std::exchange(copies_promised_, said.copies));
  const std::vector<RobotName> again =
      copies > 1 ? fleet_.who_hears_copies(agents) : std::vector<RobotName>();
  for (; said.copy + 1 < copies; ++said.copy) out.emplace_back(said, again);
  if (said.is_new) return out.push_back(Outgoing(std::move(said)));  // to all
  out.emplace_back(std::move(said), std::move(agents));
}

/// Of what it says. One that has stood since its mission began has decided nothing that its death could hide.
/// One whose processor is too busy for its decisions says everything once: the others' are likely to be too
/// busy to listen, and what is lost by that is not mended by saying more.
std::uint8_t RobotAgent::copies() const {
  const bool has_set_off = status_.driven_length > 0 || !body_->stands();
  const bool overloaded = late_ > share_of_overload;
  return static_cast<std::uint8_t>(has_set_off && !is_new_ && !overloaded ? fleet_.copies() : 1);
}

RobotState RobotAgent::state(double fleet_now, std::vector<Echo> echoes) const {
  const Commitment c = body_->commitment();
  return {.robot = name_,
          .sequence = sequence_,
          .stamp = c.stamp,
          .position = c.position,
          .velocity = c.velocity,
          .radius = body_->radius(),
          .max_speed = body_->limits().max_speed,
          .max_acceleration = body_->limits().max_acceleration,
          .phase = status_.phase,
          .promise = {c.turn, c.next_velocity, c.expiry},
          .round = round_.id(),
          .stage = round_.stage(),
          .progress = round_.progress(),
          .waits_for = round_.waits_for(),
          .copies = copies(),
          .is_new = is_new_ || (fleet_now < asks_for_news_until_ && !fleet_.out_of_touch()),
          .wants_echo = !fleet_.echoed(fleet_now),
          .echoes = std::move(echoes),
          .run = mission_->clock.epoch};
}

}  // namespace coppice
