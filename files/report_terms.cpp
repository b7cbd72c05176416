#include "files/report_terms.h"

#include <fmt/format.h>

namespace coppice {

namespace {

constexpr Term of_table[] = {
    {"arrived", "in front of the first line: every robot stands at its goal"},
    {"planned", "the same, of coppice plan: every robot has a path"},
    {"incomplete", "the run has ended, but some robots have no path or did not arrive"},
    {"timeout", "the run was ended by --timeout"},
    {"interrupted", "somebody ended the run"},
    {"missions fulfilled", "goals that were reached by all robots together (--lifelong)"},
    {"robots that arrived and got no new goal", "none was found that they could reach (--lifelong)"},
    {"plan time", "seconds of the machine's clock from the missions to the last first path"},
    {"shorter paths after", "further seconds until the last shorter path was found or the search ended"},
    {"run time", "fleet seconds from the start of the run until the last robot stood at its goal"},
    {"mean path length", "metres, over the robots that have a path"},
    {"nodes valid, invalid", "samples that became nodes of trees, and samples that hit an obstacle"},
    {"trees published",
     "disjointed trees that a robot's root tree came near to, and that the broker gave to all"},
    {"trees grafted", "published trees that robots took into their own trees, summed over the robots"},
    {"collisions",
     "pairs of robots that overlapped, plus robots that overlapped an obstacle, unless they began so and "
     "drove out"},
    {"least separation", "least distance between two robots at any time, minus both radii"},
    {"least clearance", "least distance of a robot to an obstacle at any time, minus its radius"},
    {"margin",
     "metres that robots keep from obstacles, and from each other where there is room; told if any"},
    {"control periods missed",
     "share of the control periods for which agents got the processor too late; told from 1 % on"},
    {"plan s", "column: seconds of the machine's clock from the robot's mission to its first path"},
    {"run s", "column: fleet seconds until the robot stood at its goal; - if it did not arrive"},
    {"path m", "column: length of the robot's path, metres"},
    {"driven m", "column: length of the way that the robot drove, metres"},
    {"valid, invalid, grafted", "columns: the same counts as above, of the robot's own two root trees"},
    {"yaw", "column, if there is a differential robot: radians, where it stands in the end"},
    {"reason", "at the end of a row: why the robot did not arrive, or got no new goal"},
};

constexpr Term of_report[] = {
    {"outcome", "arrived, planned (coppice plan), incomplete, interrupted or timeout, as in the table"},
    {"seed", "of every random choice"},
    {"map", "the map, as the scenario names it"},
    {"plan_time",
     "seconds from the missions to the last first path, by the machine's clock; in simulate by the virtual "
     "one"},
    {"improve_time", "further seconds until the last shorter path was found or the search for one ended"},
    {"last_path_at", "when the last first path was found, seconds since the Unix epoch"},
    {"run_time", "fleet seconds from the start of the run until the last robot stood at its goal"},
    {"path_length", "metres, mean over the robots that have a path"},
    {"nodes_valid", "nodes of all trees, of the broker and the robots together"},
    {"nodes_invalid", "samples that hit an obstacle, of the broker and the robots together"},
    {"trees_published", "disjointed trees that the broker gave to all"},
    {"trees_grafted", "published trees that robots took into their own trees, summed over the robots"},
    {"collisions",
     "pairs of robots that overlapped, plus robots that overlapped an obstacle, unless they began so and "
     "drove out"},
    {"least_separation",
     "metres, least distance between two robots at any time minus both radii; absent for one robot"},
    {"least_clearance", "metres, least distance of a robot to an obstacle at any time minus its radius"},
    {"margin",
     "metres that robots keep from obstacles beyond their radius, and from each other where there is room"},
    {"least_separation_with_margin", "least_separation minus the margin; below 0: there was no room for it"},
    {"least_clearance_with_margin", "least_clearance minus the margin"},
    {"missions", "goals that were reached by all robots together"},
    {"goals_refused", "goals that were asked for over ROS and could not be given"},
    {"robots_without_goal", "robots that arrived, were to get a new goal (--lifelong), and got none"},
    {"periods_missed",
     "share of the control periods of all robots for which their agents got the processor too late"},
    {"robots", "a row for each robot, in the order of the scenario"},
    {"robots[].name", "the robot's name in the scenario"},
    {"robots[].planned", "whether it has a path"},
    {"robots[].arrived", "whether it stands within the tolerance of its goal"},
    {"robots[].reason",
     "why it did not arrive, or why it got no new goal after that (--lifelong); else empty"},
    {"robots[].plan_time", "seconds from its mission to its first path"},
    {"robots[].run_time", "fleet seconds from the start of the run until it stood at its goal"},
    {"robots[].yaw", "radians, where it stands in the end; absent for a holonomic robot"},
    {"robots[].path_length", "length of its path, metres"},
    {"robots[].driven_length", "length of the way that it drove, metres"},
    {"robots[].points_missing",
     "points of its track that never came, or too late to be counted: they are in no length and no "
     "separation"},
    {"robots[].path", "corners of its path, from its start to its goal"},
    {"robots[].path[].x", "metres in the map frame"},
    {"robots[].path[].y", "metres in the map frame"},
    {"robots[].nodes_valid", "nodes of its own two root trees"},
    {"robots[].nodes_invalid", "its own samples that hit an obstacle"},
    {"robots[].grafted_trees", "published trees that it took into its own trees"},
    {"robots[].periods_missed",
     "share of its control periods in this run for which its agent got the processor too late"},
    {"robots[].free_flow_time",
     "seconds for its path from standstill to standstill, with nobody in its way; bends cost nothing here"},
    {"robots[].waited",
     "fleet seconds of its last mission in which it was slower than a tenth of its maximum speed"},
    {"robots[].waits", "the same seconds, by what it waited for"},
    {"robots[].waits.startup", "the missions of all robots, and to hear where all are"},
    {"robots[].waits.planning", "its first path"},
    {"robots[].waits.reservation", "its turn to reserve, or room in space and time"},
    {"robots[].waits.joint_plan", "a joint plan, or others to finish theirs"},
    {"robots[].waits.gate", "a robot that goes first by the reservations or the joint plan"},
    {"robots[].waits.promise", "other robots might have come where it wanted to go"},
    {"robots[].waits.connection", "it was cut off, or its agent was restarted"},
    {"robots[].waits.odometry", "odometry, or its robot to come to where it should be"},
    {"robots[].missions", "goals that it reached; more than one with --lifelong"},
    {"robots[].load",
     "what its agent's process had to do, as the agent counted it; absent if it was never heard"},
    {"robots[].load.samples_received", "messages of all topics that it received"},
    {"robots[].load.states_received", "of these, states of other robots, copies included"},
    {"robots[].load.periods", "control periods"},
    {"robots[].load.periods_missed", "control periods that were over before it came to decide for them"},
    {"robots[].load.agents_matched", "other agents that it found"},
    {"robots[].load.matched_at", "when it found the last of them, seconds since the Unix epoch"},
    {"robots[].load.bytes_sent", "in UDP datagrams"},
    {"robots[].load.bytes_received", "in UDP datagrams"},
    {"robots[].load.state_age_p50",
     "median age of states of robots that it might soon have touched, when used, fleet seconds"},
    {"robots[].load.state_age_p99", "age that 99 of 100 of these states did not exceed, fleet seconds"},
    {"robots[].load.state_age_max", "age of the oldest of these states, fleet seconds"},
    {"robots[].load.processor_seconds", "processor time that the process took, seconds"},
};

std::string lines_of(std::string_view title, std::span<const Term> terms) {
  std::string lines(title);
  for (const Term& term : terms) lines += fmt::format("\n{}\t{}", term.name, term.meaning);
  return lines;
}

}  // namespace

std::span<const Term> table_terms() {
  return of_table;
}

std::span<const Term> report_terms() {
  return of_report;
}

std::string terms_of_table() {
  return lines_of("Terms of the table:", of_table);
}

std::string terms_of_report() {
  return lines_of("Fields of the report (--report, JSON):", of_report);
}

}  // namespace coppice
