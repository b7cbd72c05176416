// Test of what `cmake --install` leaves below a prefix.
//
// CTest: PARALLEL

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/support.h"

namespace coppice {
namespace {

TEST(Installation, TheInstallationHoldsTheProgramsAndTheirFiles) {
  const test::TemporaryFolder folder;
  const std::filesystem::path prefix = folder.path() / "prefix";
  const std::filesystem::path build = std::filesystem::path(COPPICE_BIN_DIR).parent_path();
  const test::Outcome outcome =
      test::shell("cmake --install '" + build.string() + "' --strip --prefix '" + prefix.string() + "'");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  for (const char* file :
       {"share/coppice/scenarios/rooms-8.json", "share/coppice/scenarios/rooms-8.map",
        "share/coppice/security/make-keys", "share/man/man1/coppice.1.gz", "share/man/man1/coppice-run.1.gz",
        "share/man/man1/robot_agent.1.gz", "share/bash-completion/completions/coppice",
        "share/bash-completion/completions/robot_agent"})
    EXPECT_TRUE(std::filesystem::is_regular_file(prefix / file)) << file;
  for (const char* program : {"coppice", "tree_broker", "robot_agent", "planner_service"})
    EXPECT_EQ(test::shell("'" + (prefix / "bin" / program).string() + "' --version").exit_code, 0) << program;
  int units = 0;
  for (const auto& unit : std::filesystem::directory_iterator(prefix / "lib/systemd/system")) {
    const std::string text = test::contents(unit.path());
    EXPECT_NE(text.find("ExecStart=" + (prefix / "bin/").string()), std::string::npos) << text;
    EXPECT_EQ(text.find("/usr/local/bin"), std::string::npos) << text;
    ++units;
  }
  EXPECT_EQ(units, 5);
}

}  // namespace
}  // namespace coppice
