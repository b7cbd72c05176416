// Common to the command lines of all programs: the form of the help, and one line for each mistake.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

namespace coppice {

/// Gives a program its name, --help and --version. Also makes the help show the defaults of all options that
/// are added later. Call it before options are added.
void set_up_command_line(CLI::App& app, const std::string& name, const std::string& description);

/// Parses the arguments. Returns the exit code if the program must end now: 0 after printing the help or the
/// version, 2 after reporting a mistake in one line.
std::optional<int> parse(CLI::App& app, int argc, const char* const* argv);

/// The name of an option's value in the help, as "FILE". Empty for a flag.
std::string value_name(const CLI::Option& option);
/// The allowed values, the related options and the default: "from 1 to 9; default: 3". Empty for a flag
/// without any such rule.
std::string rules_of(const CLI::Option& option);

/// Wraps the text of a help page. In a line with a tab, a name comes before the tab and its description after
/// it. They stand in two columns.
std::string help_text(const std::string& lines);

}  // namespace coppice
