// Tests of the bus over real Fast DDS, within this process and to another vendor's DDS.
//
// CTest: RESOURCE_LOCK lane_1

#include "dds/dds_bus.h"

#include <algorithm>
#include <chrono>
#include <future>
#include <map>
#include <set>
#include <thread>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "dds/conversion.h"
#include "dds/discovery.h"
#include "dds/discovery_server.h"
#include "dds/transport.h"
#include "messages/topics.h"
#include "tests/domains.h"
#include "tests/network/samples.h"
#include "tests/processes.h"
#include "tests/support.h"

namespace coppice {
namespace {

namespace dds = eprosima::fastdds::dds;
using Clock = std::chrono::steady_clock;

TEST(DdsBus, EveryMessageArrivesAsItWasSent) {
  DdsBus service({.domain = test::own_domain()}, Role::service, "service");
  DdsBus agent({.domain = test::own_domain(), .robot = "r1"}, Role::agent, "agent");
  DdsBus broker({.domain = test::own_domain()}, Role::broker, "broker");
  DdsBus other({.domain = test::own_domain()}, Role::agent, "other");
  DdsBus claimant({.domain = test::own_domain()}, Role::claimant, "claimant");

  const Message map = some_map(100);
  const Message mission = some_mission();
  const Message nodes = RootNodes{"r1", 3, 7, {{Root::goal, {1, 2}, 5}, {Root::start, {3, 4}, -1}}, 1.7e9};
  const Message tree = some_tree(1, 9);
  const Message path = PathMessage{"r1", 3, {{0, 0}, {1, 2}, {5, 5}}, 1.7e9};
  const Message plan = JointPlanMessage{
      {4, "r1"},
      {{"r1", 5, false, {{1, {0, 0}}, {2, {1, 2}}}}, {"r2", 4.5, true}, {"r3", 5, false, {{3, {4, 5}}}}},
      {{"r4", 6, 0.25}},
      1.7e9};
  const Message track = TrackMessage{"r1", 3, 12, {{0.05, {1, 1}, {2, 0}}, {0.1, {1.1, 1}, {2, 0}}}, 1.7e9};
  const Message status = AgentStatus{"r1",
                                     3,
                                     Phase::no_path,
                                     "why not",
                                     1,
                                     2,
                                     3,
                                     4,
                                     5,
                                     6,
                                     7,
                                     8,
                                     9,
                                     10,
                                     11,
                                     12,
                                     {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11},
                                     1.7e9};
  const Message broker_status = BrokerStatus{1ull << 50, true, 1.5, 2, 3, 4, 5, "some-map", 6};
  const Message claim = Claim{1ull << 60, 3, "r4"};
  const Message assignment = Assignment{"r4", 1ull << 60, 2};
  service.publish(map);
  service.publish(mission);
  service.publish(assignment);
  claimant.publish(claim);
  for (const Message& m : {nodes, plan, path, track, status}) agent.publish(m);
  broker.publish(tree);
  broker.publish(broker_status);

  const auto at_agent = receive(other, [&](const auto& all) {
    return holds(all, map) && holds(all, mission) && holds(all, tree) && holds(all, plan);
  });
  EXPECT_TRUE(holds(at_agent, map) && holds(at_agent, mission) && holds(at_agent, tree) &&
              holds(at_agent, plan));
  const auto at_service = receive(service, [&](const auto& all) {
    return holds(all, path) && holds(all, track) && holds(all, status) && holds(all, broker_status) &&
           holds(all, nodes) && holds(all, claim);
  });
  EXPECT_TRUE(holds(at_service, claim));
  const auto at_claimant = receive(claimant, [&](const auto& all) { return holds(all, assignment); });
  EXPECT_TRUE(holds(at_claimant, assignment));
  EXPECT_TRUE(holds(at_service, path) && holds(at_service, track) && holds(at_service, status) &&
              holds(at_service, broker_status) && holds(at_service, nodes));
  const auto at_broker =
      receive(broker, [&](const auto& all) { return holds(all, nodes) && holds(all, mission); });
  EXPECT_TRUE(holds(at_broker, nodes) && holds(at_broker, mission));

  const Message state = some_state(1);
  std::vector<Message> states;
  for (int i = 0; i < 100 && !holds(states, state); ++i) {  // best effort: sent again until matched
    agent.publish(state);
    for (const Message& m : receive(
             other, [&](const auto& all) { return holds(all, state); }, 0.1))
      states.push_back(m);
  }
  EXPECT_TRUE(holds(states, state));
}

// Processes may live for months.
TEST(DdsBus, ALateJoinerGetsAllOfThisRunAndNothingOfTheLast) {
  DdsBus agent({.domain = test::own_domain(), .robot = "a"}, Role::agent, "agent");
  const auto track = [](std::uint32_t first, double run) {
    return Message(TrackMessage{"a", 1, first, {{first * 0.05, {1, 1}, {0, 0}}}, run});
  };
  for (std::uint32_t k = 0; k < 5; ++k) agent.publish(track(k, 100));
  for (std::uint32_t k = 0; k < 3; ++k) agent.publish(track(k, 200));
  DdsBus service({.domain = test::own_domain()}, Role::service, "service");
  const auto all = receive(service, [&](const auto& got) { return got.size() >= 3; });
  ASSERT_EQ(all.size(), 3u);
  for (std::uint32_t k = 0; k < 3; ++k) EXPECT_TRUE(all[k] == track(k, 200)) << k;
}

// The processes use the same port one after the other. Each must be answered at once.
TEST(DdsBus, ASuccessorFindsTheOtherParticipantsAtOnce) {
  const test::TemporaryFolder folder;
  const test::Background agent({test::program("robot_agent"), "--name", "a", "--domain", test::domain_name()},
                               folder.path() / "log");
  std::this_thread::sleep_for(std::chrono::seconds(8));  // its frequent first announcements are over
  for (int k = 0; k < 4; ++k) {
    const std::filesystem::path log = folder.path() / ("probe-" + std::to_string(k));
    const test::Background probe({COPPICE_TEST_BIN_DIR "/meeting_probe", "agent", "b", "--agents", "2",
                                  "--domain", test::domain_name()},
                                 log);
    EXPECT_TRUE(test::within(std::chrono::milliseconds(1500), [&] {
      return test::contents(log).find("matched") != std::string::npos;
    })) << k;
  }
}

TEST(DdsBus, AMapOf4096CellsIsCarried) {
  DdsBus service({.domain = test::own_domain()}, Role::service, "service");
  DdsBus agent({.domain = test::own_domain()}, Role::agent, "agent");
  const Message map = some_map(4096);
  service.publish(map);
  const auto all = receive(
      agent, [](const auto& got) { return !got.empty(); }, 30);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_TRUE(all.front() == map);
}

TEST(DdsBus, InvalidSamplesAreDroppedAndCounted) {
  DdsBus broker({.domain = test::own_domain()}, Role::broker, "broker");
  DdsBus agent({.domain = test::own_domain()}, Role::agent, "agent");
  InactiveTreesMessage forged = some_tree(1, 5);
  forged.nodes[3].parent = 900;
  broker.publish(forged);
  const Message good = some_tree(2, 5);
  broker.publish(good);
  const auto all = receive(agent, [&](const auto& got) { return holds(got, good) && agent.rejected() > 0; });
  EXPECT_EQ(all.size(), 1u);
  EXPECT_TRUE(holds(all, good));
  EXPECT_EQ(agent.rejected(), 1u);
}

/// Sends arbitrary bytes as samples of a topic.
template <class M>
class RawWriter {
 public:
  RawWriter(int on, const RobotName& robot) {
    auto* const factory = dds::DomainParticipantFactory::get_instance();
    dds::DomainParticipantQos qos;
    qos.user_data().data_vec(user_data_of(robot));
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(
        std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>());
    participant_ = factory->create_participant(static_cast<std::uint32_t>(on), qos);
    auto* const type = new Type();  // DDS owns it from here on
    type->bytes = &bytes_;
    type->auto_fill_type_information(false);
    type->auto_fill_type_object(false);
    eprosima::fastdds::dds::TypeSupport(type).register_type(participant_);
    dds::Topic* const topic =
        participant_->create_topic(std::string(Topic<M>::info.name), type->getName(), dds::TOPIC_QOS_DEFAULT);
    dds::DataWriterQos writer;
    writer.durability().kind = dds::TRANSIENT_LOCAL_DURABILITY_QOS;
    writer.history().kind = dds::KEEP_ALL_HISTORY_QOS;
    writer.endpoint().history_memory_policy = eprosima::fastrtps::rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
    writer_ = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT)->create_datawriter(topic, writer);
  }
  ~RawWriter() {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  RawWriter(const RawWriter&) = delete;
  RawWriter& operator=(const RawWriter&) = delete;

  void write(std::vector<std::uint8_t> bytes) {
    bytes_ = std::move(bytes);
    typename DdsType<M>::Type sample;
    sample.robot("raw");
    ASSERT_TRUE(writer_->write(&sample));
  }

 private:
  struct Type : DdsType<M>::Support {
    const std::vector<std::uint8_t>* bytes = nullptr;
    bool serialize(void*, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override {
      payload->length = static_cast<std::uint32_t>(bytes->size());
      std::ranges::copy(*bytes, payload->data);
      return true;
    }
    std::function<std::uint32_t()> getSerializedSizeProvider(void*) override {
      return [this] { return static_cast<std::uint32_t>(bytes->size()); };
    }
  };
  std::vector<std::uint8_t> bytes_;
  dds::DomainParticipant* participant_ = nullptr;
  dds::DataWriter* writer_ = nullptr;
};

template <class M>
std::vector<std::uint8_t> bytes_of(const M& message) {
  auto sample = to_dds(message);
  typename DdsType<M>::Support type;
  eprosima::fastrtps::rtps::SerializedPayload_t payload(type.getSerializedSizeProvider(&sample)());
  type.serialize(&sample, &payload);
  return {payload.data, payload.data + payload.length};
}

TEST(DdsBus, BytesThatAreNoSampleAreDroppedAndCounted) {
  DdsBus agent({.domain = test::own_domain(), .robot = "r2"}, Role::agent, "agent");
  RawWriter<Mission> writer(test::own_domain(), "");
  const Mission good = some_mission();
  std::vector<std::uint8_t> neither_true_nor_false = bytes_of(good);
  Mission cancelled = good;
  cancelled.cancelled = !good.cancelled;
  const std::vector<std::uint8_t> other = bytes_of(cancelled);
  *std::ranges::mismatch(neither_true_nor_false, other).in1 = 7;
  std::vector<std::uint8_t> cut = bytes_of(good);
  cut.resize(cut.size() / 2);
  std::size_t bad = 0;
  for (const std::vector<std::uint8_t>& bytes :
       {neither_true_nor_false, cut, std::vector<std::uint8_t>{0, 9, 0, 0, 1, 2, 3},  // no such encapsulation
        std::vector<std::uint8_t>{0, 1}, std::vector<std::uint8_t>(5000, 1)}) {
    writer.write(bytes);
    ++bad;
    EXPECT_TRUE(receive(agent, [&](const auto&) { return agent.rejected() == bad; }).empty());
    EXPECT_EQ(agent.rejected(), bad);
  }
  writer.write(bytes_of(good));
  EXPECT_EQ(receive(agent, [&](const auto& got) { return holds(got, good); }), std::vector<Message>{good});
}

TEST(DdsBus, TheBusUsesNoSharedMemory) {
  const auto segments = [] {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator("/dev/shm"))
      names.insert(entry.path().filename());
    return names;
  };
  const auto before = segments();
  {
    DdsBus service({.domain = test::own_domain()}, Role::service, "service");
    DdsBus agent({.domain = test::own_domain()}, Role::agent, "agent");
    service.publish(some_mission());
    receive(agent, [](const auto& got) { return !got.empty(); });
    EXPECT_EQ(segments(), before);
  }
  EXPECT_EQ(segments(), before);
}

TEST(DdsBus, TheBusRefusesTopicsThatTheRoleDoesNotWrite) {
  DdsBus agent({.domain = test::own_domain()}, Role::agent, "agent");
  EXPECT_THROW(agent.publish(some_mission()), std::logic_error);
}

TEST(DdsBus, TheDdsOfAnotherVendorReceivesTheStates) {
  const std::string subscriber = std::string(COPPICE_TEST_BIN_DIR) + "/cyclone_subscriber";
  auto heard = std::async(std::launch::async,
                          [&] { return test::shell(subscriber + " " + test::domain_name() + " 20 20"); });
  DdsBus agent({.domain = test::own_domain()}, Role::agent, "agent");
  for (std::uint32_t k = 1; heard.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready; ++k) {
    agent.publish(some_state(k));
  }
  const test::Outcome outcome = heard.get();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("r1 "), std::string::npos);
  EXPECT_NE(outcome.output.find(" 1.500 2.500"), std::string::npos) << outcome.output;
}

class DdsBusByDiscovery : public testing::TestWithParam<const char*> {};

TEST_P(DdsBusByDiscovery, AStateReachesItsRecipientsAndEveryObserver) {
  const std::string discovery = GetParam();
  // Within one process, Fast DDS would deliver samples unfiltered.
  using eprosima::fastrtps::LibrarySettingsAttributes;
  using eprosima::fastrtps::xmlparser::XMLProfileManager;
  const LibrarySettingsAttributes usual = XMLProfileManager::library_settings();
  LibrarySettingsAttributes separate = usual;
  separate.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
  XMLProfileManager::library_settings(separate);
  DdsBus sender({.domain = test::own_domain(), .robot = "a", .discovery = discovery}, Role::agent, "a");
  DdsBus near({.domain = test::own_domain(), .robot = "b", .discovery = discovery}, Role::agent, "b");
  DdsBus far({.domain = test::own_domain(), .robot = "c", .discovery = discovery}, Role::agent, "c");
  DdsBus watcher({.domain = test::own_domain(), .discovery = discovery}, Role::observer, "watcher");
  std::set<std::uint32_t> at_near;
  std::set<std::uint32_t> at_far;
  std::set<std::uint32_t> at_watcher;
  const auto take = [](DdsBus& bus, std::set<std::uint32_t>& heard) {
    for (const Arrival& arrival : bus.take()) {
      if (const auto* state = std::get_if<RobotState>(arrival.message.get())) heard.insert(state->sequence);
    }
  };
  const auto end = Clock::now() + std::chrono::seconds(20);
  std::uint32_t k = 0;
  while ((at_far.size() < 10 || at_near.size() < 60 || at_watcher.size() < 60) && Clock::now() < end) {
    ++k;
    sender.publish(
        Outgoing(some_state(k), k % 8 == 0 ? std::vector<RobotName>{"c", "b"} : std::vector<RobotName>{"b"}));
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    take(near, at_near);
    take(far, at_far);
    take(watcher, at_watcher);
  }
  XMLProfileManager::library_settings(usual);
  EXPECT_GE(at_far.size(), 10u);
  for (const std::uint32_t sequence : at_far) EXPECT_EQ(sequence % 8, 0u);
  EXPECT_GE(at_near.size(), 60u);
  EXPECT_GE(at_watcher.size(), 60u);
}

TEST_P(DdsBusByDiscovery, ALateAgentReceivesMapMissionAndAllInactiveTrees) {
  const std::string discovery = GetParam();
  DdsBus service({.domain = test::own_domain(), .discovery = discovery}, Role::service, "service");
  DdsBus broker({.domain = test::own_domain(), .discovery = discovery}, Role::broker, "broker");
  const Message map = some_map(512);
  service.publish(map);
  service.publish(some_mission());
  constexpr std::uint32_t trees = 300;
  for (std::uint32_t k = 0; k < trees; ++k) broker.publish(some_tree(k, k % 3 == 0 ? 1 : 40));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));

  DdsBus agent({.domain = test::own_domain(), .discovery = discovery}, Role::agent, "late");
  const auto all = receive(agent, [&](const auto& got) { return got.size() >= trees + 2; });
  EXPECT_TRUE(holds(all, map));
  EXPECT_TRUE(holds(all, some_mission()));
  for (std::uint32_t k = 0; k < trees; ++k) EXPECT_TRUE(holds(all, some_tree(k, k % 3 == 0 ? 1 : 40))) << k;
  EXPECT_EQ(agent.rejected(), 0u);
}

