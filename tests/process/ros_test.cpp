// Tests of a fleet as ROS 2 programs see it. tests/network/ros2_peer knows only ROS 2 types, and uses another
// vendor's DDS.
//
// CTest: RESOURCE_LOCK hosts

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <memory>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "files/report_file.h"
#include "tests/domains.h"
#include "tests/processes.h"
#include "tests/support.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;

const std::string peer = std::string(COPPICE_TEST_BIN_DIR) + "/ros2_peer";

/// Two rooms with a door 8 m wide; y points down.
std::string two_rooms() {
  std::string map = "type octile\nheight 30\nwidth 40\nmap\n";
  for (int j = 0; j < 30; ++j) {
    for (int i = 0; i < 40; ++i) {
      const bool wall = (i == 19 || i == 20) && (j < 11 || j > 18);
      map += wall || (i == 0 && j == 0) ? '@' : '.';
    }
    map += '\n';
  }
  return map;
}

struct Robot {
  std::string name;
  int x, y, goal_x, goal_y;
};

struct FleetInRos {
  FleetInRos(const std::vector<Robot>& robots, const std::vector<std::string>& options,
             const char* how = "run") {
    folder.write("rooms.map", two_rooms());
    std::string rows;
    for (const Robot& r : robots) {
      rows += (rows.empty() ? "" : ",") + ("{\"name\":\"" + r.name) +
              "\",\"start\":{\"x\":" + std::to_string(r.x) + ",\"y\":" + std::to_string(r.y) +
              "},\"goal\":{\"x\":" + std::to_string(r.goal_x) + ",\"y\":" + std::to_string(r.goal_y) + "}}";
    }
    const auto scenario =
        folder.write("s.json", R"({"map":"rooms.map","radius":0.5,"max_speed":2,"robots":[)" + rows + "]}");
    std::vector<std::string> command{test::program("coppice"),
                                     how,
                                     scenario.string(),
                                     "--domain",
                                     domain,
                                     "--time-scale",
                                     "1",
                                     "--report",
                                     file("report.json").string(),
                                     "--ros"};
    command.insert(command.end(), options.begin(), options.end());
    run = std::make_unique<test::Background>(command, file("log"));
  }
  std::filesystem::path file(const std::string& name) const { return folder.path() / name; }
  std::string log() const { return test::contents(file("log")); }
  proto::Report report() const { return read_report(file("report.json")); }

  test::TemporaryFolder folder;
  std::string domain = test::domain_name();
  std::unique_ptr<test::Background> run;
};

TEST(RosFleet, ARosProgramReadsTheRobotsPositionAndSendsAGoal) {
  FleetInRos fleet({{"r-1", 5, 10, 12, 10}, {"r2", 35, 20, 30, 20}}, {}, "serve");
  const auto ask = [&](const std::string& robot, const std::string& goal, const std::string& seconds) {
    return test::shell(peer + " " + fleet.domain + " " + robot + " goal " + goal + " " + seconds);
  };
  const test::Outcome seen = ask("r_1", "30 -8", "60");
  EXPECT_EQ(seen.exit_code, 0) << seen.output << fleet.log();
  // 40 x 30 cells. The blocked corner is the upper left one, which is not the first cell of the grid.
  EXPECT_NE(seen.output.find("map map 40x30 cells of 1.000 m from 0.000 -30.000, 45 occupied, corner 0\n"),
            std::string::npos)
      << seen.output;
  EXPECT_NE(seen.output.find("odom r_1/odom -> r_1/base_link at "), std::string::npos) << seen.output;
  EXPECT_NE(seen.output.find("plan map to 30.000 -8.000\n"), std::string::npos) << seen.output;
  EXPECT_NE(seen.output.find("tf map -> "), std::string::npos) << seen.output;

  EXPECT_EQ(ask("r2", "19.8 -2", "4").exit_code, 1);  // into the wall
  EXPECT_NE(fleet.log().find("refused a goal of r2: it is in an obstacle"), std::string::npos) << fleet.log();
  fleet.run->send(SIGINT);
  EXPECT_EQ(fleet.run->wait(), 0) << fleet.log();
  const proto::Report report = fleet.report();
  EXPECT_EQ(report.goals_refused(), 1u);
  EXPECT_EQ(report.collisions(), 0u);
  EXPECT_TRUE(report.robots(0).arrived());
  EXPECT_NEAR(report.robots(0).path().rbegin()->x(), 30, 1e-9);
  EXPECT_NEAR(report.robots(0).path().rbegin()->y(), 8, 1e-9);
}

