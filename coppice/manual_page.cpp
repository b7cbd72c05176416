#include "coppice/manual_page.h"

#include <fmt/format.h>

#include "runtime/command_line.h"

namespace coppice {
namespace {

/// Escapes text for groff: hyphens stay copyable, and no line is taken for a request.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool begins_a_line = out.empty() || out.back() == '\n';
    if (begins_a_line && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
  }
  return out;
}

std::string bold(const std::string& text) {
  return "\\fB" + escaped(text) + "\\fR";
}

std::string item(const CLI::Option& option) {
  const bool is_argument = option.get_positional();
  const std::string value = is_argument ? std::string() : value_name(option);
  const std::string rules = rules_of(option);
  return fmt::format(".TP\n{}{}\n{}{}\n", bold(option.get_name(is_argument, !is_argument)),
                     value.empty() ? "" : " " + escaped(value), escaped(option.get_description()),
                     rules.empty() ? "" : " [" + escaped(rules) + "]");
}

std::string section(const std::string& title, const std::string& text) {
  return text.empty() ? text : fmt::format(".SH {}\n{}", title, text);
}

std::string arguments(const CLI::App& app) {
  std::string text;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional()) text += item(*option);
  }
  return text;
}

std::string options(const CLI::App& app) {
  std::string text;
  for (const std::string& group : app.get_groups()) {
    std::string items;
    for (const CLI::Option* option : app.get_options()) {
      if (!option->get_positional() && option->get_group() == group) items += item(*option);
    }
    if (!group.empty() && !items.empty()) text += ".SS " + escaped(group) + "\n" + items;
  }
  return text;
}

std::string commands(const CLI::App& app) {
  std::string text;
  for (const CLI::App* command : app.get_subcommands({}))
    text +=
        fmt::format(".TP\n{}\n{}: see {}(1).\n", bold(command->get_name()),
                    escaped(command->get_description()), bold(app.get_name() + "-" + command->get_name()));
  return text;
}

/// Prints the lines without filling them.
std::string verbatim(const std::string& text) {
  return text.empty() ? text : fmt::format(".nf\n{}\n.fi\n", escaped(text));
}

std::string usage(const CLI::App& app, const std::string& called) {
  std::string line = " [OPTIONS]";
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional()) line += " " + option->get_name(true, false);
  }
  if (!app.get_subcommands({}).empty()) line += " COMMAND";
  return bold(called) + escaped(line) + "\n";
}

/// `called`: as it is typed. `parent`: the program's name, for a command.
ManualPage page_of(const CLI::App& app, const std::string& called, const std::string& parent) {
  ManualPage page{parent.empty() ? app.get_name() : parent + "-" + app.get_name(), {}};
  page.text = fmt::format(".TH {} 1 \"\" \"coppice {}\" Coppice\n", escaped(page.name), COPPICE_VERSION);
  page.text +=
      section("NAME", fmt::format("{} \\- {}\n", escaped(page.name), escaped(app.get_description())));
  page.text += section("SYNOPSIS", usage(app, called));
  page.text += section("COMMANDS", commands(app));
  page.text += section("ARGUMENTS", arguments(app));
  page.text += section("OPTIONS", options(app));
  page.text += section("NOTES", verbatim(help_text(app.get_footer())));
  if (!parent.empty()) page.text += section("SEE ALSO", bold(parent) + "(1)\n");
  return page;
}

}  // namespace

std::vector<ManualPage> manual_pages(const CLI::App& program) {
  const std::string& name = program.get_name();
  std::vector<ManualPage> pages{page_of(program, name, "")};
  for (const CLI::App* command : program.get_subcommands({}))
    pages.push_back(page_of(*command, name + " " + command->get_name(), name));
  return pages;
}

}  // namespace coppice
