// Tests of two brokers over DDS. The leading one is killed, and later restarts with its journal.
//
// CTest: RUN_SERIAL

#include <chrono>
#include <csignal>
#include <map>
#include <memory>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "coppice/planning/map_generator.h"
#include "dds/dds_bus.h"
#include "tests/domains.h"
#include "tests/processes.h"
#include "tests/support.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;

struct Watch {
  void look() {
    bus.wait(0.02);
    for (const Arrival& arrival : bus.take()) {
      if (const auto* status = std::get_if<BrokerStatus>(arrival.message.get()))
        statuses[status->broker] = *status;
      if (const auto* tree = std::get_if<InactiveTreesMessage>(arrival.message.get())) trees.insert(tree->id);
    }
  }
  /// Brokers whose last status says that they lead.
  std::set<std::uint64_t> leaders() const {
    std::set<std::uint64_t> ids;
    for (const auto& [id, status] : statuses) {
      if (status.leads && id != gone) ids.insert(id);
    }
    return ids;
  }
  template <class Condition>
  bool sees(std::chrono::milliseconds time, Condition condition) {
    return test::within(time, [&] {
      look();
      return condition();
    });
  }
  DdsBus bus{{.domain = test::own_domain()}, Role::observer, "watch"};
  std::map<std::uint64_t, BrokerStatus> statuses{};
  std::set<TreesId> trees{};
  std::uint64_t gone = 0;  ///< the broker that was killed
};

struct BrokerTakeover : testing::Test {
  std::unique_ptr<test::Background> broker(const std::string& name) const {
    return std::make_unique<test::Background>(
        std::vector<std::string>{test::program("tree_broker"), "--domain", test::domain_name(), "--state",
                                 (folder.path() / name).string()},
        folder.path() / (name + ".log"));
  }
  test::TemporaryFolder folder;
};

TEST_F(BrokerTakeover, TheStandbyBrokerTakesOverWithinTwoSecondsWithAllTrees) {
  DdsBus service({.domain = test::own_domain()}, Role::service, "service");
  Random random(1);
  service.publish(MapMessage{"rooms", generate_map(MapKind::room, 300, 300, random), {5}});
  Watch watch;
  auto first = broker("first");
  ASSERT_TRUE(watch.sees(10s, [&] {
    return watch.statuses.size() == 1 && watch.statuses.begin()->second.covered_map == "rooms";
  }));
  const std::uint64_t leader = watch.statuses.begin()->first;
  const auto second = broker("second");
  ASSERT_TRUE(watch.sees(10s, [&] {
    const bool equal = watch.statuses.size() == 2 && watch.statuses.begin()->second.trees_published ==
                                                         watch.statuses.rbegin()->second.trees_published;
    return equal && watch.leaders() == std::set{leader};
  }));
  const std::set<TreesId> trees = watch.trees;
  ASSERT_FALSE(trees.empty());

  first->send(SIGKILL);
  first->wait();
  watch.gone = leader;
  EXPECT_TRUE(watch.sees(2s, [&] { return !watch.leaders().empty(); }));
  Watch late;
  EXPECT_TRUE(late.sees(5s, [&] { return std::ranges::includes(late.trees, trees); }))
      << late.trees.size() << " of " << trees.size();

  // The restarted broker stands by, because the other one leads.
  first = broker("first");
  EXPECT_TRUE(watch.sees(5s, [&] { return watch.statuses.size() == 3; }));
  watch.sees(2s, [] { return false; });
  EXPECT_EQ(watch.leaders().size(), 1u);
  EXPECT_TRUE(late.sees(2s, [&] { return late.leaders() == watch.leaders(); }));
}

TEST_F(BrokerTakeover, TwoBrokersDoNotShareAJournal) {
  const auto first = broker("shared");
  ASSERT_TRUE(test::within(5s, [&] { return std::filesystem::exists(folder.path() / "shared"); }));
  std::this_thread::sleep_for(500ms);
  const test::Outcome outcome =
      test::shell(test::program("tree_broker") + " --domain " + test::domain_name() + " --state " +
                  (folder.path() / "shared").string());
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.output.find("is in use by another process"), std::string::npos) << outcome.output;
}

TEST_F(BrokerTakeover, AFolderThatCannotBeWrittenIsReported) {
  folder.write("file", "");
  for (const std::string role : {"tree_broker", "robot_agent --name r1"}) {
    const test::Outcome outcome = test::shell(test::program(role) + " --domain " + test::domain_name() +
                                              " --state " + (folder.path() / "file").string());
    EXPECT_EQ(outcome.exit_code, 2) << role;
    EXPECT_NE(outcome.output.find("file: cannot be made"), std::string::npos) << outcome.output;
  }
}

}  // namespace
}  // namespace coppice
