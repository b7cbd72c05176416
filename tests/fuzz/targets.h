// The fuzz targets: every parser of files and of what arrives from the network. A target must end soon, with
// little memory, for any bytes. It reports bad input by an InputError, or drops it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace coppice::fuzz {

using Bytes = std::span<const std::uint8_t>;
using Input = std::vector<std::uint8_t>;

struct Target {
  std::string_view name;
  void (*run)(Bytes);
  std::vector<Input> (*seeds)();  ///< valid inputs to begin with
};

std::span<const Target> file_targets();
std::span<const Target> bus_targets();
std::span<const Target> client_targets();
inline std::array<std::span<const Target>, 3> all_targets() {
  return {file_targets(), bus_targets(), client_targets()};
}

/// Null if there is no target of that name.
const Target* find_target(std::string_view name);

}  // namespace coppice::fuzz
