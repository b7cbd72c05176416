// Tests of reports in files.
#include "files/report_file.h"

#include <string>

#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include "tests/support.h"

namespace coppice {
namespace {

proto::Report report_of(int robots) {
  proto::Report report;
  report.set_outcome("arrived");
  report.set_map(R"(a map named "robots": [].map)");
  report.set_least_clearance(-0.25);
  for (int k = 0; k < robots; ++k) {
    proto::Report::Robot& robot = *report.add_robots();
    robot.set_name("r" + std::to_string(k));
    robot.set_reason("one line\nand another");
    for (int i = 0; i < k; ++i) robot.add_path()->set_x(i);
    if (k > 0) robot.mutable_load()->set_periods(7);
  }
  return report;
}

struct ReportFile : testing::Test {
  std::string written(const proto::Report& report) const {
    write_report(path, report);
    return test::contents(path);
  }

  test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "report.json";
};

TEST_F(ReportFile, AReportIsReadAsItWasWritten) {
  for (const int robots : {0, 1, 3}) {
    const proto::Report report = report_of(robots);
    written(report);
    EXPECT_EQ(read_report(path).SerializeAsString(), report.SerializeAsString()) << robots << " robots";
  }
}

TEST(ReportTable, ADistanceThatRoundsToZeroIsShownWithoutASign) {
  proto::Report report = report_of(1);
  report.set_least_separation(-3e-14);
  report.set_least_clearance(-0.25);
  EXPECT_NE(report_table(report).find("least separation 0.000 m, least clearance -0.250 m"),
            std::string::npos)
      << report_table(report);
}

TEST(ReportTable, TheTableWarnsIfAgentsGotTooLittleProcessorTime) {
  proto::Report report = report_of(2);
  report.set_periods_missed(0.004);
  EXPECT_EQ(report_table(report).find("control periods"), std::string::npos) << report_table(report);
  report.set_periods_missed(0.12);
  report.mutable_robots(1)->set_periods_missed(0.2);
  EXPECT_NE(report_table(report).find("control periods missed 12.0 % (of r1: 20.0 %): "), std::string::npos)
      << report_table(report);
}

TEST_F(ReportFile, ZerosAndEmptyListsAreWritten) {
  google::protobuf::Struct json;
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(written(report_of(2)), &json).ok());
  const auto& all = json.fields();
  EXPECT_EQ(all.at("collisions").number_value(), 0);
  EXPECT_FALSE(all.contains("least_separation")) << "the field has explicit presence";
  const auto& robots = all.at("robots").list_value().values();
  EXPECT_TRUE(robots[0].struct_value().fields().at("path").has_list_value());
  EXPECT_TRUE(robots[0].struct_value().fields().at("arrived").has_bool_value());
  const auto& first = robots[1].struct_value().fields().at("path").list_value().values(0);
  EXPECT_EQ(first.struct_value().fields().at("y").number_value(), 0);
}

}  // namespace
}  // namespace coppice
