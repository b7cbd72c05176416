// Tests of what a fleet keeps from run to run, as files.
#include "planner_service/run/fleet_memory.h"

#include <gtest/gtest.h>

#include "coppice/files/input_error.h"
#include "tests/support.h"
#include "tests/unit/planner_service/roles.h"

namespace coppice {
namespace {

FleetMemory some() {
  OrderStatus done{.order = {.id = "1",
                             .robots = {"a"},
                             .visits = {{.position = {1.1, 2}, .has_yaw = true, .yaw = 0.3, .wait = 5}},
                             .priority = -3,
                             .deadline = 1700000000.25,
                             .by = "ann \"of\" ü",
                             .replaces = true},
                   .state = OrderState::done,
                   .robot = "a",
                   .visited = 1,
                   .accepted_at = 1700000000.1,
                   .begun_at = 1700000001,
                   .ended_at = 1700000002.7};
  OrderStatus cancel{.order = {.id = "2", .action = Action::cancel, .cancels = "1"},
                     .state = OrderState::failed,
                     .reason = "order 1 is done already",
                     .accepted_at = 3,
                     .ended_at = 4};
  return {.halts = {.number = 1700000000123,
                    .everybody = Halt::stopped,
                    .robots = {{"b", Halt::paused_and_stopped}}},
          .orders = {done, cancel},
          .poses = {{"a", {20.125, 1.0 / 3}, 0}, {"b", {20, 20}, 0}}};
}

TEST(FleetMemory, WhatIsKeptIsReadAgain) {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(remembered_in(folder.path()).poses.empty()) << "a new fleet";
  const FleetMemory kept = some();
  remember(folder.path(), kept, two_robots());
  const FleetMemory read = remembered_in(folder.path());
  EXPECT_EQ(read.halts, kept.halts);
  EXPECT_EQ(read.orders, kept.orders);
  ASSERT_EQ(read.poses.size(), 2u);
  EXPECT_EQ(read.poses[0].position, kept.poses[0].position);
  EXPECT_EQ(read.poses[1].robot, "b");
}

TEST(FleetMemory, ADamagedFileIsNamed) {
  const test::TemporaryFolder folder;
  remember(folder.path(), some(), two_robots());
  for (const auto& [file, content, problem] : std::vector<std::array<std::string, 3>>{
           {"fleet.json", R"({"everybody": "sitting"})", "fleet.json: \"sitting\" is none of none, paused"},
           {"fleet.json", "{\n\"ev", "fleet.json:2"},
           {"poses.json", R"({"robots": [{"name": "a", "x": 1}]})", "poses.json: robots[0].y: is missing"}}) {
    const std::string before = test::contents(folder.path() / file);
    folder.write(file, content);
    try {
      remembered_in(folder.path());
      ADD_FAILURE() << content << " was read";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(problem), std::string::npos) << error.what();
    }
    folder.write(file, before);
  }
}

}  // namespace
}  // namespace coppice
