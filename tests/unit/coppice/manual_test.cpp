// Checks that manual pages and completion hold all that the programs parse.

#include <map>
#include <set>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "coppice/command_table.h"
#include "coppice/completion.h"
#include "coppice/manual_page.h"
#include "tests/support.h"

namespace coppice {
namespace {

/// What bash offers after the words, of which the last may be incomplete or empty.
std::set<std::string> offered(const std::string& program, const std::string& words) {
  const test::TemporaryFolder folder;
  visit_programs([&](const CLI::App& app) { folder.write(app.get_name(), bash_completion(app)); });
  const test::Outcome outcome =
      test::shell(fmt::format("cd '{0}' && exec bash -c '. ./{1} && COMP_WORDS=({1} {2}) && "
                              "COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)) && "
                              "_{1}; printf \"%s\\n\" \"${{COMPREPLY[@]}}\"'",
                              folder.path().string(), program, words));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  std::istringstream lines(outcome.output);
  std::set<std::string> all;
  for (std::string line; std::getline(lines, line);) all.insert(line);
  all.erase("");
  return all;
}

std::set<std::string> options_of(const CLI::App& app) {
  std::set<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.insert("--" + name);
  return names;
}

TEST(Completion, CompletionOffersEveryCommandAndEveryOption) {
  visit_programs([](const CLI::App& app) {
    const std::string& program = app.get_name();
    EXPECT_EQ(offered(program, "--"), options_of(app)) << program;
    std::set<std::string> commands;
    for (const CLI::App* command : app.get_subcommands({})) {
      commands.insert(command->get_name());
      EXPECT_EQ(offered(program, command->get_name() + " --"), options_of(*command)) << command->get_name();
    }
    if (!commands.empty()) {
      EXPECT_EQ(offered(program, "\"\""), commands);
    }
  });
}

TEST(Completion, CompletionOffersTheValuesOfAnOption) {
  const std::set<std::string> levels{"trace", "debug", "info", "warning", "error", "critical", "off"};
  EXPECT_EQ(offered("coppice", "run --log-level \"\""), levels);
  EXPECT_EQ(offered("robot_agent", "--log-level \"\""), levels);
  EXPECT_EQ(offered("coppice", "run --log-level = in"), (std::set<std::string>{"info"}));
  EXPECT_EQ(offered("coppice", "run --log-level ="), levels);
  EXPECT_EQ(offered("tree_broker", "--discovery s"), (std::set<std::string>{"static"}));
  EXPECT_EQ(offered("coppice", "bench p"), (std::set<std::string>{"paper", "peers"}));
  EXPECT_EQ(offered("coppice", "help r"),
            (std::set<std::string>{"record", "release", "replay", "report", "resume", "run"}));
  EXPECT_EQ(offered("coppice", "map maz"), (std::set<std::string>{"maze", "maze-traffic"}));
  EXPECT_EQ(offered("coppice", "bench peers --maps ma"), (std::set<std::string>{"maze"}));
  EXPECT_EQ(offered("coppice", "run --robots \"\""), std::set<std::string>()) << "a number";
  EXPECT_EQ(offered("coppice", "run robo"), (std::set<std::string>{"robot_agent"})) << "a file";
}

TEST(ManualPages, ThePagesHoldEveryOptionOfEveryCommand) {
  visit_programs([](const CLI::App& app) {
    std::map<std::string, std::string> pages;
    for (const ManualPage& page : manual_pages(app)) pages[page.name] = page.text;
    EXPECT_EQ(pages.size(), 1 + app.get_subcommands({}).size());
    for (const CLI::App* command : app.get_subcommands({})) {
      const std::string& text = pages[app.get_name() + "-" + command->get_name()];
      for (const CLI::Option* option : command->get_options()) {
        std::string described = option->get_description();
        for (std::size_t at = 0; (at = described.find('-', at)) != std::string::npos; at += 2)
          described.insert(at, "\\");
        EXPECT_NE(text.find(described), std::string::npos) << option->get_name();
      }
    }
  });
}

TEST(ManualPages, ThePagesAreReadWithoutAWarning) {
  const test::TemporaryFolder folder;
  visit_programs([&](const CLI::App& app) {
    for (const ManualPage& page : manual_pages(app)) {
      const std::string file = folder.write(page.name + ".1", page.text).string();
      const test::Outcome outcome = test::shell("{ groff -man -Tutf8 -ww '" + file + "' 2>&1 >/dev/null; }");
      EXPECT_EQ(outcome.exit_code, 0) << page.name;
      EXPECT_EQ(outcome.output, "") << page.name;
    }
  });
}

}  // namespace
}  // namespace coppice
