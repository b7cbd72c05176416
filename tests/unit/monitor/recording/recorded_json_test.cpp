#include "monitor/recording/recorded_json.h"

#include <gtest/gtest.h>
#include <rapidjson/document.h>

namespace coppice {
namespace {

TEST(RecordedJson, AStateIsALineWithTheNamesOfItsFields) {
  RobotState state{.robot = "r1", .run = {}};
  state.promise.position = {1.5, 2};
  state.promise.expiry = 7.25;
  const std::string line = RecordedJson().line(state);
  EXPECT_EQ(line.find('\n'), std::string::npos);
  rapidjson::Document json;
  ASSERT_FALSE(json.Parse(line.c_str()).HasParseError()) << line;
  const auto& said = json["robot_state"];
  EXPECT_STREQ(said["robot"].GetString(), "r1");
  EXPECT_EQ(said["position"]["x"].GetDouble(), 1.5);
  EXPECT_EQ(said["promise_expiry"].GetDouble(), 7.25);
  EXPECT_STREQ(said["phase"].GetString(), "WAITING");
  EXPECT_EQ(said["reservation_progress"].GetDouble(), 0) << "fields that are 0 are in it, too";
}

TEST(RecordedJson, AnOrderIsWholeWhateverItsTextHolds) {
  OrderMessage order{.id = "a \"b\"\n\u00e9"};
  rapidjson::Document json;
  const std::string line = RecordedJson().line(order);
  ASSERT_FALSE(json.Parse(line.c_str()).HasParseError()) << line;
  EXPECT_EQ(json["order"]["id"].GetString(), order.id);
}

}  // namespace
}  // namespace coppice
