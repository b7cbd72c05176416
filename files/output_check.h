// Checks before a run that its output files can be written at its end.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace coppice {

/// A file in a folder where files can be made. Any other value is a usage error that names the obstacle.
CLI::Validator output_file();
/// An output file for a picture: its name ends in .svg, unless it is a device.
CLI::Validator picture_file();
/// An existing folder where files can be made.
CLI::Validator output_folder();

/// Throws InputError if no file can be made in the folder.
void check_output_folder(const std::string& folder);

}  // namespace coppice