TEST(DdsBus, TheBusCountsTheBytesOfItsSockets) {
  DdsBus service({.domain = test::own_domain()}, Role::service, "service");
  DdsBus agent({.domain = test::own_domain(), .robot = "r1"}, Role::agent, "r1");
  DdsBus other({.domain = test::own_domain(), .robot = "r2"}, Role::agent, "r2");
  const auto end = Clock::now() + std::chrono::seconds(10);
  while (agent.counts().agents < 1 && Clock::now() < end) agent.wait(0.05);
  EXPECT_EQ(agent.counts().agents, 1u);  // not counting itself
  EXPECT_GT(agent.counts().bytes_sent, 1000u);
  EXPECT_GT(agent.counts().bytes_received, 1000u);
}

INSTANTIATE_TEST_SUITE_P(DdsBus, DdsBusByDiscovery, testing::Values(multicast_discovery, static_discovery));

TEST(DdsBus, CopiesAndRelayedStatesWaitForTheReader) {
  DdsBus sender({.domain = test::own_domain(), .robot = "r1"}, Role::agent, "r1");
  DdsBus other({.domain = test::own_domain(), .robot = "r2"}, Role::agent, "r2");
  DdsBus listener({.domain = test::own_domain(), .robot = "r3"}, Role::agent, "r3");
  constexpr std::uint8_t copies = 3;
  std::map<std::uint32_t, std::vector<RobotState>> heard;
  const auto end = Clock::now() + std::chrono::seconds(20);
  const auto complete = [&](const auto& entry) { return entry.second.size() == copies + 1u; };
  for (std::uint32_t k = 1; std::ranges::count_if(heard, complete) < 5 && Clock::now() < end; ++k) {
    RobotState state = some_state(k);
    state.passed_on = state.counts_as_failed = false;
    state.copies = copies;
    for (state.copy = 0; state.copy < copies; ++state.copy) sender.publish(Message(state));
    state.copy = 0;
    state.passed_on = true;
    other.publish(Message(state));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));  // a control period
    for (const Arrival& arrival : listener.take()) {
      if (const auto* s = std::get_if<RobotState>(arrival.message.get())) heard[s->sequence].push_back(*s);
    }
  }
  EXPECT_GE(std::ranges::count_if(heard, complete), 5);
}

