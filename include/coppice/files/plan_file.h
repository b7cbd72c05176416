// Joint plans of grid planners (multi-agent path finding, MAPF): a cell for each robot at each time step.
//
// Two text forms are read, and written in the same way.
//
// Steps: "0:(x,y),(x,y),..." for each time step, a cell for each robot. LaCAM and PIBT (Okumura) write it
// after lines KEY=VALUE and a line "solution="; these are ignored and may be missing, as in the form of
// mapf-visualizer (Okumura). A cell may have a heading, as there: "(x,y,X_PLUS)". Headings are ignored.
//
// Agents: "Agent 0: (row,column)->(row,column)->..." for each robot. CBS, EECBS and MAPF-LNS (Li, Harabor,
// Stuckey, Koenig) write it.
//
// Cells count from 0. x and column count cells of the map along x, y and row along y.
#pragma once

#include <array>
#include <filesystem>
#include <string_view>
#include <vector>

#include "coppice/files/scenario.h"
#include "coppice/motion/grid_plan.h"
#include "coppice/motion/trajectory.h"

namespace coppice {

enum class GridPlanForm : unsigned char { steps, agents };

inline constexpr std::array<std::string_view, 2> grid_plan_forms{"steps", "agents"};

/// Throws InputError, which names the file, the line and what was expected.
GridPlan read_grid_plan(const std::filesystem::path& path);

/// Reads a plan and gives it times, as below.
std::vector<Trajectory> read_plan(const std::filesystem::path& path, const Scenario& scenario);

/// Throws InputError if the file cannot be written.
void write_grid_plan(const std::filesystem::path& path, const GridPlan& plan, GridPlanForm form);

/// The robots' tasks on the cells. Throws InputError, which names the robot, if a robot does not start and
/// end in the middle of a cell, or is wider than a cell.
std::vector<GridTask> grid_tasks_of(const Scenario& scenario);

/// The trajectories of the robots of a scenario, from time 0 on. A step takes as long as the slowest robot
/// takes for a cell. Throws InputError, which names the robot and the step, if the plan is not one of this
/// scenario: another number of robots, another start or goal, a step to a cell that is no neighbour, a robot
/// that touches an obstacle or another robot.
std::vector<Trajectory> trajectories_of(const GridPlan& plan, const Scenario& scenario);

}  // namespace coppice
