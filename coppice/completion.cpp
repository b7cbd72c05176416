#include "coppice/completion.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace coppice {
namespace {

/// The completions at one position of the command line.
struct Offer {
  std::string words;  ///< separated by spaces
  std::string names;  ///< "file", "directory", or none
};

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

/// The alternatives that are literal words, not placeholders as HOST:PORT.
std::string words_of(std::string_view alternatives, char separator) {
  std::string words;
  for (std::string word : split(alternatives, separator)) {
    word.erase(0, word.find_first_not_of(' '));
    if (std::ranges::any_of(word, [](unsigned char c) { return std::isupper(c) != 0; })) continue;
    words += (words.empty() ? "" : " ") + word;
  }
  return words;
}

/// Help shows the type of a value as TEXT:{a,b}, TEXT:a|b|NAME, TEXT:FILE, TEXT:FOLDER, INT:INT in [1 - 9].
Offer value_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const auto holds = [&](const char* part) { return type.find(part) != std::string::npos; };
  if (const std::size_t open = type.find('{'); open != std::string::npos)
    return {words_of(std::string_view(type).substr(open + 1, type.find('}') - open - 1), ','), ""};
  if (holds("|"))
    return {words_of(std::string_view(type).substr(type.find(':') + 1), '|'), holds("|FILE") ? "file" : ""};
  if (holds("FOLDER") || holds("DIR")) return {"", "directory"};
  return {"", type.starts_with("TEXT") ? "file" : ""};
}

std::string names_of(const CLI::Option& option) {
  std::string names;
  for (const std::string& name : option.get_lnames()) names += " --" + name;
  for (const std::string& name : option.get_snames()) names += " -" + name;
  return names.substr(std::min<std::size_t>(1, names.size()));
}

/// A line of the script's `case`, for what follows `before` in a command.
std::string row(const std::string& command, const std::string& before, const Offer& offer) {
  return fmt::format("    '{} {}') words='{}' names={} ;;\n", command, before, offer.words, offer.names);
}

/// The rows of one command, or of a program without commands.
std::string rows(const CLI::App& app, const std::string& command) {
  std::string text;
  std::string options;
  Offer arguments;
  for (const CLI::App* subcommand : app.get_subcommands({}))
    arguments.words += (arguments.words.empty() ? "" : " ") + subcommand->get_name();
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional()) {
      const Offer value = value_of(*option);
      if (!value.words.empty()) arguments.words += (arguments.words.empty() ? "" : " ") + value.words;
      if (!value.names.empty()) arguments.names = value.names;
      continue;
    }
    options += (options.empty() ? "" : " ") + names_of(*option);
    if (option->get_items_expected_max() == 0) continue;
    for (const std::string& name : split(names_of(*option), ' '))
      text += row(command, name, value_of(*option));
  }
  return text + fmt::format(
                    "    '{} '*) words='{}' names={}\n"
                    "      if [[ $current == -* ]]; then words='{}' names=; fi ;;\n",
                    command, arguments.words, arguments.names, options);
}

// Bash splits --option=value into three words.
constexpr const char* script = R"(# Completion of {program} for bash, made from its options.
_{program}() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} command= words= names=
  if [[ $current == = ]]; then
    current=
  elif [[ $before == = ]]; then
    before=${{COMP_WORDS[COMP_CWORD - 2]}}
  fi
{command}  case "$command $before" in
{rows}  esac
  mapfile -t COMPREPLY < <(compgen ${{names:+-A "$names"}} -W "$words" -- "$current")
  if [[ -n $names ]]; then compopt -o filenames 2>/dev/null; fi
}}
complete -F _{program} {program}
)";

}  // namespace

std::string bash_completion(const CLI::App& program) {
  std::string all;
  for (const CLI::App* command : program.get_subcommands({})) all += rows(*command, command->get_name());
  const std::string find_command =
      all.empty() ? "" : "  if ((COMP_CWORD > 1)); then command=${COMP_WORDS[1]}; fi\n";
  all += rows(program, "");
  return fmt::format(script, fmt::arg("program", program.get_name()), fmt::arg("command", find_command),
                     fmt::arg("rows", all));
}

}  // namespace coppice
