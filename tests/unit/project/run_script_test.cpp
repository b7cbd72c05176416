// Tests of tests/run with stand-ins for all that it starts: no test may be left out silently.

#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support.h"

namespace coppice {
namespace {

struct RunScript : testing::Test {
  void SetUp() override {
    for (const char* part : {"tests", "deploy", "programs", "build/release/Testing/Temporary"})
      std::filesystem::create_directories(folder.path() / part);
    std::filesystem::copy(std::filesystem::path(COPPICE_SOURCE_DIR) / "tests/run",
                          folder.path() / "tests/run");
    stand_in("deploy/install", "true");
    stand_in("programs/npm", "true");
    stand_in("programs/cmake", "true");
    stand_in("programs/ctest", "case \"$*\" in *-N*) echo 'Total Tests: 14';; esac");
  }
  /// A script that logs its arguments.
  void stand_in(const std::string& name, const std::string& script) const {
    const auto file = folder.write(name, fmt::format("#!/bin/sh\necho \"$(basename $0) $*\" >>'{}'\n{}\n",
                                                     (folder.path() / "calls").string(), script));
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  }
  test::Outcome run(const std::string& arguments = "") const {
    return test::shell(
        fmt::format("PATH='{0}/programs':$PATH '{0}/tests/run' {1}", folder.path().string(), arguments));
  }
  std::string calls() const { return test::contents(folder.path() / "calls"); }

  test::TemporaryFolder folder;
};

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_F(RunScript, TheScriptRunsEveryTestByDefault) {
  const test::Outcome outcome = run();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_TRUE(holds(calls(), "install --tests\n")) << calls();
  EXPECT_TRUE(holds(calls(), "npm ci --ignore-scripts --prefix tests/web ")) << calls();
  EXPECT_TRUE(holds(calls(), "npm install --no-save --prefix monitor/web ")) << calls();
  EXPECT_FALSE(holds(calls(), "-LE web")) << calls();
}

TEST_F(RunScript, TheScriptFailsWithTheReasonIfNpmCannotInstall) {
  for (const char* folder_of_packages : {"tests/web", "monitor/web"}) {
    stand_in("programs/npm",
             fmt::format("case \"$*\" in *{}*) echo 'the registry is away' >&2; exit 1;; esac",
                         folder_of_packages));
    const test::Outcome outcome = run();
    EXPECT_EQ(outcome.exit_code, 1) << folder_of_packages;
    EXPECT_TRUE(holds(outcome.output, "the registry is away")) << outcome.output;
    EXPECT_TRUE(holds(outcome.output, folder_of_packages)) << outcome.output;
    EXPECT_FALSE(holds(calls(), "ctest")) << calls();
  }
}

TEST_F(RunScript, TheScriptFailsIfASystemPackageCannotBeInstalled) {
  stand_in("deploy/install", "echo 'no such package' >&2; exit 100");
  const test::Outcome outcome = run();
  EXPECT_EQ(outcome.exit_code, 100);
  EXPECT_TRUE(holds(outcome.output, "no such package")) << outcome.output;
  EXPECT_FALSE(holds(calls(), "ctest")) << calls();
}

TEST_F(RunScript, TheScriptLeavesWebTestsOutOnlyOnDemandAndSaysHowMany) {
  stand_in("programs/npm", "exit 1");
  const test::Outcome outcome = run("--without-web -L unit");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_TRUE(outcome.output.ends_with("left out by --without-web: 14\n")) << outcome.output;
  EXPECT_TRUE(holds(calls(), "install --tests --without-web\n")) << calls();
  EXPECT_TRUE(holds(calls(), "-L unit -LE web\n")) << calls();
}

TEST_F(RunScript, TheScriptSaysHowManyTestsWereSkippedAndWhy) {
  folder.write("build/release/Testing/Temporary/LastTest.log",
               "a_test.cpp:18: Skipped\ntakes long\n\n[  SKIPPED ] A.B (0 ms)\n"
               "a_test.cpp:25: Skipped\nno network\n\nb_test.cpp:9: Skipped\ntakes long\n");
  const test::Outcome outcome = run();
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_TRUE(holds(outcome.output, "2 takes long\n")) << outcome.output;
  EXPECT_TRUE(holds(outcome.output, "1 no network\n")) << outcome.output;
}

TEST_F(RunScript, TheScriptFailsIfTheTestsFail) {
  stand_in("programs/ctest", "exit 8");
  EXPECT_EQ(run().exit_code, 8);
  EXPECT_EQ(run("--without-web").exit_code, 8);
}

}  // namespace
}  // namespace coppice
