// Test of the resources of a fleet that is four times as large at the same density: `coppice bench scale`.
//
// CTest: PARALLEL
// CTest: TIMEOUT 1200

#include <filesystem>
#include <string>

#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include "tests/support.h"

namespace coppice {
namespace {

constexpr double most_megabytes = 40;
constexpr double most_growth = 1.3;  // of the samples that an agent hears

TEST(Scale, TheTrafficOfAnAgentFollowsTheDensityOfTheFleet) {
  if (!test::wants_long_tests()) GTEST_SKIP() << test::why_not_long;
  const test::TemporaryFolder folder;
  const std::filesystem::path report = folder.path() / "scale.json";
  const auto bench = test::shell("cd " + folder.path().string() + " && " + test::program("coppice") +
                                 " bench scale --robots 50,200 --report " + report.string());
  ASSERT_EQ(bench.exit_code, 0) << bench.output;
  google::protobuf::ListValue rows;
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(test::contents(report), &rows).ok());
  ASSERT_EQ(rows.values_size(), 2);
  for (const auto& row : rows.values()) {
    const auto& of = row.struct_value().fields();
    const double robots = of.at("robots").number_value();
    EXPECT_GT(of.at("matched s").number_value(), 0) << "some of " << robots << " have never found each other";
    EXPECT_EQ(of.at("paths").number_value(), robots);
    EXPECT_EQ(of.at("collisions").number_value(), 0) << robots;
    for (const char* role : {"MB agent", "MB broker", "MB service"})
      EXPECT_LE(of.at(role).number_value(), most_megabytes) << robots << ' ' << role;
  }
  const auto samples = [&](int row) {
    return rows.values(row).struct_value().fields().at("samples/agent/fleet s").number_value();
  };
  EXPECT_LE(samples(1), most_growth * samples(0));
}

}  // namespace
}  // namespace coppice
