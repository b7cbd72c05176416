// Tests of the help texts. All programs and commands are visited, so that no option is missed.

#include <gtest/gtest.h>

#include "coppice/command_table.h"
#include "files/report_file.h"
#include "files/report_terms.h"
#include "report.pb.h"
#include "runtime/command_line.h"
#include "tests/source_files.h"
#include "tests/support.h"

namespace coppice {
namespace {

/// Calls `visit` for each command of each program with its full name.
void visit_commands(const std::function<void(const CLI::App&, const std::string&)>& visit) {
  visit_programs([&](const CLI::App& program) {
    visit(program, program.get_name());
    for (const CLI::App* command : program.get_subcommands({}))
      visit(*command, program.get_name() + " " + command->get_name());
  });
}

/// The text with single spaces instead of line breaks.
std::string unwrapped(const std::string& text) {
  std::istringstream words(text);
  std::string line;
  for (std::string word; words >> word;) line += word + ' ';
  return line;
}

TEST(Help, EveryOptionWithAValueShowsItsDefault) {
  int seen = 0;
  visit_commands([&](const CLI::App& command, const std::string& name) {
    const std::string help = unwrapped(command.help());
    for (const CLI::Option* option : command.get_options()) {
      if (option->get_items_expected_max() == 0) continue;
      ++seen;
      const bool is_told = option->get_required() || !option->get_default_str().empty();
      EXPECT_TRUE(is_told) << name << " " << option->get_name() << ": neither required nor has it a default";
      const std::string expected =
          option->get_required() ? "required]" : "default: " + unwrapped(option->get_default_str());
      const auto at = help.find(" " + option->get_name() + " ");
      ASSERT_NE(at, std::string::npos) << name << " " << option->get_name() << "\n" << help;
      EXPECT_NE(help.find(expected.substr(0, expected.size() - 1), at), std::string::npos)
          << name << " " << option->get_name() << ": " << expected;
    }
  });
  EXPECT_GT(seen, 100) << "the commands were not found";
}

TEST(Help, EveryOptionAndCommandIsDescribed) {
  visit_commands([&](const CLI::App& command, const std::string& name) {
    EXPECT_FALSE(command.get_description().empty()) << name;
    for (const CLI::Option* option : command.get_options())
      EXPECT_FALSE(option->get_description().empty()) << name << " " << option->get_name();
  });
}

TEST(Help, TheShownDefaultsAreTheUsedOnes) {
  visit_programs([&](const CLI::App& program) {
    if (program.get_name() != "coppice") return;
    const auto default_of = [&](const std::string& command, const std::string& option) {
      return program.get_subcommand(command)->get_option(option)->get_default_str();
    };
    EXPECT_EQ(default_of("run", "--timeout"), "3600");
    EXPECT_EQ(default_of("run", "--plan-budget"), "1");
    EXPECT_EQ(default_of("plan", "--plan-budget"), "until no shorter path turns up");
    EXPECT_EQ(default_of("monitor", "--address"), "127.0.0.1");
    EXPECT_EQ(default_of("simulate", "--loss"), "0");
    EXPECT_EQ(default_of("replay", "--domain"), "0");
  });
}

TEST(Help, EveryLineFitsATerminal) {
  visit_commands([&](const CLI::App& command, const std::string& name) {
    std::istringstream lines(command.help());
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100u) << name << ": " << line;
  });
}

TEST(Help, CommandsThatPrintTheTableExplainIt) {
  visit_programs([&](const CLI::App& program) {
    for (const char* name : {"run", "simulate", "plan"}) {
      const CLI::App* command = program.get_name() == "coppice"           ? program.get_subcommand(name)
                                : program.get_name() == "planner_service" ? &program
                                                                          : nullptr;
      if (command == nullptr) continue;
      for (const Term& term : table_terms())
        EXPECT_NE(command->help().find(term.name), std::string::npos) << name << ": " << term.name;
    }
  });
}

/// Collects the fields of a message and of the messages in it.
void collect_fields(const google::protobuf::Descriptor& message, const std::string& place,
                    std::set<std::string>& fields) {
  for (int k = 0; k < message.field_count(); ++k) {
    const auto& field = *message.field(k);
    fields.insert(place + field.name());
    if (field.message_type() != nullptr)
      collect_fields(*field.message_type(), place + field.name() + (field.is_repeated() ? "[]." : "."),
                     fields);
  }
}

TEST(ReportTerms, EveryFieldOfTheReportIsExplained) {
  std::set<std::string> fields;
  collect_fields(*proto::Report::descriptor(), "", fields);
  std::set<std::string> explained;
  for (const Term& term : report_terms()) explained.insert(std::string(term.name));
  EXPECT_EQ(explained, fields);
}

TEST(ReportTerms, TheDocumentationMatchesTheHelp) {
  const std::string page = test::contents(test::source_folder() / "docs/report.md");
  for (const auto terms : {table_terms(), report_terms()}) {
    for (const Term& term : terms) {
      const std::string row = "| `" + std::string(term.name) + "` | " + std::string(term.meaning) + " |";
      EXPECT_NE(page.find(row), std::string::npos) << row;
    }
  }
}

TEST(ReportTerms, EveryTermOfTheTableIsExplained) {
  proto::Report report;
  report.set_outcome("arrived");
  report.set_missions(3);
  report.set_robots_without_goal(1);
  report.set_periods_missed(0.5);
  report.add_robots()->set_name("r1");
  const std::string help = terms_of_table();
  for (const char* word :
       {"arrived", "missions fulfilled", "got no new goal", "plan time", "shorter paths after", "run time",
        "mean path length", "nodes", "published", "grafted", "collisions", "control periods missed",
        "least separation", "least clearance", "plan s", "run s", "path m", "driven m"}) {
    EXPECT_NE(report_table(report).find(word), std::string::npos) << word << "\n" << report_table(report);
    EXPECT_NE(help.find(word), std::string::npos) << word;
  }
}

}  // namespace
}  // namespace coppice
