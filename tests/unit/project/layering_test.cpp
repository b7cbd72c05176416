// Checks that sources include only what their layer may include. The rules are the two tables below.

#include <algorithm>
#include <fstream>
#include <optional>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "tests/source_files.h"

namespace coppice {
namespace {

using namespace std::string_literals;

// An include is written as in the source, with its quotes or brackets. A pattern matches the whole include.
constexpr std::string_view standard = R"(<[a-z_0-9]+>)";
constexpr std::string_view proto = R"("[a-z_]+\.pb\.h")";

/// Private headers of these layers, and their public ones in include/coppice.
std::string from(std::string_view folders) {
  return "\"(coppice/)?(" + std::string(folders) + ")/.*\"";
}
/// Public headers of these layers.
std::string public_of(std::string_view folders) {
  return "\"coppice/(" + std::string(folders) + ")/.*\"";
}
std::string any(const std::vector<std::string>& patterns) {
  std::string joined;
  for (const std::string& pattern : patterns) joined += (joined.empty() ? "" : "|") + pattern;
  return joined;
}

struct MayInclude {
  std::string file;     ///< pattern; the first row that matches a file decides
  std::string include;  ///< all that such a file may include
};

const std::vector<MayInclude> layers = {
    {"include/coppice/planning/.*", any({public_of("planning"), "<Eigen/.*>", std::string(standard)})},
    {"include/coppice/motion/.*", any({public_of("planning|motion"), "<Eigen/.*>", std::string(standard)})},
    {"include/coppice/files/.*", any({public_of("planning|motion|files"), std::string(standard)})},
    {"include/coppice/simulation/.*",
     any({public_of("planning|motion|files|simulation"), std::string(standard)})},
    {"idl/.*", any({"<fastcdr/.*>", std::string(standard)})},
    {"planning/.*", any({from("planning"), "<Eigen/.*>", "<boost/polygon/.*>", std::string(standard)})},
    {"motion/.*", any({from("planning|motion"), "<Eigen/.*>", std::string(standard)})},
    {"files/.*", any({from("planning|motion|files"), std::string(proto), "<.*>"})},
    {"messages/.*", any({from("planning|motion|messages"), "<.*>"})},
    {"dds/.*", any({from("planning|motion|messages|dds"), R"("fleet[A-Za-z]*\.h")", "<.*>"})},
    {"ros2/.*", any({from("planning|motion|messages|dds|ros2"), R"("ros2[A-Za-z]*\.h")", "<.*>"})},
    {"runtime/.*", any({from("planning|motion|messages|dds|ros2|runtime"), "<.*>"})},
    {"tree_broker/.*", any({from("planning|motion|files|messages|dds|ros2|runtime|tree_broker"), "<.*>"})},
    {"robot_agent/.*", any({from("planning|motion|files|messages|dds|ros2|runtime|robot_agent"), "<.*>"})},
    {"planner_service/.*", any({from("planning|motion|files|messages|dds|ros2|runtime|planner_service"),
                                std::string(proto), "<.*>"})},
    {"simulation/.*", any({from("planning|motion|files|messages|dds|ros2|runtime|tree_broker|robot_agent|"
                                "planner_service|simulation"),
                           "<.*>"})},
    {"monitor/.*",
     any({from("planning|motion|files|messages|dds|ros2|runtime|monitor"), std::string(proto), "<.*>"})},
    {"coppice/.*", any({from("planning|motion|files|messages|dds|ros2|runtime|planner_service|simulation|"
                             "bench|monitor|coppice"),
                        R"("(tree_broker|robot_agent)/options\.h")", "<.*>"})},
    {"python/.*", any({public_of("planning|motion|files|simulation"), "<.*>"})},
    {"examples/.*", any({"<coppice/(planning|motion|files|simulation)/.*>", std::string(standard)})},
    {"(tests|bench)/.*", ".*"},
};

/// The rooms of each folder, lowest first, as patterns of files. The first pattern that matches a file is its
/// room. A file includes only files of its own room and of rooms before it.
const std::vector<std::vector<std::string>> rooms = {
    {"planning/[^/]*", "planning/geometry/.*", "planning/trees/.*"},
    {"motion/trajectory/.*", "motion/body/.*", "motion/lattice/.*", "motion/joint/.*"},
    {"robot_agent/(timing|limits)\\.h", "robot_agent/peers/.*", "robot_agent/agreement/.*",
     "robot_agent/control/.*", "robot_agent/options\\..*", "robot_agent/process/.*",
     "robot_agent/main\\.cpp"},
    {"planner_service/timing\\.h", "planner_service/orders/.*", "planner_service/report/.*",
     "planner_service/run/.*", "planner_service/[^/]*"},
    {"monitor/view/.*", "monitor/recording/.*", "monitor/foxglove/.*", "monitor/server/.*", "monitor/[^/]*"},
    {"coppice/run/diagnosis\\.h", "coppice/commands\\.h", "coppice/run/.*", "coppice/orders/.*",
     "coppice/watch/.*", "coppice/simulate/.*", "coppice/bench/.*", "coppice/[^/]*"},
};

struct Reserved {
  std::string include;  ///< pattern
  std::string file;     ///< pattern of the only files that may include it
  std::string reason;
};

const std::string tests_and_benches = "|(tests|bench)/.*";
const std::string mains =
    "|(tree_broker|robot_agent|planner_service)/(main\\.cpp|options\\.(h|cpp))|robot_agent/process/"
    "(ros_link|agent_loop|run_named|run_unnamed)\\.(h|cpp)|planner_service/run/service_loop\\.(h|cpp)";
const std::string commands = "|coppice/.*";

const std::vector<Reserved> reserved = {
    {"<(fastdds|fastrtps|fastcdr)/.*>|\"(fleet|ros2)[A-Za-z]*\\.h\"",
     "(dds|idl)/.*|ros2/dds_.*" + tests_and_benches, "DDS is known to the DDS bus alone"},
    {"\"(dds/.*|ros2/dds_.*|runtime/.*)\"",
     "(dds|runtime)/.*|ros2/dds_.*" + mains + commands + tests_and_benches,
     "only a main joins a role to the real bus"},
    {"<(thread|mutex|shared_mutex|condition_variable|future|semaphore|stop_token|chrono|ctime)>",
     "dds/.*|ros2/dds_.*|runtime/(process|disciplined_clock).*|monitor/server/web_shared\\.h|python/"
     "core\\.cpp" +
         commands + tests_and_benches,
     "time is passed in, and nothing below the mains waits"},
    {"<random>",
     "((tree_broker|planner_service)/main|robot_agent/process/run_unnamed|coppice/orders/order_id)\\.cpp" +
         tests_and_benches,
     "chance is passed in"},
    {"<(iostream|fstream|filesystem)>",
     "(include/coppice/)?files/.*|runtime/(journal|disk_file|process_clock|order_history|command_line).*|"
     "planner_service/run/fleet_memory.*" +
         mains + commands + tests_and_benches,
     "what reads or writes is at the edges"},
};

bool matches(std::string_view text, const std::string& pattern) {
  return std::regex_match(text.begin(), text.end(), std::regex(pattern));
}

/// The place of a file in `order`; its size if it is in none of these rooms.
std::size_t room_of(const std::string& file, const std::vector<std::string>& order) {
  return std::ranges::find_if(order, [&](const std::string& room) { return matches(file, room); }) -
         order.begin();
}

/// `include` is written as in the source.
bool points_up_within_its_folder(const std::string& file, const std::string& include) {
  const std::string included = include.substr(1, include.size() - 2);
  const std::string folder = file.substr(0, file.find('/') + 1);
  if (!included.starts_with(folder)) return false;
  const auto order =
      std::ranges::find_if(rooms, [&](const auto& row) { return row.back().starts_with(folder); });
  if (order == rooms.end()) return false;
  const std::size_t to = room_of(included, *order);
  return to < order->size() && to > room_of(file, *order);
}

/// Why `file` must not include `include`; nothing if it may.
std::optional<std::string> problem(const std::string& file, const std::string& include) {
  for (const Reserved& rule : reserved) {
    if (matches(include, rule.include) && !matches(file, rule.file)) return rule.reason;
  }
  if (points_up_within_its_folder(file, include)) return "includes point down within a folder, too"s;
  for (const MayInclude& rule : layers) {
    if (!matches(file, rule.file)) continue;
    return matches(include, rule.include) ? std::nullopt : std::optional("includes point down only"s);
  }
  return "a folder that the table of layers does not know";
}

std::vector<std::string> includes_of(const std::filesystem::path& path) {
  static const std::regex directive(R"(\s*#\s*include\s*((<|")[^>"]+(>|")).*)");
  std::vector<std::string> includes;
  std::ifstream in(path);
  std::smatch match;
  for (std::string line; std::getline(in, line);) {
    if (std::regex_match(line, match, directive)) includes.push_back(match[1]);
  }
  return includes;
}

