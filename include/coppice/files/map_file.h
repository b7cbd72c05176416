// Map files: Moving AI `.map`, and ROS map_server YAML with a PGM or PNG picture.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "coppice/planning/occupancy_map.h"
#include "coppice/planning/random.h"

namespace coppice {

/// Whether doubtful settings of a readable map are logged: `left_out` where another process reads the same
/// map.
enum class MapWarnings : std::uint8_t { logged, left_out };

/// Reads a map file. Throws InputError, which names the file and the line or field.
///
/// `.map` (https://movingai.com/benchmarks/formats.html): `.`, `G`, `S` and `E` (a station of the League of
/// Robot Runners) are free, other characters are blocked; a cell is 1 m wide; y grows downwards. Characters
/// that the format does not have are logged.
///
/// `.yaml` or `.yml` (ROS map_server: resolution, origin, negate, thresholds): y grows upwards; cells that
/// are not known to be free are blocked.
OccupancyMap read_map(const std::filesystem::path& path, MapWarnings warnings = MapWarnings::logged);

/// Generates a map of `width` x `height` cells if the argument is a kind (blank, dense, maze or room);
/// otherwise reads the file of that name (read_map). Throws InputError if the argument is neither.
OccupancyMap read_or_generate_map(const std::string& kind_or_file, int width, int height, Random& random);

/// Writes a Moving AI `.map`. The format has no resolution, origin or direction of y.
void write_map(const std::filesystem::path& path, const OccupancyMap& map);

/// Largest map that is read, cells per side. The bus carries no larger map.
inline constexpr int largest_map_file_side = 16384;

/// Throws InputError, which names the member and what was expected, if the map is not as occupancy_map.h
/// says.
void check_map(const OccupancyMap& map);

}  // namespace coppice