struct Vertex {
  double time, x, y, speed;
  bool silent;
  double yaw;
};

std::vector<Vertex> way_of(const std::filesystem::path& log, bool with_yaw = false) {
  std::vector<Vertex> way;
  std::istringstream in(test::contents(log));
  for (Vertex p{}; in >> p.time >> p.x >> p.y >> p.speed >> p.silent && (!with_yaw || in >> p.yaw);)
    way.push_back(p);
  return way;
}

double least_distance(const std::vector<Vertex>& a, const std::vector<Vertex>& b) {
  double least = 1e9;
  for (const Vertex& p : a) {
    const auto q = std::ranges::lower_bound(b, p.time, {}, &Vertex::time);
    if (q != b.end() && q->time - p.time < 0.1) least = std::min(least, std::hypot(p.x - q->x, p.y - q->y));
  }
  return least;
}

TEST(RosFleet, ExternalRobotsArriveAndStopIfTheirOdometryStops) {
  const std::vector<Robot> robots{{"r1", 5, 10, 35, 11}, {"r2", 35, 15, 5, 16}, {"r3", 20, 15, 30, 25}};
  FleetInRos fleet(robots, {"--drive", "ros", "--timeout", "120"});
  std::vector<std::unique_ptr<test::Background>> players;
  for (const Robot& r : robots) {
    const std::string pause_at = r.name == "r1" ? "2" : "1000";  // seconds after it started, for 3 s
    const std::vector<std::string> command{
        peer,  fleet.domain, r.name,   "robot", std::to_string(r.x), std::to_string(-r.y),
        "0.2", "0.05",       pause_at, "3"};
    players.push_back(std::make_unique<test::Background>(command, fleet.file(r.name)));
  }
  EXPECT_EQ(fleet.run->wait(), 0) << fleet.log();
  players.clear();
  const proto::Report report = fleet.report();
  EXPECT_EQ(report.collisions(), 0u);
  EXPECT_EQ(report.outcome(), "arrived");

  // The true positions that the robots print have no noise.
  std::vector<std::vector<Vertex>> ways;
  for (const Robot& r : robots) ways.push_back(way_of(fleet.file(r.name)));
  for (std::size_t k = 0; k < ways.size(); ++k) {
    ASSERT_GT(ways[k].size(), 100u) << test::contents(fleet.file(robots[k].name));
    const Vertex& last = ways[k].back();
    EXPECT_LT(std::hypot(last.x - robots[k].goal_x, last.y + robots[k].goal_y), 1) << robots[k].name;
    for (std::size_t other = 0; other < k; ++other) {
      const double least = least_distance(ways[k], ways[other]);
      EXPECT_GT(least, 1.0) << robots[k].name << " " << robots[other].name;
      EXPECT_LT(least, 100);  // they were compared
    }
  }
  const auto fell_silent = std::ranges::find(ways[0], true, &Vertex::silent);
  ASSERT_NE(fell_silent, ways[0].end());
  EXPECT_GT(fell_silent->speed, 0.5);
  int stood = 0;
  for (const Vertex& p : ways[0]) {
    if (!p.silent || p.time < fell_silent->time + 2) continue;
    EXPECT_LT(p.speed, 0.02) << p.time - fell_silent->time;
    ++stood;
  }
  EXPECT_GT(stood, 10);
}

struct TurningRobot {
  std::string name;
  double x, y, yaw, goal_x, goal_y, goal_yaw;
};

/// A hall of 12 x 8 m at 5 cm with a block in the middle; y points up.
std::string hall(const test::TemporaryFolder& folder) {
  constexpr int width = 240;
  constexpr int height = 160;
  std::string pixels(width * height, static_cast<char>(254));
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const bool block = i >= 100 && i < 140 && j >= 65 && j < 95;
      if (block || i < 2 || j < 2 || i >= width - 2 || j >= height - 2) pixels[j * width + i] = 0;
    }
  }
  folder.write("hall.pgm", "P5\n240 160\n255\n" + pixels);
  return folder
      .write("hall.yaml",
             "image: hall.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\n"
             "free_thresh: 0.196\n")
      .string();
}

