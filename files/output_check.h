// Whether a file can be written that is to be written in the end: told before the work, not after it.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace coppice {

/// A file in a folder that may be written to; anything else is a usage error that says what is in the way.
CLI::Validator output_file();
/// The same, of a picture: its name ends in .svg, unless it is a device.
CLI::Validator picture_file();
/// The same, of a folder that is there.
CLI::Validator output_folder();

/// Throws InputError if no file can be made in the folder.
void check_output_folder(const std::string& folder);

}  // namespace coppice
