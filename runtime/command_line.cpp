#include "runtime/command_line.h"

#include <algorithm>
#include <cctype>
#include <iostream>
#include <memory>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "planning/nearest_name.h"

namespace coppice {

namespace {

constexpr std::size_t page_width = 100;  // characters
constexpr std::size_t name_column = 28;  // of what stands after the names of options and commands

/// A name, followed by its description: wrapped words that begin at `column`.
std::string in_columns(const std::string& name, const std::string& text, std::size_t column) {
  std::string page = name;
  std::size_t width = name.size();
  std::istringstream words(text);
  bool begins = true;
  for (std::string word; words >> word; begins = false) {
    const bool is_full = width + 1 + word.size() > page_width && !begins;
    if (is_full || (begins && column > 0 && width + 2 > column)) {
      page += '\n';
      width = 0;
    }
    const std::size_t gap = width < column ? column - width : (width > 0 ? 1 : 0);
    page += std::string(gap, ' ') + word;
    width += gap + word.size();
  }
  return page + '\n';
}

bool takes_value(const CLI::Option& option) {
  return option.get_items_expected_max() > 0;
}

/// CLI11 keeps the kind of value and the names of all checks in one text, with a colon after the first.
struct Kind {
  std::string type;
  std::string checks;
  bool are_named_by_checks;  ///< as FILE and FOLDER are
};
Kind kind_of(const CLI::Option& option) {
  const std::string text = option.get_type_name();
  const auto colon = std::min(text.find(':'), text.size());
  Kind kind{text.substr(0, colon), text.substr(std::min(colon + 1, text.size())), false};
  const auto is_capital = [](unsigned char c) { return std::isupper(c) != 0 || c == '|' || c == ':'; };
  kind.are_named_by_checks = !kind.checks.empty() && std::ranges::all_of(kind.checks, is_capital);
  return kind;
}

/// "needs --ros", "not with --movie", of all options in a set.
std::string together_with(const std::string& how, const std::set<CLI::Option*>& options) {
  std::vector<std::string> names;
  for (const CLI::Option* option : options) names.push_back(option->get_name());
  std::ranges::sort(names);  // not as they lie in memory
  return fmt::format("{} {}", how, fmt::join(names, " and "));
}

class HelpFormat final : public CLI::Formatter {
 public:
  std::string make_usage(const CLI::App* app, std::string name) const override {
    return CLI::Formatter::make_usage(app, name) + '\n';
  }
  std::string make_positionals(const CLI::App* app) const override {
    const std::string group = CLI::Formatter::make_positionals(app);
    return group.empty() ? group : group + '\n';
  }
  /// Without the empty line above: CLI11 adds another one below.
  std::string make_group(std::string group, bool is_positional,
                         std::vector<const CLI::Option*> options) const override {
    return CLI::Formatter::make_group(group, is_positional, options).substr(1);
  }
  std::string make_description(const CLI::App* app) const override {
    return help_text(app->get_description());
  }
  std::string make_footer(const CLI::App* app) const override { return help_text(app->get_footer()); }
  std::string make_subcommand(const CLI::App* command) const override {
    return in_columns("  " + command->get_name(), command->get_description(), name_column);
  }
  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    const std::string value = is_positional ? std::string() : value_name(*option);
    const std::string rules = rules_of(*option);
    return in_columns(
        "  " + option->get_name(is_positional, !is_positional) + (value.empty() ? "" : " " + value),
        option->get_description() + (rules.empty() ? "" : " [" + rules + "]"), name_column);
  }
};

const CLI::App& chosen_command(const CLI::App& app) {
  const auto commands = app.get_subcommands();
  return commands.empty() ? app : *commands.front();
}

std::string full_name(const CLI::App& app, const CLI::App& command) {
  return &app == &command ? app.get_name() : app.get_name() + " " + command.get_name();
}

std::vector<std::string> names_of_options(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

std::vector<std::string> names_of_commands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::string did_you_mean(const std::string& nearest) {
  return nearest.empty() ? "" : fmt::format(", did you mean {}?", nearest);
}

/// Describes the first argument that the program does not know; empty if it knows all.
std::string unknown_argument(const CLI::App& app) {
  const CLI::App& command = chosen_command(app);
  const auto is_option = [](const std::string& text) { return text.size() > 1 && text.starts_with('-'); };
  const auto name_of = [](const std::string& text) { return text.substr(0, text.find('=')); };
  const std::vector<std::string> before = &command == &app ? std::vector<std::string>() : app.remaining();
  const std::vector<std::string> options = names_of_options(command);
  for (const std::string& text : before) {
    if (is_option(text) && std::ranges::count(options, name_of(text)) > 0)
      return fmt::format("{}: goes after the command, as in {} {}", text, full_name(app, command), text);
  }
  std::vector<std::string> rest = before.empty() ? command.remaining() : before;
  const auto end_of_options = std::ranges::find(rest, "--");  // no option comes after it
  const auto option = std::find_if(rest.begin(), end_of_options, is_option);
  if (option != end_of_options)
    return fmt::format(
        "{}: unknown option{}", *option,
        did_you_mean(nearest_name(name_of(*option), names_of_options(before.empty() ? command : app))));
  if (end_of_options != rest.end()) rest.erase(end_of_options);
  if (rest.empty()) return {};
  const bool is_command = !before.empty() || !app.get_subcommands({}).empty();
  if (is_command && &command == &app) {
    const std::vector<std::string> commands = names_of_commands(app);
    const std::string nearest = nearest_name(rest[0], commands);
    return fmt::format("{}: unknown subcommand{}", rest[0],
                       nearest.empty() ? fmt::format(", expected one of {}", fmt::join(commands, ", "))
                                       : did_you_mean(nearest));
  }
  const bool lacks_dashes = std::ranges::count(options, "--" + rest[0]) > 0;
  return fmt::format("{}: one argument too many{}", rest[0],
                     did_you_mean(lacks_dashes ? "--" + rest[0] : ""));
}

/// Describes the first option that lacks its value, or has one though it takes none; empty if there is none.
/// An option lacks its value if nothing, or another option, stands where the value is to be.
std::string missing_value(const CLI::App& command, const std::vector<std::string>& arguments) {
  const auto option_named = [&](const std::string& name) {
    return name.starts_with("--") && name.size() > 2 ? command.get_option_no_throw(name) : nullptr;
  };
  for (std::size_t i = 0; i < arguments.size() && arguments[i] != "--"; ++i) {
    const auto equals = arguments[i].find('=');
    const std::string name = arguments[i].substr(0, equals);
    const CLI::Option* option = option_named(name);
    if (option == nullptr) continue;
    const bool has_equals = equals != std::string::npos;
    if (!takes_value(*option)) {
      if (has_equals) return fmt::format("{}: takes no value", name);
      continue;
    }
    const bool is_last = i + 1 == arguments.size();
    const bool lacks_value =
        has_equals ? equals + 1 == arguments[i].size() : is_last || option_named(arguments[i + 1]) != nullptr;
    if (!lacks_value) continue;
    const std::string rules = rules_of(*option);
    return fmt::format("{}: expected a value, {}{}", name, value_name(*option),
                       rules.empty() ? "" : " [" + rules + "]");
  }
  return {};
}

/// An option that was given more often than it may be; empty if there is none.
std::string repeated_option(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    if (takes_value(*option) && std::cmp_greater(option->count(), option->get_items_expected_max()))
      return fmt::format("{}: given {} times, expected once", option->get_name(), option->count());
  }
  return {};
}

/// An argument, or a command, that is missing; empty if there is none.
std::string missing_argument(const CLI::App& app) {
  const CLI::App& command = chosen_command(app);
  if (&command == &app && app.get_require_subcommand_min() > 0)
    return fmt::format("expected a subcommand: {}", fmt::join(names_of_commands(app), ", "));
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_required() && option->count() == 0)
      return fmt::format("{} is missing, expected {}", option->get_name(), option->get_description());
  }
  return {};
}

