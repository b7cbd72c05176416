// What is fuzzed: every parser of what comes from files and from the network. A target must come to its end
// with any bytes, soon and with little memory; what it finds bad it says by an InputError, or drops.
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
  std::vector<Input> (*seeds)();  ///< sound inputs to begin with
};

std::span<const Target> file_targets();
std::span<const Target> bus_targets();
std::span<const Target> client_targets();
inline std::array<std::span<const Target>, 3> all_targets() {
  return {file_targets(), bus_targets(), client_targets()};
}

/// Null if there is none of that name.
const Target* find_target(std::string_view name);

}  // namespace coppice::fuzz
