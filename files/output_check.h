// Whether a file can be written that is to be written in the end: told before the work, not after it.
#pragma once

#include <CLI/CLI.hpp>

namespace coppice {

/// A file in a folder that may be written to; anything else is a usage error that says what is in the way.
CLI::Validator output_file();
/// The same, of a picture: its name ends in .svg, unless it is a device.
CLI::Validator picture_file();

}  // namespace coppice