/// Describes the mistake in one line, even if the arguments contain line breaks.
std::string mistake_in_words(const CLI::App& app, const std::vector<std::string>& arguments,
                             const CLI::ParseError& problem) {
  const CLI::App& command = chosen_command(app);
  std::string text = missing_value(command, arguments);
  if (text.empty()) text = unknown_argument(app);
  if (text.empty()) text = repeated_option(command);
  if (text.empty() && dynamic_cast<const CLI::RequiredError*>(&problem) != nullptr)
    text = missing_argument(app);
  if (text.empty()) text = problem.what();
  std::ranges::replace(text, '\n', ' ');
  return fmt::format("{} ({} --help)", text, full_name(app, command));
}

}  // namespace

std::string value_name(const CLI::Option& option) {
  if (!takes_value(option)) return {};
  const Kind kind = kind_of(option);
  if (kind.are_named_by_checks) return kind.checks;
  if (kind.type == "INT" || kind.type == "UINT") return "N";
  return kind.type == "FLOAT" ? "NUMBER" : kind.type;
}

std::string rules_of(const CLI::Option& option) {
  std::vector<std::string> rules;
  const Kind kind = kind_of(option);
  if (!kind.checks.empty() && !kind.are_named_by_checks) rules.push_back(kind.checks);
  if (!option.get_needs().empty()) rules.push_back(together_with("needs", option.get_needs()));
  if (!option.get_excludes().empty()) rules.push_back(together_with("not with", option.get_excludes()));
  if (option.get_required()) {
    rules.emplace_back("required");
  } else if (takes_value(option) && !option.get_default_str().empty()) {
    rules.push_back("default: " + option.get_default_str());
  }
  return fmt::format("{}", fmt::join(rules, "; "));
}

std::string help_text(const std::string& lines) {
  std::string page;
  std::istringstream rest(lines);
  for (std::string line; std::getline(rest, line);) {
    const auto tab = line.find('\t');
    page += tab == std::string::npos
                ? in_columns("", line, 0)
                : in_columns("  " + line.substr(0, tab), line.substr(tab + 1), name_column);
  }
  return page;
}

void set_up_command_line(CLI::App& app, const std::string& name, const std::string& description) {
  app.name(name);
  app.description(description);
  app.formatter(std::make_shared<HelpFormat>());
  app.set_help_flag("-h,--help", "prints this and ends");
  app.set_version_flag("--version", COPPICE_VERSION, "prints the version and ends");
  app.option_defaults()->always_capture_default();
}

std::optional<int> parse(CLI::App& app, int argc, const char* const* argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  try {
    app.parse(argc, argv);
    const std::string problem = missing_value(chosen_command(app), arguments);
    if (!problem.empty()) throw CLI::ArgumentMismatch(problem);
    return std::nullopt;
  } catch (const CLI::Success& wish) {
    app.exit(wish);
    return 0;
  } catch (const CLI::ParseError& problem) {
    std::cerr << mistake_in_words(app, arguments, problem) << '\n';
    return 2;
  }
}

}  // namespace coppice
