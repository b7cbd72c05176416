#include "coppice/files/plan_file.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "coppice/files/input_error.h"
#include "coppice/motion/separation.h"
#include "coppice/planning/clearance_field.h"
#include "files/file_kind.h"
#include "files/text_file.h"
#include "motion/trajectory/segments.h"

namespace coppice {

namespace {

constexpr std::size_t most_cells = 100'000'000;  // of all robots and steps
constexpr double off_centre = 1e-6;              // of a cell: rounding
constexpr std::string_view agent = "Agent ";
constexpr std::string_view solution = "solution=";

/// Reads a line from left to right. Blanks count for nothing.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}

  bool take(std::string_view word) {
    skip_blanks();
    if (!rest_.starts_with(word)) return false;
    rest_.remove_prefix(word.size());
    return true;
  }
  std::optional<int> number() {
    skip_blanks();
    int value = 0;
    const auto [end, problem] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (problem != std::errc()) return std::nullopt;
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return value;
  }
  /// "(3,4)".
  std::optional<std::pair<int, int>> pair() {
    if (!take("(")) return std::nullopt;
    const auto first = number();
    if (!first || !take(",")) return std::nullopt;
    const auto second = number();
    if (!second || !take(")")) return std::nullopt;
    return std::pair(*first, *second);
  }
  /// "(3,4)", or "(3,4,X_PLUS)" with a heading, which is left out.
  std::optional<GridCell> cell() {
    if (!take("(")) return std::nullopt;
    const auto x = number();
    if (!x || !take(",")) return std::nullopt;
    const auto y = number();
    if (!y || (take(",") && !take_heading()) || !take(")")) return std::nullopt;
    return GridCell{*x, *y};
  }
  /// Whether the line goes on with the number of a step: "0:".
  bool begins_a_step() const {
    Words rest(rest_);
    return rest.number() && rest.take(":");
  }
  bool at_end() {
    skip_blanks();
    return rest_.empty();
  }