TEST(Layering, EveryIncludePointsDown) {
  std::size_t seen = 0;
  for (const std::string& file : test::source_files()) {
    for (const std::string& include : includes_of(test::source_folder() / file)) {
      ++seen;
      if (const auto wrong = problem(file, include))
        ADD_FAILURE() << file << ": " << include << ": " << *wrong;
    }
  }
  EXPECT_GT(seen, 200u) << "the sources were not found";
}

TEST(Layering, WrongIncludesAreFound) {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"planning/trees/trees.h", "\"motion/body/driver.h\""},
      {"planning/trees/trees.h", "\"coppice/motion/kinematics.h\""},
      {"planning/trees/trees.h", "\"coppice/command_table.h\""},
      {"include/coppice/planning/plan_paths.h", "\"planning/trees/trees.h\""},
      {"include/coppice/planning/plan_paths.h", "\"coppice/motion/kinematics.h\""},
      {"include/coppice/files/map_file.h", "<yaml-cpp/yaml.h>"},
      {"include/coppice/simulation/faults.h", "\"simulation/fleet_simulation.h\""},
      {"planning/trees/trees.h", "<thread>"},
      {"planning/trees/trees.h", "<chrono>"},
      {"planning/trees/trees.h", "<spdlog/spdlog.h>"},
      {"planning/trees.cpp", "<fstream>"},
      {"planning/trees/trees.h", "\"scenario.pb.h\""},
      {"motion/body/driver.h", "\"messages/messages.h\""},
      {"motion/body/driver.h", "<mutex>"},
      {"files/map_file.h", "\"messages/messages.h\""},
      {"messages/messages.h", "\"coppice/files/scenario.h\""},
      {"messages/bus.h", "\"fleet.h\""},
      {"ros2/conversion.h", "\"ros2.h\""},
      {"simulation/simulated_bus.h", "<fastdds/dds/topic/Topic.hpp>"},
      {"robot_agent/process/robot_agent.h", "\"tree_broker/tree_broker.h\""},
      {"robot_agent/process/robot_agent.h", "\"dds/dds_bus.h\""},
      {"robot_agent/process/robot_agent.cpp", "<chrono>"},
      {"planner_service/run/planner_service.cpp", "\"simulation/fleet_simulation.h\""},
      {"simulation/fleet_simulation.h", "\"coppice/commands.h\""},
      {"simulation/fleet_simulation.h", "\"dds/dds_bus.h\""},
      {"simulation/fleet_simulation.h", "<random>"},
      {"nowhere/file.h", "<vector>"},
      {"planning/geometry/space.h", "\"planning/trees/forest.h\""},
      {"robot_agent/peers/fleet.h", "\"robot_agent/agreement/reserver.h\""},
      {"robot_agent/timing.h", "\"robot_agent/peers/loss.h\""},
      {"monitor/view/fleet_view.h", "\"monitor/monitor.h\""},
  };
  for (const auto& [file, include] : wrong) EXPECT_TRUE(problem(file, include)) << file << ": " << include;
  EXPECT_FALSE(problem("robot_agent/main.cpp", "\"dds/dds_bus.h\""));
  EXPECT_FALSE(problem("motion/body/driver.h", "\"coppice/planning/geometry.h\""));
}

}  // namespace
}  // namespace coppice