TEST(DdsBus, ParticipantsOfADomainMeetThroughADiscoveryServer) {
  const DdsDiscoveryServer server("127.0.0.1", 23917, 0);
  const std::string known = "127.0.0.1:23917";
  DdsBus service({.domain = test::own_domain(), .discovery = known}, Role::service, "service");
  DdsBus agent({.domain = test::own_domain(), .discovery = known}, Role::agent, "agent");
  DdsBus stranger({.domain = test::own_domain()}, Role::agent, "stranger");
  DdsBus of_another_fleet({.domain = test::own_domain(1), .discovery = known}, Role::agent,
                          "of another fleet");
  const Message mission = some_mission();
  service.publish(mission);
  EXPECT_TRUE(holds(receive(agent, [&](const auto& all) { return holds(all, mission); }), mission));
  for (DdsBus* const other : {&stranger, &of_another_fleet}) {
    EXPECT_TRUE(receive(
                    *other, [](const auto& all) { return !all.empty(); }, 1)
                    .empty());
  }
}

// Fast DDS itself would say nothing, and the process would hear of no other.
TEST(DdsBus, AMulticastPortThatAnotherProgramHasIsAnError) {
  const int alien = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(domain_port(test::own_domain())));
  ASSERT_EQ(bind(alien, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  for (const std::string discovery : {multicast_discovery, static_discovery}) {
    const test::Outcome outcome =
        test::shell("timeout 20 '" + test::program("robot_agent") + "' --name r1 --domain " +
                    test::domain_name() + " --discovery " + discovery);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.output;
    EXPECT_NE(outcome.output.find("UDP port " + std::to_string(domain_port(test::own_domain()))),
              std::string::npos)
        << outcome.output;
  }
  EXPECT_NO_THROW(
      DdsBus({.domain = test::own_domain(), .discovery = "127.0.0.1:23920"}, Role::agent, "agent"));
  close(alien);
}

TEST(DdsBus, InvalidAddressesOfDiscoveryServersAreRefused) {
  EXPECT_THROW(DdsBus({.discovery = "nonsense"}, Role::agent, "agent"), std::runtime_error);
  EXPECT_THROW(DdsDiscoveryServer("300.1.1.1", 23918, 0), std::runtime_error);
  EXPECT_THROW(DdsDiscoveryServer("203.0.113.1", 23918, 0), std::runtime_error);  // unused (RFC 5737)
}

}  // namespace
}  // namespace coppice
