// What a number on the command line may be: CLI11's own range lets NaN pass.
#pragma once

#include <CLI/CLI.hpp>

namespace coppice {

/// A finite number from `least` to `most`; anything else is a usage error that says so.
CLI::Validator number_between(double least, double most);
/// A finite number above 0.
CLI::Validator number_above_zero();
/// A finite number of at least 0.
CLI::Validator number_not_negative();

}  // namespace coppice
