// Checks that each source is formatted as .clang-format says.

#include <string>

#include <gtest/gtest.h>

#include "tests/source_files.h"
#include "tests/support.h"

namespace coppice {
namespace {

TEST(Formatting, EverySourceIsFormatted) {
  std::string command = "cd '" + test::source_folder().string() + "' && clang-format --dry-run -Werror";
  for (const std::string& file : test::source_files()) command += " '" + file + "'";
  const test::Outcome outcome = test::shell(command);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output.substr(0, 4000);
}

}  // namespace
}  // namespace coppice
