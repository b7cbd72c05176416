// Centralised planners as references for throughput: all robots are planned for at once, before any moves.
//
// Both give robots that are never late and reach full speed at once.
//
// Metres in the map frame, seconds.
#pragma once

#include <optional>
#include <string>

#include "bench/reference_figures.h"
#include "coppice/files/scenario.h"

namespace coppice {

/// Prioritised planning (Erdmann, Lozano-Pérez, "On Multiple Moving Objects", 1987): one robot after the
/// other, the longest way first (van den Berg, Overmars, "Prioritized Motion Planning for Multiple Robots",
/// 2005), plans the earliest trajectory around those before it, at any angle. A robot that finds none comes
/// first in the next attempt (Andreychuk, Yakovlev, "Two Techniques That Enhance the Performance of
/// Multi-Robot Prioritized Path Planning", 2018). Nothing after 20 attempts.
std::optional<ReferenceFigures> prioritised_planning(const Scenario& scenario);

/// Whether all robots are equal, at most 20, start and end in the centres of cells, and fit into a cell.
bool is_for_conflict_based_search(const Scenario& scenario);
/// Conflict-based search (Sharon, Stern, Felner, Sturtevant, "Conflict-Based Search for Optimal Multi-Agent
/// Pathfinding", 2015): the least sum of arrival times on the grid, where robots step from cell to cell or
/// wait. Nothing if a goal cannot be reached, or if the search takes more than `most_nodes` nodes.
std::optional<ReferenceFigures> conflict_based_search(const Scenario& scenario, std::size_t most_nodes);

}  // namespace coppice
