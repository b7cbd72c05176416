// The extension module coppice._core: C++ functions on arrays. The Python files of this package check shapes
// and give the functions their names.
//
// Metres in the map frame, seconds. Points are rows of arrays of shape (n, 2).

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <exception>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "coppice/files/input_error.h"
#include "coppice/files/map_file.h"
#include "coppice/files/plan_file.h"
#include "coppice/files/scenario.h"
#include "coppice/files/scenario_file.h"
#include "coppice/files/scenario_generator.h"
#include "coppice/motion/grid_plan.h"
#include "coppice/motion/plan_trajectories.h"
#include "coppice/planning/map_generator.h"
#include "coppice/planning/plan_paths.h"
#include "coppice/planning/planner_kind.h"
#include "coppice/planning/tree_parameters.h"
#include "coppice/simulation/simulate.h"

namespace py = pybind11;

namespace coppice {
namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Cells = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>;
using GridCells = py::array_t<int, py::array::c_style | py::array::forcecast>;

/// A map and its clearance, which is computed once.
struct MapWithClearance {
  explicit MapWithClearance(OccupancyMap occupancy) : map(std::move(occupancy)), field(map) {}
  OccupancyMap map;
  ClearanceField field;
};

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Lets other Python threads run, and notices Ctrl-C ten times a second.
class Work {
 public:
  /// Whether the work is to end.
  bool is_interrupted() {
    if (interrupted_ || steady_seconds() < next_) return interrupted_;
    next_ = steady_seconds() + 0.1;
    const py::gil_scoped_acquire held;
    interrupted_ = PyErr_CheckSignals() != 0;
    return interrupted_;
  }

  /// Returns the work's result, or raises KeyboardInterrupt.
  template <class Fn>
  static auto result_of(Fn&& fn) {
    Work work;
    auto result = [&] {
      const py::gil_scoped_release released;
      return fn(work);
    }();
    if (work.interrupted_) throw py::error_already_set();
    return result;
  }

