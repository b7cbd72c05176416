// A picture (SVG) of a run, or of a moment in it: map, trees in the colours of their robots, paths and driven
// tracks, as in the paper's figures. Positions and radii are in metres in the map frame.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "coppice/files/scenario.h"
#include "coppice/planning/geometry.h"
#include "coppice/planning/occupancy_map.h"

namespace coppice {

struct PictureContent {
  struct Edge {
    Point2 from;
    Point2 to;
    int robot = -1;  ///< index of the robot whose root tree the edge belongs to; -1: a disjointed tree
  };
  struct Robot {
    std::string name;
    double radius = 0;
    Point2 start = Point2::Zero();
    Point2 goal = Point2::Zero();
    Path path{};
    Path track{};
    /// Position at the moment of the picture; none for a picture of a whole run.
    std::optional<Point2> body{};
    std::vector<Point2> footprint{};  ///< corners in the robot's own frame; empty: a disc
    double yaw = 0;                   ///< of the body, or at the start
    double goal_yaw = 0;
    bool has_heading = false;  ///< the yaws say something
  };
  OccupancyMap map;
  std::vector<Edge> edges;
  std::vector<Robot> robots;
};

/// The robot of a task as it stands at its start, without a path.
PictureContent::Robot robot_of(const RobotTask& task);

std::string picture_svg(const PictureContent& content);

/// Throws InputError if the file cannot be written.
void write_picture(const std::filesystem::path& path, const PictureContent& content);

}  // namespace coppice
