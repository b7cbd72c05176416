// Map files: Moving AI `.map`, and ROS map_server YAML with a PGM or PNG picture.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "planning/occupancy_map.h"
#include "planning/random.h"

namespace coppice {

/// What becomes of doubts about a map that can be read: `left_out` where another process reads it, too.
enum class MapWarnings : std::uint8_t { logged, left_out };

/// Reads a `.map` (https://movingai.com/benchmarks/formats.html: `.`, `G` and `S` are free, all else is
/// blocked; one cell is one metre, y grows downwards) or a `.yaml` (ROS map_server: resolution, origin,
/// negate, thresholds; y grows upwards; what is not known to be free is blocked). Throws InputError, which
/// names the file and the line or field.
OccupancyMap read_map(const std::filesystem::path& path, MapWarnings warnings = MapWarnings::logged);

/// A generated map (blank, dense, maze or room, so many cells) or, for the name of a file, what read_map
/// reads. Throws InputError for what is neither.
OccupancyMap read_or_generate_map(const std::string& kind_or_file, int width, int height, Random& random);

/// Writes a Moving AI `.map`; resolution, origin and the direction of y are not part of that format.
void write_map(const std::filesystem::path& path, const OccupancyMap& map);

/// Largest map that is read, cells a side; the bus carries no larger one.
inline constexpr int largest_map_file_side = 16384;

}  // namespace coppice