 private:
  double next_ = steady_seconds() + 0.1;
  bool interrupted_ = false;
};

std::vector<Point2> points_of(const Array& rows) {
  const auto row = rows.unchecked<2>();
  std::vector<Point2> points;
  for (py::ssize_t k = 0; k < row.shape(0); ++k) points.emplace_back(row(k, 0), row(k, 1));
  return points;
}

template <class Points, class Row>
Array array_of(const Points& points, py::ssize_t columns, Row&& row_of) {
  Array rows({static_cast<py::ssize_t>(points.size()), columns});
  auto row = rows.mutable_unchecked<2>();
  for (std::size_t k = 0; k < points.size(); ++k) {
    py::ssize_t column = 0;
    for (const double value : row_of(points[k])) row(static_cast<py::ssize_t>(k), column++) = value;
  }
  return rows;
}

Array array_of(const Path& path) {
  return array_of(path, 2, [](const Point2& p) { return std::array{p.x(), p.y()}; });
}

MapWithClearance map_of(const Cells& blocked, double resolution, double x, double y, bool y_up) {
  const auto cell = blocked.unchecked<2>();
  if (std::max(cell.shape(0), cell.shape(1)) > largest_map_file_side)
    throw InputError("source: expected at most " + std::to_string(largest_map_file_side) + " cells a side");
  OccupancyMap map{.width = static_cast<int>(cell.shape(1)),
                   .height = static_cast<int>(cell.shape(0)),
                   .resolution = resolution,
                   .origin = {x, y},
                   .y_axis = y_up ? YAxis::up : YAxis::down,
                   .blocked = {}};
  map.blocked.reserve(static_cast<std::size_t>(cell.size()));
  for (py::ssize_t j = 0; j < cell.shape(0); ++j) {
    for (py::ssize_t i = 0; i < cell.shape(1); ++i) map.blocked.push_back(cell(j, i) != 0);
  }
  check_map(map);
  const py::gil_scoped_release released;
  return MapWithClearance(std::move(map));
}

py::array_t<bool> blocked_cells(const MapWithClearance& self) {
  py::array_t<bool> cells({self.map.height, self.map.width});
  auto cell = cells.mutable_unchecked<2>();
  for (int j = 0; j < self.map.height; ++j) {
    for (int i = 0; i < self.map.width; ++i) cell(j, i) = self.map.is_blocked(i, j);
  }
  return cells;
}

Array clearance(const MapWithClearance& self, const Array& points) {
  const auto row = points.unchecked<2>();
  Array distances(row.shape(0));
  for (py::ssize_t k = 0; k < row.shape(0); ++k)
    distances.mutable_at(k) = self.field.clearance({row(k, 0), row(k, 1)});
  return distances;
}

MapWithClearance generated_map(const std::string& kind, int width, int height, std::uint64_t seed) {
  const auto known = map_kind(kind);
  if (!known) throw InputError("kind: \"" + kind + "\", expected blank, dense, maze or room");
  return Work::result_of([&](Work&) {
    Random random(seed);
    return MapWithClearance(generate_map(*known, width, height, random));
  });
}

py::tuple tasks_on(const MapWithClearance& self, int count, double radius, double least_share,
                   std::uint64_t seed) {
  const auto tasks = Work::result_of([&](Work&) {
    Random random(seed);
    return random_tasks(self.field, count, radius, least_share, random);
  });
  Path starts;
  Path goals;
  for (const StartAndGoal& task : tasks) {
    starts.push_back(task.start);
    goals.push_back(task.goal);
  }
  return py::make_tuple(array_of(starts), array_of(goals));
}

/// The value of an enumeration that has this name.
template <class E, std::size_t n>
E value_called(const std::string& name, const std::array<std::string_view, n>& names,
               const std::string& argument) {
  const auto at = std::ranges::find(names, name);
  if (at != names.end()) return static_cast<E>(at - names.begin());
  std::string expected(names.front());
  for (std::size_t k = 1; k < n; ++k) expected += (k + 1 < n ? ", " : " or ") + std::string(names[k]);
  throw InputError(argument + ": \"" + name + "\", expected " + expected);
}

PlannerKind planner_of(const std::string& name) {
  return value_called<PlannerKind>(name, planner_names, "planner");
}

std::vector<PlanningProblem> problems_of(const MapWithClearance& map, const Array& starts, const Array& goals,
                                         const std::vector<double>& radii) {
  const std::vector<Point2> from = points_of(starts);
  const std::vector<Point2> to = points_of(goals);
  std::vector<PlanningProblem> problems;
  for (std::size_t k = 0; k < from.size(); ++k) problems.push_back({from[k], to[k], radii[k]});
  if (const auto fault = first_fault(map.field, problems)) {
    const std::string argument(fault->member == "radius" ? "radius" : std::string(fault->member) + "s");
    throw InputError(argument + "[" + std::to_string(fault->problem) + "]: " + fault->what);
  }
  return problems;
}

TreeParameters trees_of(double epsilon, std::uint32_t disjointed_trees, double kappa, double failure_factor,
                        double restart_weight, double spacing, const std::string& restarts) {
  const TreeParameters trees{epsilon,
                             disjointed_trees,
                             kappa,
                             failure_factor,
                             restart_weight,
                             spacing,
                             value_called<Restarts>(restarts, restarts_names, "restarts")};
  if (const auto fault = fault_of(trees)) throw InputError(std::string(*fault));
  return trees;
}

PathPlan plan(const MapWithClearance& map, const Array& starts, const Array& goals,
              const std::vector<double>& radii, const std::string& planner, std::uint64_t seed,
              double timeout, double improve, const TreeParameters& trees) {
  const auto problems = problems_of(map, starts, goals, radii);
  const PlanSettings settings{planner_of(planner), seed, timeout, improve, trees};
  return Work::result_of([&](Work& work) {
    return plan_paths(map.field, problems, settings,
                      {.clock = steady_seconds, .stop = [&] { return work.is_interrupted(); }});
  });
}

template <class Member>
auto of_robots(Member member) {
  return [member](const PathPlan& self) {
    py::list values;
    for (const PlannedPath& robot : self.robots) values.append(member(robot));
    return values;
  };
}

py::tuple edges_of(const PathPlan& self) {
  Array ends = array_of(self.edges, 4, [](const TreeEdge& edge) {
    return std::array{edge.from.x(), edge.from.y(), edge.to.x(), edge.to.y()};
  });
  py::array_t<int> robots(static_cast<py::ssize_t>(self.edges.size()));
  for (std::size_t k = 0; k < self.edges.size(); ++k)
    robots.mutable_at(static_cast<py::ssize_t>(k)) = self.edges[k].robot;
  return py::make_tuple(ends, robots);
}

py::tuple planned_trajectories(const MapWithClearance& map, const Array& starts, const Array& goals,
                               const std::vector<double>& radii, const std::vector<double>& speeds,
                               const std::vector<double>& accelerations, std::uint64_t seed) {
  std::vector<DrivingTask> tasks;
  for (const PlanningProblem& p : problems_of(map, starts, goals, radii)) {
    const std::size_t k = tasks.size();
    tasks.push_back({p.start, p.goal, p.radius, {speeds[k], accelerations[k]}});
  }
  const FleetTrajectories fleet = Work::result_of([&](Work& work) {
    return plan_trajectories(map.field, tasks, seed, [&] { return work.is_interrupted(); });
  });
  py::list trajectories;
  for (const Trajectory& trajectory : fleet.trajectories) {
    trajectories.append(array_of(trajectory, 3, [](const TimedPoint& p) {
      return std::array{p.time, p.position.x(), p.position.y()};
    }));
  }
  return py::make_tuple(trajectories, fleet.stranded);
}

std::vector<GridCell> cells_of(const GridCells& rows) {
  const auto row = rows.unchecked<2>();
  std::vector<GridCell> cells;
  for (py::ssize_t k = 0; k < row.shape(0); ++k) cells.push_back({row(k, 0), row(k, 1)});
  return cells;
}

GridPlan grid_plan_of(const std::vector<GridCells>& robots) {
  GridPlan plan;
  for (const GridCells& cells : robots) plan.push_back(cells_of(cells));
  return plan;
}

py::list arrays_of(const GridPlan& plan) {
  py::list robots;
  for (const std::vector<GridCell>& cells : plan) {
    GridCells rows({static_cast<py::ssize_t>(cells.size()), py::ssize_t{2}});
    auto row = rows.mutable_unchecked<2>();
    for (std::size_t k = 0; k < cells.size(); ++k) {
      row(static_cast<py::ssize_t>(k), 0) = cells[k].x;
      row(static_cast<py::ssize_t>(k), 1) = cells[k].y;
    }
    robots.append(rows);
  }
  return robots;
}

std::optional<py::list> plan_on_cells(const MapWithClearance& map, const GridCells& starts,
                                      const GridCells& goals, std::uint64_t seed) {
  const std::vector<GridCell> from = cells_of(starts);
  const std::vector<GridCell> to = cells_of(goals);
  std::vector<GridTask> tasks;
  for (std::size_t k = 0; k < from.size(); ++k) tasks.push_back({from[k], to[k]});
  const auto plan = Work::result_of([&](Work&) { return plan_on_grid(map.map, tasks, seed); });
  return plan ? std::optional(arrays_of(*plan)) : std::nullopt;
}

Scenario scenario_of(const MapWithClearance& map, const std::vector<std::string>& names, const Array& starts,
                     const Array& goals, const std::vector<double>& radii, const std::vector<double>& speeds,
                     const std::vector<double>& accelerations, double tolerance, std::uint32_t seed) {
  Scenario scenario{.map_name = "map", .map = map.map, .seed = seed, .robots = {}};
  const std::vector<Point2> from = points_of(starts);
  const std::vector<Point2> to = points_of(goals);
  for (std::size_t k = 0; k < names.size(); ++k)
    scenario.robots.push_back({names[k], from[k], to[k], radii[k], speeds[k], accelerations[k], tolerance});
  check_scenario(scenario);
  return scenario;
}

Array places_of(const Scenario& self, Point2 RobotTask::*place) {
  Path places;
  for (const RobotTask& robot : self.robots) places.push_back(robot.*place);
  return array_of(places);
}

Array values_of(const Scenario& self, double RobotTask::*value) {
  Array values(static_cast<py::ssize_t>(self.robots.size()));
  for (std::size_t k = 0; k < self.robots.size(); ++k)
    values.mutable_at(static_cast<py::ssize_t>(k)) = self.robots[k].*value;
  return values;
}

Coordination coordination_of(const std::string& name, bool rounds) {
  const auto chosen = value_called<Coordination>(name, coordination_names, "coordination");
  if (rounds) return chosen;
  if (reserves(chosen)) throw InputError("rounds: false, goes with coordination \"rvo\" only");
  return Coordination::rvo_without_rounds;
}

py::tuple simulate_with(const Scenario& scenario, const Faults& faults, double timeout,
                        const std::string& planner, double plan_budget, double lifelong,
                        const TreeParameters& trees, const std::string& forest,
                        const std::optional<std::vector<GridCells>>& plan, const std::string& coordination,
                        bool rounds) {
  const SimulationSettings settings{
      timeout,
      planner_of(planner),
      plan_budget,
      lifelong,
      faults,
      trees,
      value_called<ForestStart>(forest, forest_names, "forest"),
      plan ? trajectories_of(grid_plan_of(*plan), scenario) : std::vector<Trajectory>(),
      coordination_of(coordination, rounds)};
  const SimulatedRun run = Work::result_of([&](Work& work) {
    return simulate(scenario, settings, [&](double) { return work.is_interrupted(); });
  });
  py::list tracks;
  for (const Track& track : run.tracks) {
    tracks.append(array_of(track.points, 7, [](const TrackPoint& p) {
      return std::array{p.time,         p.position.x(), p.position.y(),    p.velocity.x(),
                        p.velocity.y(), p.yaw,          p.angular_velocity};
    }));
  }
  return py::make_tuple(run.report, tracks, run.broken);
}

Faults faults_of(double loss, double delay, double jitter, double duplicate, bool reorder,
                 const std::vector<std::pair<double, double>>& partitions, double kill_rate,
                 const std::vector<std::pair<std::string, double>>& kills, double restart_after,
                 double pause_rate, double pause, double clock_skew) {
  Faults faults{.bus = {loss, delay, jitter, duplicate, reorder},
                .kill_rate = kill_rate,
                .pause_rate = pause_rate,
                .pause = pause,
                .clock_skew = clock_skew,
                .restart_after = restart_after};
  for (const auto& [from, until] : partitions) faults.bus.partitions.push_back({from, until});
  for (const auto& [robot, time] : kills) faults.kills.push_back({robot, time});
  return faults;
}

}  // namespace

