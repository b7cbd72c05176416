// A picture (SVG) of a run, like the paper's figures: map, trees in the groups' colours, paths and driven
// tracks.
#pragma once

#include <filesystem>
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
    Point2 start;
    Point2 goal;
    Path path;
    Path track;
  };
  OccupancyMap map;
  std::vector<Edge> edges;
  std::vector<Robot> robots;
};

std::string picture_svg(const PictureContent& content);

/// Throws InputError if the file cannot be written.
void write_picture(const std::filesystem::path& path, const PictureContent& content);

}  // namespace coppice
