#include "bench/reference_figures.h"

#include <string>

#include <gtest/gtest.h>

#include "coppice/files/input_error.h"
#include "tests/support.h"

namespace coppice {
namespace {

TEST(ReferenceFigures, AreReadAndMayBeUnknown) {
  test::TemporaryFolder folder;
  folder.write("figures.csv",
               "scenario,planner,sum,last,goals_per_second\r\nrooms-20,LaCAM3,357,,\ngrid,PIBT,,,2.5\n");
  const auto all = read_reference_figures(folder.path() / "figures.csv");
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].scenario, "rooms-20");
  EXPECT_EQ(all[0].planner, "LaCAM3");
  EXPECT_EQ(all[0].sum, 357);
  EXPECT_FALSE(all[0].last);
  EXPECT_EQ(all[1].goals_a_second, 2.5);
}

TEST(ReferenceFigures, TheErrorNamesTheLine) {
  test::TemporaryFolder folder;
  const std::string header = "scenario,planner,sum,last,goals_per_second\n";
  const std::pair<std::string, std::string> cases[] = {
      {"", "f.csv:1: holds no figures"},
      {"name,sum\n", "f.csv:1: expected the header"},
      {header, "f.csv:1: holds no figures"},
      {header + "a,b,1,2\n", "f.csv:2: has 4 columns, expected 5"},
      {header + "a,b,1,2,3\na,,1,2,3\n", "f.csv:3: names no scenario or no planner"},
      {header + "a,b,1x,2,3\n", "f.csv:2: \"1x\" is no figure"},
      {header + "a,b,-1,2,3\n", "f.csv:2: \"-1\" is no figure"},
      {header + "a,b,inf,2,3\n", "f.csv:2: \"inf\" is no figure"},
  };
  for (const auto& [text, expected] : cases) {
    folder.write("f.csv", text);
    try {
      read_reference_figures(folder.path() / "f.csv");
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(read_reference_figures(folder.path() / "none.csv"), InputError);
}

TEST(ReferenceFigures, TheCommittedFileIsValid) {
  EXPECT_GT(
      read_reference_figures(std::filesystem::path(COPPICE_SOURCE_DIR) / "bench/throughput_reference.csv")
          .size(),
      10u);
}

}  // namespace
}  // namespace coppice