 private:
  bool take_heading() { return take("X_PLUS") || take("X_MINUS") || take("Y_PLUS") || take("Y_MINUS"); }
  void skip_blanks() {
    while (!rest_.empty() && std::isspace(static_cast<unsigned char>(rest_.front())) != 0)
      rest_.remove_prefix(1);
  }
  std::string_view rest_;
};

[[noreturn]] void fail(const std::filesystem::path& path, int line, const std::string& problem) {
  throw InputError(fmt::format("{}:{}: {}", path.string(), line, problem));
}

/// A line of the form "agents" is the next robot.
std::vector<GridCell> cells_of_agent(Words words, std::size_t robot, const std::filesystem::path& path,
                                     int line) {
  const auto number = words.number();
  if (!number || std::cmp_not_equal(*number, robot) || !words.take(":"))
    fail(path, line, fmt::format("expected \"Agent {}: (row,column)->(row,column)->...\"", robot));
  std::vector<GridCell> cells;
  do {
    if (!cells.empty() && words.at_end()) break;  // a last arrow leads nowhere
    const auto cell = words.pair();
    if (!cell) fail(path, line, fmt::format("step {}: expected \"(row,column)\"", cells.size()));
    cells.push_back({cell->second, cell->first});
  } while (words.take("->"));
  if (!words.at_end()) fail(path, line, fmt::format("step {}: expected \"->\"", cells.size()));
  return cells;
}

/// A line of the form "steps" is the next time step of all robots.
std::vector<GridCell> cells_at_step(Words words, std::size_t step, const std::filesystem::path& path,
                                    int line) {
  const auto number = words.number();
  if (!number || std::cmp_not_equal(*number, step) || !words.take(":"))
    fail(path, line, fmt::format("expected \"{}:(x,y),(x,y),...\"", step));
  std::vector<GridCell> cells;
  while (!words.at_end()) {
    const auto cell = words.cell();
    if (!cell)
      fail(path, line,
           fmt::format(
               "robot {}: expected \"(x,y)\" or \"(x,y,HEADING)\" with X_PLUS, X_MINUS, Y_PLUS or Y_MINUS",
               cells.size()));
    cells.push_back(*cell);
    if (!words.take(",") && !words.at_end())
      fail(path, line, fmt::format("robot {}: expected \",\"", cells.size()));
  }
  return cells;
}

Point2 centre(const OccupancyMap& map, const GridCell& cell) {
  return map.origin + map.resolution * (Point2(cell.x, cell.y) + Point2(0.5, 0.5));
}

std::string as_text(const GridCell& cell) {
  return fmt::format("({},{})", cell.x, cell.y);
}

/// Nothing if the cells lead the robot from its start to its goal, step by step.
std::optional<std::string> problem_with(const std::vector<GridCell>& cells, const RobotTask& robot,
                                        const OccupancyMap& map) {
  const auto is_at = [&](const GridCell& cell, const Point2& p) {
    return (centre(map, cell) - p).norm() <= off_centre * map.resolution;
  };
  if (cells.empty()) return "has no cell";
  for (std::size_t t = 0; t < cells.size(); ++t) {
    if (map.is_blocked(cells[t].x, cells[t].y))
      return fmt::format("is at {} at step {}, which is blocked or not on the map", as_text(cells[t]), t);
    if (t > 0 && std::abs(cells[t].x - cells[t - 1].x) + std::abs(cells[t].y - cells[t - 1].y) > 1)
      return fmt::format("steps from {} to {} at step {}, expected a neighbouring cell or the same",
                         as_text(cells[t - 1]), as_text(cells[t]), t);
  }
  if (!is_at(cells.front(), robot.start))
    return fmt::format("begins at {}, whose centre is not its start ({}, {})", as_text(cells.front()),
                       robot.start.x(), robot.start.y());
  if (!is_at(cells.back(), robot.goal))
    return fmt::format("ends at {}, whose centre is not its goal ({}, {})", as_text(cells.back()),
                       robot.goal.x(), robot.goal.y());
  return std::nullopt;
}

/// A point where the robot begins to move, turns or comes to stand.
Trajectory trajectory_of(const std::vector<GridCell>& cells, const OccupancyMap& map, double step) {
  const auto moves_alike = [&](std::size_t t) {
    return cells[t + 1].x - cells[t].x == cells[t].x - cells[t - 1].x &&
           cells[t + 1].y - cells[t].y == cells[t].y - cells[t - 1].y;
  };
  Trajectory trajectory;
  for (std::size_t t = 0; t < cells.size(); ++t) {
    if (t > 0 && t + 1 < cells.size() && moves_alike(t)) continue;
    trajectory.push_back({step * static_cast<double>(t), centre(map, cells[t])});
  }
  return trajectory;
}

/// The first step in which two robots touch that do so.
std::size_t step_of_contact(const GridPlan& plan, std::size_t a, std::size_t b, const Scenario& scenario) {
  const double near =
      reference_radius(scenario.robots[a]) + reference_radius(scenario.robots[b]) - overlap_tolerance;
  const auto at = [&](std::size_t robot, std::size_t t) {
    return centre(scenario.map, plan[robot][std::min(t, plan[robot].size() - 1)]);
  };
  std::size_t t = 0;
  while (closest_approach(at(a, t), at(a, t + 1), at(b, t), at(b, t + 1)) >= near &&
         t < std::max(plan[a].size(), plan[b].size()))
    ++t;
  return t;
}

void check_that_nothing_touches(const GridPlan& plan, std::span<const Trajectory> trajectories,
                                const Scenario& scenario) {
  std::vector<Track> tracks;
  for (std::size_t k = 0; k < trajectories.size(); ++k) {
    Track& track = tracks.emplace_back(Track{reference_radius(scenario.robots[k]), {}});
    for (const TimedPoint& p : trajectories[k]) track.points.push_back({p.time, p.position, Point2::Zero()});
  }
  const ObstacleClearance clearance =
      clearance_of(tracks, ClearanceField(scenario.map)).value_or(ObstacleClearance{});
  if (!clearance.overlapping.empty())
    throw InputError(fmt::format("the plan: {} touches an obstacle, radius {:g}",
                                 scenario.robots[*clearance.overlapping.begin()].name,
                                 reference_radius(scenario.robots[*clearance.overlapping.begin()])));
  const Separation separation = separation_of(tracks).value_or(Separation{});
  if (separation.overlapping.empty()) return;
  const auto [a, b] = *separation.overlapping.begin();
  throw InputError(fmt::format("the plan: {} and {} touch after step {}, radii {:g} and {:g}",
                               scenario.robots[a].name, scenario.robots[b].name,
                               step_of_contact(plan, a, b, scenario), reference_radius(scenario.robots[a]),
                               reference_radius(scenario.robots[b])));
}

}  // namespace

