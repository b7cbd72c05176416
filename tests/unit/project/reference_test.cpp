// Test of the reference that Doxygen makes from the public headers.

#include <filesystem>

#include <gtest/gtest.h>

#include "tests/support.h"

namespace coppice {
namespace {

TEST(Reference, DoxygenMakesItWithoutWarnings) {
  const test::TemporaryFolder folder;
  const std::string out = folder.path().string();
  const test::Outcome outcome =
      test::shell("cd '" COPPICE_SOURCE_DIR "' && (cat docs/Doxyfile; echo 'OUTPUT_DIRECTORY = " + out +
                  "') | doxygen -");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_EQ(outcome.output, "");
  const std::string page = test::contents(folder.path() / "html/plan__paths_8h.html");
  EXPECT_NE(page.find("Plans a path for each robot of a fleet"), std::string::npos)
      << "the text at the top of a header is missing";
}

}  // namespace
}  // namespace coppice
