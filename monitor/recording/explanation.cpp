#include "monitor/recording/explanation.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "coppice/files/input_error.h"
#include "monitor/recording/words.h"
#include "monitor/view/fleet_table.h"
#include "planning/nearest_name.h"

namespace coppice {

namespace {

constexpr double far_enough = 0.05;      // metres: what is nearer is where the robot is
constexpr double of_radius = 0.2;        // the same
constexpr double said_to = 0.005;        // seconds: times are said in hundredths
constexpr std::size_t most_listed = 20;  // names in an error message

std::string when_and_where(const Episode& e) {
  const std::string when = fmt::format("{:.2f} s to {:.2f} s", e.from, e.until);
  const bool stays = (e.end - e.begin).norm() < std::max(far_enough, of_radius * e.radius);
  return stays ? fmt::format("{} at {}", when, place(e.begin))
               : fmt::format("{} from {} to {}", when, place(e.begin), place(e.end));
}

/// "r5", "r5 and then r7".
std::string named(const std::vector<RobotName>& robots) {
  return fmt::format("{}", fmt::join(robots, " and then "));
}

std::string said(const Doing& doing) {
  return doing.words.empty() ? std::string() : fmt::format(" Its agent said: \"{}\".", doing.words);
}
/// A reason that ends a sentence.
std::string because(const Doing& doing) {
  return doing.words.empty() ? "." : ": " + doing.words + ".";
}

std::string by_order(const Episode& e) {
  if (e.order.empty()) return {};
  return e.by.empty() ? fmt::format(" (order {})", e.order) : fmt::format(" (order {} of {})", e.order, e.by);
}

std::string at_the_gate(const RobotName& first, const Episode& e) {
  const std::string chain =
      e.behind.empty() ? std::string() : fmt::format(" {} itself waited for {} then.", first, e.behind);
  if (!e.gate) return fmt::format("stood and waited for {}, which went first.{}", first, chain);
  const GateAhead& gate = *e.gate;
  const std::string where =
      gate.ahead < far_enough ? "at its gate" : fmt::format("at the gate {} ahead", metres(gate.ahead));
  const std::string order =
      gate.leader.empty() ? "their reservations" : fmt::format("the joint plan of {}", gate.leader);
  return fmt::format("stood and waited for {} to pass {}. {} went first by {}, and had {} to go, to {}.{}",
                     first, where, first, order, metres(gate.left), place(gate.opens_at), chain);
}

std::string without_reservation(const Episode& e) {
  switch (e.reserving) {
    case Reserving::wish:
      return "stood and waited for its turn to reserve a trajectory.";
    case Reserving::trajectory:
      return "stood: its reservation led where it might not go any more.";
    case Reserving::given_up:
      return "stood: it had given up its reservation, and needed another one.";
    case Reserving::nothing:
      return "stood: it had no reservation yet.";
  }
  return {};
}

std::string until_a_plan(const RobotName& robot, const RobotName& leader) {
  if (leader == robot) return "stood and made a joint plan for the robots around it.";
  return leader.empty() ? "stood until there was a joint plan."
                        : fmt::format("stood until {} had made a joint plan.", leader);
}

std::string blocked(const Episode& e) {
  if (e.others.empty()) return "stood: others might have come where it wanted to go" + because(e.doing);
  return fmt::format("stood: {} {} in the way.", named(e.others), e.others.size() == 1 ? "was" : "were");
}

std::string unheard(const Episode& e) {
  const std::string what = "was not heard: its agent had ended, hung, or could not be reached.";
  if (!e.failed_since) return what;
  return what + fmt::format(" Others counted it as failed from {:.2f} s on.", *e.failed_since);
}

std::string drove(const Episode& e) {
  const std::string by = e.plan.empty() ? "" : fmt::format(", as the joint plan of {} said", e.plan);
  return fmt::format("drove {}{}.", metres(e.driven), by);
}

std::string what_it_did(const RobotName& robot, const Episode& e) {
  const Doing& doing = e.doing;
  switch (doing.act) {
    case Act::drives:
      return drove(e);
    case Act::turns:
      return "turned on the spot.";
    case Act::leaves_wall:
      return "drove away from an obstacle that it overlapped." + said(doing);
    case Act::gate:
      return at_the_gate(doing.other, e);
    case Act::blocked:
      return blocked(e);
    case Act::reservation:
      return without_reservation(e) + said(doing);
    case Act::joint_plan:
      return until_a_plan(robot, doing.other);
    case Act::stranded:
      return fmt::format("stood: the joint plan of {} did not bring it to its goal.", doing.other);
    case Act::startup:
      return "stood: it did not know yet where all others were." + said(doing);
    case Act::joining:
      return "stood: its agent had been started or had woken in mid-run, and listened where all others were.";
    case Act::contact:
      return "stood: it was cut off, or had been, and listened for what it had missed." + said(doing);
    case Act::odometry:
      return "stood: the robot that follows it was not where it should be, or was not seen." + said(doing);
    case Act::aside:
      return fmt::format("had no way of its own, and moved {} out of the others' way.", metres(e.driven));
    case Act::waits:
      return "had no mission, or no map" + because(doing);
    case Act::plans:
      return fmt::format("looked for a path to {}.", place(e.goal)) + said(doing);
    case Act::halted:
      return "was halted" + by_order(e) + because(doing);
    case Act::gave_up:
      return "gave up and stood" + because(doing);
    case Act::no_path:
      return "stood without a path" + because(doing);
    case Act::arrived:
      return "stood at its goal.";
    case Act::ended:
      return "stood: its run had ended" + because(doing);
    case Act::silent:
      return unheard(e);
  }
  return {};
}

/// The line that tells of a new mission.
std::string sent(const RobotName& robot, const Episode& e) {
  const bool is_halted = e.doing.act == Act::halted;
  return fmt::format("{:.2f} s at {}: {} got mission {}, to {}{}.", e.from, place(e.begin), robot, e.mission,
                     place(e.goal), is_halted ? std::string() : by_order(e));
}

}  // namespace

std::string sentence_of(const RobotName& robot, const Episode& e) {
  return fmt::format("{}: {} {}", when_and_where(e), robot, what_it_did(robot, e));
}

std::vector<std::string> explain_run(const Stories& stories, const RobotName& robot) {
  const Story& story = stories.robots.at(robot);
  if (story.empty()) return {fmt::format("{} said nothing of where it was: it never set out.", robot)};
  std::vector<std::string> lines;
  std::uint32_t mission = 0;
  for (const Episode& e : story) {
    if (e.mission != mission && e.doing.act != Act::ended) lines.push_back(sent(robot, e));
    mission = e.mission;
    lines.push_back(sentence_of(robot, e));
  }
  return lines;
}

void check_robot(const Stories& stories, const RobotName& robot) {
  if (stories.robots.contains(robot)) return;
  std::vector<std::string> names;
  for (const auto& [name, story] : stories.robots) names.push_back(name);
  std::ranges::sort(names, sorts_before);
  const std::string nearest = nearest_name(robot, names);
  const std::string guess = nearest.empty() ? "" : fmt::format(" (did you mean {}?)", nearest);
  throw InputError(fmt::format("there is no robot {:?}{}: the recording holds {}", robot, guess,
                               listed(names, most_listed)));
}

void check_time(const Stories& stories, double time) {
  // As rounded as the message says them. False for NaN, too.
  if (time >= stories.begin - said_to && time <= stories.end + said_to) return;
  throw InputError(fmt::format("time {:g}: expected a fleet time of the recording, {:.2f} to {:.2f} s", time,
                               stories.begin, stories.end));
}

}  // namespace coppice
