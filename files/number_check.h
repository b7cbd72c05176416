// What a number on the command line may be: CLI11's own range lets NaN pass.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include <CLI/CLI.hpp>

#include "planning/whole_number.h"

namespace coppice {

/// A whole number from `least` to `most`. CLI11 takes -1 for the largest number without a sign, and 010
/// for 8.
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
/// Of an option that sets a seed.
inline CLI::Validator a_seed() {
  return whole_number_between<std::uint32_t>(0, std::numeric_limits<std::uint32_t>::max());
}
/// A finite number from `least` to `most`; anything else is a usage error that says so.
CLI::Validator number_between(double least, double most);
/// A finite number above 0.
CLI::Validator number_above_zero();
/// A finite number of at least 0.
CLI::Validator number_not_negative();

}  // namespace coppice
