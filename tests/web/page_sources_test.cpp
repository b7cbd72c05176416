// Tests of the page's sources, with the packages of `npm install` (monitor/web/README.md): their own tests,
// and that they make the committed bundle.
//
// CTest: TIMEOUT 900
// CTest: RESOURCE_LOCK browser_1

#include <cstdlib>

#include <gtest/gtest.h>

#include "tests/support.h"
#include "tests/web/packages.h"

namespace coppice {
namespace {

struct PageSources : testing::Test {
  void SetUp() override { ASSERT_EQ(test::missing_packages(sources), ""); }
  /// Runs a shell command in their folder.
  test::Outcome there(const std::string& command) const {
    return test::shell("cd '" + sources.string() + "' && " + command);
  }

  const std::filesystem::path sources = test::page_sources();
  test::TemporaryFolder folder;
};

TEST_F(PageSources, ThePageSourcesPassTheirTests) {
  const test::Outcome outcome = there("npm test");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
}

TEST_F(PageSources, ThePageSourcesMakeTheCommittedBundle) {
  const std::string made = (folder.path() / "dist").string();
  const test::Outcome outcome = there("npm run protocol && npx tsc && npx vite build --outDir '" + made +
                                      "' && diff -r dist '" + made + "'");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
}

/// Table cells, badges, ends of runs and far map origins, in Debian's chromium.
TEST_F(PageSources, ThePageIsClearAtFirstSight) {
  ASSERT_EQ(test::missing_for_browser(), "");
  const test::Outcome outcome =
      there("npm run protocol && node ../../tests/web/page/page.spec.mjs --at-first-sight 2>&1");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
}

/// Orders, pauses and stops, with a made-up fleet that takes them.
TEST_F(PageSources, ThePageControlsAFleet) {
  ASSERT_EQ(test::missing_for_browser(), "");
  const test::Outcome outcome = there("npm run protocol && node ../../tests/web/page/control.spec.mjs 2>&1");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
}

/// A monitor that hangs, silent robots, queues, other operators, a thousand orders, hasty fingers.
TEST_F(PageSources, ThePageServesOperatorsOnBadDays) {
  ASSERT_EQ(test::missing_for_browser(), "");
  const test::Outcome outcome =
      there("npm run protocol && node ../../tests/web/page/operating.spec.mjs 2>&1");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
}

/// By axe-core, and by an operator who uses only the keyboard.
TEST_F(PageSources, EverybodyCanUseThePage) {
  ASSERT_EQ(test::missing_for_browser(), "");
  const test::Outcome outcome =
      there("npm run protocol && node ../../tests/web/page/accessible.spec.mjs 2>&1");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
}

/// What only a mock can play: recordings, a monitor that ends, invalid bytes, 200 robots.
TEST_F(PageSources, ThePageWorksWithAMadeUpFleet) {
  if (!test::wants_long_tests()) GTEST_SKIP() << test::why_not_long;
  ASSERT_EQ(test::missing_for_browser(), "");
  setenv("COPPICE_PAGE_FPS", "1", 1);  // the drawing speed is measured elsewhere
  const test::Outcome outcome = there("npm run test:page");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
}

TEST(WebPackages, TheWebPackagesRunOnTheNodeJsOfDebian12) {
  ASSERT_EQ(test::missing_packages(test::web_tests()), "");
  const std::string ours = COPPICE_SOURCE_DIR;
  const test::Outcome outcome =
      test::shell("cd '" + ours +
                  "' && node tests/web/locked_engines.mjs tests/web/package-lock.json "
                  "monitor/web/package-lock.json");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
}

}  // namespace
}  // namespace coppice
