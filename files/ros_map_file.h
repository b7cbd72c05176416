// ROS map_server maps: a YAML file that names a picture (PGM or PNG) and defines the meaning of its shades.
#pragma once

#include <filesystem>

#include "coppice/files/map_file.h"
#include "coppice/planning/occupancy_map.h"

namespace coppice {

/// Throws InputError, which names the file and the field.
OccupancyMap read_ros_map(const std::filesystem::path& path, MapWarnings warnings);

}  // namespace coppice
