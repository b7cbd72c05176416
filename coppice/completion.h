// Completion for bash, from the options that a program parses.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace coppice {

/// A script that offers the program's commands, their options, and the values of these: words out of a set,
/// files, or folders.
std::string bash_completion(const CLI::App& program);

}  // namespace coppice
