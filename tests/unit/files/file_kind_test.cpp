#include "files/file_kind.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

TEST(FileKind, AReportIsKnownByItsOutcome) {
  EXPECT_EQ(kind_of_file(R"({"outcome": "arrived", "map": "a.map", "robots": []})"), FileKind::report);
  EXPECT_EQ(kind_of_file(R"({ "map": "a.map", "robots": [{"name": "outcome", "start": {"x": 1}}]})"),
            FileKind::scenario)
      << "a robot may have this name";
}

TEST(FileKind, AMovingAiScenarioBeginsWithItsVersion) {
  EXPECT_EQ(kind_of_file("version 1\n0\ta.map"), FileKind::scen);
  EXPECT_EQ(kind_of_file("version\t1.0\n"), FileKind::scen);
  EXPECT_EQ(kind_of_file("version: 1\nimage: a.pgm\nresolution: 0.05\n"), FileKind::ros_map)
      << "YAML may have such a field";
}

TEST(FileKind, ARosMapMayBeWrittenAsFlow) {
  EXPECT_EQ(kind_of_file(R"({"image": "a.pgm", "resolution": 0.05, "map": "lobby"})"), FileKind::ros_map);
}

}  // namespace
}  // namespace coppice
