// Tests of what a fleet that takes orders has saved, as processes: a full disk, and damaged files.
//
// CTest: RESOURCE_LOCK lane_3

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/journal_format.h"
#include "tests/domains.h"
#include "tests/processes.h"
#include "tests/small_disk.h"
#include "tests/support.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;
using test::Background;
using test::Outcome;
using test::shell;

std::string hall() {
  std::string map = "type octile\nheight 20\nwidth 30\nmap\n";
  for (int j = 0; j < 20; ++j) map += std::string(30, '.') + '\n';
  return map;
}
constexpr const char* site = R"({"map": "hall.map", "radius": 0.5, "max_speed": 4, "robots": [
  {"name": "r1", "start": {"x": 3, "y": 3}}, {"name": "r2", "start": {"x": 3, "y": 8}}]})";

/// A place in the file, in a record that holds a part of a track.
std::size_t place_in_a_track(const std::string& journal) {
  const DiskFile file(journal);
  RecordReader reader(file);
  std::vector<std::size_t> places;
  for (std::size_t place = first_line_size; place < reader.file_size();) {
    const auto record = reader.at(place).value();
    const Recorded recorded = recorded_in(record);
    const auto* const message = std::get_if<Message>(&recorded);
    if (message != nullptr && std::holds_alternative<TrackMessage>(*message)) places.push_back(place + 40);
    place = RecordReader::end_of(place, record);
  }
  return places.at(places.size() / 2);
}

class SavedState : public testing::Test {
 protected:
  void SetUp() override {
    folder.write("hall.map", hall());
    folder.write("site.json", site);
  }
  void start() {
    fleet = std::make_unique<Background>(
        std::vector<std::string>{test::program("coppice"), "serve", file("site.json"), "--domain",
                                 test::domain_name(), "--state", file("state"), "--logs", file("logs")},
        file("log"));
  }
  std::string file(const std::string& name) const { return (folder.path() / name).string(); }
  Outcome order(const std::string& words) const {
    return shell(test::program("coppice") + " " + words + " --patience 40 --domain " + test::domain_name());
  }
  Outcome orders(const std::string& words = "") const {
    return shell(test::program("coppice") + " orders " + words + " --domain " + test::domain_name());
  }
  void kill_child(const std::string& name) const {
    for (const test::ProcessInfo& child : test::children_of(fleet->pid())) {
      if (child.name == name && child.state != 'Z') kill(child.pid, SIGKILL);
    }
  }
  /// Kills all processes of the fleet at once, as a failing host does.
  void fail_host() {
    const auto children = test::children_of(fleet->pid());
    fleet->send(SIGKILL);
    fleet->wait();
    EXPECT_TRUE(test::within(10s, [&] {
      return std::ranges::all_of(children, [](const auto& child) { return test::has_ended(child.pid); });
    }));
  }
  std::map<std::string, int> ends_in_history() const {
    std::map<std::string, int> ends;
    std::istringstream lines(test::contents(file("state/orders.jsonl")));
    for (std::string line; std::getline(lines, line);) {
      const std::string id = line.substr(7, line.find('"', 7) - 7);
      ends[id] += line.find("\"ended_at\":null") == std::string::npos;
    }
    return ends;
  }

  test::TemporaryFolder folder;
  std::unique_ptr<Background> fleet;
};

TEST_F(SavedState, OnAFullDiskNewOrdersAreRefusedAndTheFleetComesBackWhereItWas) {
  const test::SmallDisk disk(folder.path() / "state", "8M");
  if (!disk.is_there()) GTEST_SKIP() << test::why_no_disk;
  start();
  const Outcome first = order("send r1 --to 15,3 --wait");
  ASSERT_EQ(first.exit_code, 0) << first.output << test::contents(file("log"));
  disk.fill();
  const auto refused = [&] { return order("send r2 --to 3,15"); };
  Outcome said;
  EXPECT_TRUE(test::within(20s, [&] {
    said = refused();
    return said.exit_code == 1;
  }));
  EXPECT_NE(said.output.find("it cannot be saved: the disk of " + file("state") + " is full"),
            std::string::npos)
      << said.output;
  EXPECT_NE(orders().output.find("new orders are refused"), std::string::npos);
  EXPECT_EQ(order("pause r2 --wait").exit_code, 0) << "a fleet can be halted";
  for (const char* const killed : {"planner_service", "robot_agent"}) kill_child(killed);
  std::this_thread::sleep_for(3s);
  EXPECT_EQ(order("resume r2 --wait").exit_code, 0) << test::contents(file("log"));
  EXPECT_EQ(refused().exit_code, 1);
  fail_host();
  start();
  EXPECT_TRUE(
      test::within(40s, [&] { return refused().output.find("cannot be saved") != std::string::npos; }));
  disk.make_room();
  EXPECT_TRUE(test::within(20s, [&] { return refused().exit_code == 0; })) << "without a restart";
  const Outcome back = order("send r1 --to 15,5 --wait");
  EXPECT_EQ(back.exit_code, 0) << back.output << test::contents(file("log"));
  for (const auto& [id, ends] : ends_in_history()) EXPECT_LE(ends, 1) << id;
  fleet->send(SIGINT);
  EXPECT_EQ(fleet->wait(), 0) << test::contents(file("log"));
}

TEST_F(SavedState, AFlippedByteStopsTheStartUntilTheOperatorDiscardsIt) {
  start();
  for (const char* const place : {"15,3", "15,8", "10,3"}) {
    const Outcome sent = order(std::string("send r1 --to ") + place + " --wait");
    ASSERT_EQ(sent.exit_code, 0) << sent.output << test::contents(file("log"));
  }
  fail_host();
  const std::string journal = file("state/planner_service.journal");
  std::string bytes = test::contents(journal);
  bytes.at(place_in_a_track(journal)) ^= 4;
  std::ofstream(journal, std::ios::binary) << bytes;

  start();
  EXPECT_EQ(fleet->wait(), 2);
  const std::string log = test::contents(file("log"));
  EXPECT_NE(log.find(journal + ": is damaged at byte "), std::string::npos) << log;
  EXPECT_NE(log.find("coppice state " + file("state")), std::string::npos) << log;
  const std::string state = test::program("coppice") + " state " + file("state");
  const Outcome found = shell(state);
  EXPECT_EQ(found.exit_code, 1) << found.output;
  EXPECT_NE(found.output.find(journal + ": damaged"), std::string::npos) << found.output;
  const Outcome inspected = shell(test::program("coppice") + " inspect " + journal);
  EXPECT_EQ(inspected.exit_code, 1) << inspected.output;
  EXPECT_NE(inspected.output.find(R"("order_status":{"id":")"), std::string::npos) << inspected.output;
  EXPECT_NE(inspected.output.find("damaged from byte"), std::string::npos) << inspected.output;
  const Outcome repaired = shell(state + " --discard-damaged");
  EXPECT_EQ(repaired.exit_code, 0) << repaired.output;
  EXPECT_EQ(shell(state).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(journal + ".damaged"));

  start();
  const Outcome sent = order("send r2 --to 20,15 --wait");
  EXPECT_EQ(sent.exit_code, 0) << sent.output << test::contents(file("log"));
  for (const auto& [id, ends] : ends_in_history()) EXPECT_EQ(ends, 1) << id;
  EXPECT_EQ(ends_in_history().size(), 4u);
  fleet->send(SIGINT);
  EXPECT_EQ(fleet->wait(), 0) << test::contents(file("log"));
}

}  // namespace
}  // namespace coppice