PYBIND11_MODULE(_core, m) {
  m.attr("version") = COPPICE_VERSION;
  py::register_exception<InputError>(m, "InputError", PyExc_ValueError);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const std::invalid_argument& problem) {
      const py::object kind = py::module_::import("coppice._core").attr("InputError");
      PyErr_SetString(kind.ptr(), problem.what());
    }
  });

  py::class_<MapWithClearance>(m, "Map")
      .def(py::init(&map_of))
      .def_property_readonly("blocked", &blocked_cells)
      .def_property_readonly(
          "shape",
          [](const MapWithClearance& self) { return py::make_tuple(self.map.height, self.map.width); })
      .def_property_readonly("resolution", [](const MapWithClearance& self) { return self.map.resolution; })
      .def_property_readonly("origin",
                             [](const MapWithClearance& self) {
                               return py::make_tuple(self.map.origin.x(), self.map.origin.y());
                             })
      .def_property_readonly("y_up",
                             [](const MapWithClearance& self) { return self.map.y_axis == YAxis::up; })
      .def("clearance", &clearance)
      .def("write", [](const MapWithClearance& self, const std::string& path) { write_map(path, self.map); });
  m.def("read_map", [](const std::string& path) { return MapWithClearance(read_map(path)); });
  m.def("generate_map", &generated_map);
  m.def("random_tasks", &tasks_on);

  py::class_<PathPlan>(m, "PathPlan")
      .def_property_readonly("paths",
                             of_robots([](const PlannedPath& robot) { return array_of(robot.path); }))
      .def_property_readonly("reasons", of_robots([](const PlannedPath& robot) { return robot.reason; }))
      .def_property_readonly("solved_after",
                             of_robots([](const PlannedPath& robot) { return robot.solved_after; }))
      .def_property_readonly("valid_nodes",
                             of_robots([](const PlannedPath& robot) { return robot.counts.valid; }))
      .def_property_readonly("invalid_nodes",
                             of_robots([](const PlannedPath& robot) { return robot.counts.invalid; }))
      .def_property_readonly("grafted_trees",
                             of_robots([](const PlannedPath& robot) { return robot.grafted_trees; }))
      .def_property_readonly(
          "disjointed_nodes",
          [](const PathPlan& self) { return py::make_tuple(self.disjointed.valid, self.disjointed.invalid); })
      .def_readonly("frozen_trees", &PathPlan::frozen_trees)
      .def_property_readonly("edges", &edges_of)
      .def_readonly("plan_time", &PathPlan::plan_time)
      .def_readonly("improve_time", &PathPlan::improve_time);
  py::class_<TreeParameters>(m, "TreeParameters").def(py::init(&trees_of));
  m.def("plan", &plan);
  m.def("plan_trajectories", &planned_trajectories);

  m.def("plan_on_grid", &plan_on_cells);
  m.def("read_grid_plan", [](const std::string& path) { return arrays_of(read_grid_plan(path)); });
  m.def("write_grid_plan", [](const std::string& path, const std::vector<GridCells>& plan,
                              const std::string& form) {
    write_grid_plan(path, grid_plan_of(plan), value_called<GridPlanForm>(form, grid_plan_forms, "form"));
  });

  py::class_<Scenario>(m, "Scenario")
      .def(py::init(&scenario_of))
      .def_property_readonly("map", [](const Scenario& self) { return MapWithClearance(self.map); })
      .def_property_readonly("names", &names_of)
      .def_property_readonly("starts",
                             [](const Scenario& self) { return places_of(self, &RobotTask::start); })
      .def_property_readonly("goals", [](const Scenario& self) { return places_of(self, &RobotTask::goal); })
      .def_property_readonly("radius",
                             [](const Scenario& self) { return values_of(self, &RobotTask::radius); })
      .def_property_readonly("max_speed",
                             [](const Scenario& self) { return values_of(self, &RobotTask::max_speed); })
      .def_property_readonly(
          "max_acceleration",
          [](const Scenario& self) { return values_of(self, &RobotTask::max_acceleration); })
      .def_property_readonly("goal_tolerance",
                             [](const Scenario& self) { return values_of(self, &RobotTask::goal_tolerance); })
      .def_readonly("seed", &Scenario::seed);
  m.def("read_scenario", [](const std::string& path, std::optional<int> robots, std::optional<double> radius,
                            std::optional<double> max_speed, std::optional<std::uint32_t> seed) {
    return read_scenario(path, {robots, radius, max_speed, seed});
  });
  m.def("make_scenario", &make_scenario);

  py::class_<Faults>(m, "Faults").def(py::init(&faults_of));
  m.def("simulate", &simulate_with);
}

}  // namespace coppice