GridPlan read_grid_plan(const std::filesystem::path& path) {
  refuse_other_kinds(path, {}, "a joint plan (\"0:(x,y),...\" or \"Agent 0: (row,column)->...\")");
  GridPlan plan;
  std::istringstream lines(read_text(path));
  std::string line;
  bool in_solution = false;
  std::size_t step = 0;
  std::size_t cells = 0;
  for (int number = 1; std::getline(lines, line); ++number) {
    Words words(line);
    if (words.at_end()) continue;
    if (words.take(agent)) {
      if (in_solution) fail(path, number, fmt::format("expected \"{}:(x,y),...\"", step));
      plan.push_back(cells_of_agent(words, plan.size(), path, number));
      cells += plan.back().size();
    } else if (in_solution || (plan.empty() && words.begins_a_step())) {
      in_solution = true;
      const std::vector<GridCell> at = cells_at_step(words, step, path, number);
      if (step == 0) plan.resize(at.size());
      if (at.size() != plan.size() || at.empty())
        fail(path, number,
             fmt::format("has {} cells, expected {}", at.size(), std::max<std::size_t>(1, plan.size())));
      for (std::size_t k = 0; k < at.size(); ++k) plan[k].push_back(at[k]);
      cells += at.size();
      ++step;
    } else if (words.take(solution)) {
      in_solution = plan.empty();
    } else if (!plan.empty() || line.find('=') == std::string::npos) {
      fail(path, number,
           "expected \"0:(x,y),...\", \"Agent N: (row,column)->...\", or KEY=VALUE before \"solution=\"");
    }
    if (cells > most_cells) fail(path, number, fmt::format("has more than {} cells", most_cells));
  }
  if (plan.empty())
    throw InputError(path.string() + ": has no plan, expected \"0:(x,y),...\" or \"Agent 0: ...\"");
  return plan;
}

std::vector<Trajectory> read_plan(const std::filesystem::path& path, const Scenario& scenario) {
  const GridPlan plan = read_grid_plan(path);
  try {
    return trajectories_of(plan, scenario);
  } catch (const InputError& problem) {
    throw InputError(fmt::format("{}: {}", path.string(), problem.what()));
  }
}

void write_grid_plan(const std::filesystem::path& path, const GridPlan& plan, GridPlanForm form) {
  write_file(path, [&](std::ostream& out) {
    std::size_t steps = 0;
    for (const auto& cells : plan) steps = std::max(steps, cells.size());
    if (form == GridPlanForm::agents) {
      for (std::size_t k = 0; k < plan.size(); ++k) {
        out << agent << k << ": ";
        for (const GridCell& cell : plan[k]) out << '(' << cell.y << ',' << cell.x << ")->";
        out << '\n';
      }
      return;
    }
    out << "agents=" << plan.size() << "\nsolved=1\nmakespan=" << (steps > 0 ? steps - 1 : 0) << '\n'
        << solution << '\n';
    for (std::size_t t = 0; t < steps; ++t) {
      out << t << ':';
      for (const auto& cells : plan) out << as_text(cells[std::min(t, cells.size() - 1)]) << ',';
      out << '\n';
    }
  });
}

std::vector<GridTask> grid_tasks_of(const Scenario& scenario) {
  const OccupancyMap& map = scenario.map;
  const auto cell_of = [&](const Point2& p, const std::string& robot, const char* end) {
    const Point2 q = (p - map.origin) / map.resolution;
    const GridCell cell{static_cast<int>(std::floor(q.x())), static_cast<int>(std::floor(q.y()))};
    if ((centre(map, cell) - p).norm() > off_centre * map.resolution)
      throw InputError(
          fmt::format("the {} ({}, {}) of {} is not in the middle of a cell", end, p.x(), p.y(), robot));
    return cell;
  };
  std::vector<GridTask> tasks;
  for (const RobotTask& robot : scenario.robots) {
    if (2 * reference_radius(robot) > map.resolution)
      throw InputError(fmt::format("{} is wider than a cell: radius {:g}, cells of {:g} m", robot.name,
                                   reference_radius(robot), map.resolution));
    tasks.push_back({cell_of(robot.start, robot.name, "start"), cell_of(robot.goal, robot.name, "goal")});
  }
  return tasks;
}

std::vector<Trajectory> trajectories_of(const GridPlan& plan, const Scenario& scenario) {
  if (plan.size() != scenario.robots.size())
    throw InputError(
        fmt::format("the plan is for {} robots, expected {}", plan.size(), scenario.robots.size()));
  double step = 0;  // seconds
  for (const RobotTask& robot : scenario.robots)
    step = std::max(step, scenario.map.resolution / robot.max_speed);
  std::vector<Trajectory> trajectories;
  for (std::size_t k = 0; k < plan.size(); ++k) {
    const RobotTask& robot = scenario.robots[k];
    if (const auto problem = problem_with(plan[k], robot, scenario.map))
      throw InputError(fmt::format("the plan: {} {}", robot.name, *problem));
    trajectories.push_back(trajectory_of(plan[k], scenario.map, step));
  }
  check_that_nothing_touches(plan, trajectories, scenario);
  return trajectories;
}

}  // namespace coppice
