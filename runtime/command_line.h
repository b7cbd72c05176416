// What the command lines of all programs have in common: how help looks, and that a mistake is one line.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

namespace coppice {

/// Gives a program its name, --help and --version, and all options that are added to it later their defaults
/// in its help. Call it before options are added.
void set_up_command_line(CLI::App& app, const std::string& name, const std::string& description);

/// Parses the arguments. Returns the exit code if the program is to end now: 0 after help or the version,
/// which are printed; 2 after a mistake, which is told in one line.
std::optional<int> parse(CLI::App& app, int argc, const char* const* argv);

/// What stands for an option's value in help: "FILE". Empty for a flag.
std::string value_name(const CLI::Option& option);
/// What may be given, with which other options, and what holds without: "from 1 to 9; default: 3". Empty for
/// a flag that goes with everything.
std::string rules_of(const CLI::Option& option);

/// Text of help, wrapped. A line with a tab is a name, and what is said of it; these stand in two columns.
std::string help_text(const std::string& lines);

}  // namespace coppice
