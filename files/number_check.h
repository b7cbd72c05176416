// Validators for numbers on the command line. CLI11's own range check lets NaN pass.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include <CLI/CLI.hpp>

#include "planning/whole_number.h"

namespace coppice {

/// A whole number from `least` to `most`. CLI11's own conversion turns -1 into the largest unsigned number,
/// and reads 010 as 8.
template <class T>
CLI::Validator whole_number_between(T least, T most) {
  const std::string range = std::to_string(least) + " to " + std::to_string(most);
  return {[=](std::string& text) {
            const auto number = whole_number(text, least, most);
            if (!number) return text + " is not allowed, expected a whole number from " + range;
            text = std::to_string(*number);
            return std::string();
          },
          range};
}
/// The value of an option that sets a random seed: 0 to 2^32 - 1.
inline CLI::Validator a_seed() {
  return whole_number_between<std::uint32_t>(0, std::numeric_limits<std::uint32_t>::max());
}
/// A finite number from `least` to `most`. Any other text is a usage error that names the range.
CLI::Validator number_between(double least, double most);
/// A finite number above 0.
CLI::Validator number_above_zero();
/// A finite number of at least 0.
CLI::Validator number_not_negative();

}  // namespace coppice