/// Robots of 0.22 m, two in each row, change sides. They lag, slip, and see themselves with noise; the first
/// one does not see itself for 2 s.
void drive_differential_robots(int rows, double far, const std::string& source,
                               const std::vector<std::string>& options) {
  const std::string domain = test::domain_name();
  test::TemporaryFolder folder;
  hall(folder);
  std::vector<TurningRobot> robots;
  for (int k = 0; k < rows; ++k) {
    const double y = 1.2 + 1.8 * k;
    robots.push_back({"r" + std::to_string(2 * k + 1), 1, y, 1.5 * k, far, 7.6 - y, 0.7 * k});
    robots.push_back({"r" + std::to_string(2 * k + 2), far, y + 0.3, -2.0 * k, 1, 7.3 - y, 3.0 - k});
  }
  std::string listed;
  for (const TurningRobot& r : robots)
    listed +=
        (listed.empty() ? "" : ",") +
        fmt::format(R"({{"name":"{}","start":{{"x":{},"y":{},"yaw":{}}},"goal":{{"x":{},"y":{},"yaw":{}}}}})",
                    r.name, r.x, r.y, r.yaw, r.goal_x, r.goal_y, r.goal_yaw);
  const auto scenario = folder.write(
      "s.json", R"({"map":"hall.yaml","radius":0.22,"max_speed":0.5,"max_acceleration":1,"goal_tolerance":0.1,
                    "kinematics":"differential","max_angular_speed":1.9,"max_angular_acceleration":4,
                    "robots":[)" +
                    listed + "]}");
  const auto report_file = (folder.path() / "report.json").string();
  std::vector<std::string> command{
      test::program("coppice"), "run", scenario.string(), "--domain",  domain,      "--ros", "--drive", "ros",
      "--time-scale",           "1",   "--report",        report_file, "--timeout", "150"};
  command.insert(command.end(), options.begin(), options.end());
  const auto log = folder.path() / "log";
  test::Background run(command, log);
  std::vector<std::unique_ptr<test::Background>> players;
  for (const TurningRobot& r : robots) {
    const std::vector<std::string> player{peer,
                                          domain,
                                          r.name,
                                          "differential",
                                          std::to_string(r.x),
                                          std::to_string(r.y),
                                          std::to_string(r.yaw),
                                          "0.15",
                                          "0.02",
                                          "0.05",
                                          r.name == "r1" ? "4" : "1000",
                                          "2",
                                          source};
    players.push_back(std::make_unique<test::Background>(player, folder.path() / r.name));
  }
  EXPECT_EQ(run.wait(), 0) << test::contents(log);
  for (auto& player : players) {
    player->send(SIGTERM);
    EXPECT_NE(player->wait(), 4) << "a robot was told to drive to the side";
  }
  const proto::Report report = read_report(report_file);
  EXPECT_EQ(report.outcome(), "arrived");
  EXPECT_EQ(report.collisions(), 0u);
  std::vector<std::vector<Vertex>> ways;
  for (const TurningRobot& r : robots) ways.push_back(way_of(folder.path() / r.name, true));
  for (std::size_t k = 0; k < ways.size(); ++k) {
    ASSERT_GT(ways[k].size(), 100u) << robots[k].name;
    const Vertex& last = ways[k].back();
    EXPECT_LT(std::hypot(last.x - robots[k].goal_x, last.y - robots[k].goal_y), 0.1) << robots[k].name;
    EXPECT_LT(std::abs(std::remainder(last.yaw - robots[k].goal_yaw, 2 * std::numbers::pi)), 0.1)
        << robots[k].name;
    for (std::size_t other = 0; other < k; ++other)
      EXPECT_GT(least_distance(ways[k], ways[other]), 0.44) << robots[k].name << " " << robots[other].name;
  }
}

TEST(RosFleet, DifferentialRobotsArriveWithTheirYaw) {
  drive_differential_robots(4, 11, "odom", {});
}

TEST(RosFleet, RobotsAreFoundByTransformsAndTakeStampedCommands) {
  drive_differential_robots(1, 4, "tf", {"--pose", "tf", "--stamped"});
}

TEST(RosFleet, OptionsThatExcludeEachOtherAreRefused) {
  const std::string run = test::program("coppice") + " run " + (test::scenarios() / "rooms-8.json").string();
  const auto refuses = [&](const std::string& options, const std::string& why) {
    const test::Outcome outcome = test::shell(run + " " + options);
    EXPECT_EQ(outcome.exit_code, 2) << options;
    EXPECT_NE(outcome.output.find(why), std::string::npos) << outcome.output;
  };
  refuses("--ros --security keys", "--ros goes without --security");
  refuses("--ros --discovery static", "--ros goes without --discovery static");
  refuses("--drive ros", "--drive requires --ros");
  refuses("--ros --drive ros --tracking-tolerance 0", "--tracking-tolerance");
  refuses("--ros --drive elsewhere", "--drive");
}

}  // namespace
}  // namespace coppice
