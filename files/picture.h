// A picture (SVG) of a run, or of a moment in it, like the paper's figures: map, trees in the groups'
// colours, paths and driven tracks.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planning/geometry.h"
#include "planning/occupancy_map.h"

namespace coppice {

struct PictureContent {
  struct Edge {
    Point2 from;
    Point2 to;
    int robot = -1;  ///< index of the robot whose root tree it belongs to; -1: a disjointed tree
  };
  struct Robot {
    std::string name;
    double radius = 0;
    Point2 start = Point2::Zero();
    Point2 goal = Point2::Zero();
    Path path{};
    Path track{};
    std::optional<Point2> body{};  ///< where it is; none where the picture is of a whole run
  };
  OccupancyMap map;
  std::vector<Edge> edges;
  std::vector<Robot> robots;
};

std::string picture_svg(const PictureContent& content);

/// Throws InputError if the file cannot be written.
void write_picture(const std::filesystem::path& path, const PictureContent& content);

}  // namespace coppice
