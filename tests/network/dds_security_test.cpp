// Tests of DDS-Security: a participant exchanges messages only with valid credentials of its role. Each
// refusal is compared with the same exchange with the right credentials, so that the test can fail.
//
// CTest: RESOURCE_LOCK lane_2

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <set>
#include <thread>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <gtest/gtest.h>

#include "dds/conversion.h"
#include "dds/dds_bus.h"
#include "dds/security.h"
#include "dds/static_endpoints.h"
#include "messages/topics.h"
#include "tests/domains.h"
#include "tests/network/samples.h"
#include "tests/support.h"

namespace coppice {
namespace {

namespace fs = std::filesystem;
namespace dds = eprosima::fastdds::dds;
using namespace std::chrono_literals;
using namespace std::string_literals;
using Clock = std::chrono::steady_clock;

constexpr double long_enough = 20;  // seconds for messages that must come
// Seconds for messages that must not come: the same exchange with good credentials takes a fraction of a
// second.
constexpr double for_nothing = 4;

std::string make_keys(const std::string& arguments) {
  return "'" COPPICE_SOURCE_DIR "/deploy/security/make-keys' " + arguments;
}

Mission mission(int number) {
  Mission mission = some_mission();
  mission.number = static_cast<std::uint32_t>(number);
  return mission;
}
AgentStatus status(int number) {
  return {.robot = "r1", .mission = static_cast<std::uint32_t>(number), .phase = Phase::driving};
}

class Security : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    // The processes of a fleet share no memory, so that two participants of this test must not either.
    eprosima::fastrtps::LibrarySettingsAttributes separate;
    separate.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
    eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(separate);
    folder = std::make_unique<test::TemporaryFolder>();
    for (const char* keys : {"ours", "theirs"}) {
      const test::Outcome made =
          test::shell(make_keys("'" + (folder->path() / keys).string() + "' --with-replayer"));
      ASSERT_EQ(made.exit_code, 0) << made.output;
    }
  }
  static void TearDownTestSuite() { folder.reset(); }

  static std::string of(const std::string& role, const std::string& keys = "ours") {
    return (folder->path() / keys / role).string();
  }
  /// A copy of the folder that a test may change.
  static std::string copy_of(const std::string& role, const std::string& name) {
    const fs::path copy = folder->path() / name;
    fs::remove_all(copy);
    fs::copy(of(role), copy);
    return copy.string();
  }
  /// Runs a command in the folder of our authorities.
  static void as_authority(const std::string& command) {
    const test::Outcome done = test::shell("cd '" + of("ca") + "' && " + command);
    ASSERT_EQ(done.exit_code, 0) << done.output;
  }

  static std::unique_ptr<test::TemporaryFolder> folder;
};
std::unique_ptr<test::TemporaryFolder> Security::folder;

bool holds(const std::vector<Arrival>& all, const Message& wanted) {
  return std::ranges::any_of(all, [&](const Arrival& arrival) { return *arrival.message == wanted; });
}

bool receives(DdsBus& bus, const Message& wanted, double seconds) {
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (Clock::now() < end) {
    bus.wait(0.1);
    if (holds(bus.take(), wanted)) return true;
  }
  return false;
}

/// Which messages passed between a good service and an agent with the given credentials.
struct Exchange {
  bool in;   ///< the agent heard its mission
  bool out;  ///< the service heard the agent
};
Exchange exchange(const std::string& credentials_of_service, const std::string& credentials_of_agent,
                  int on_domain, double seconds) {
  DdsBus service({.domain = on_domain, .security = credentials_of_service}, Role::service, "service");
  DdsBus agent({.domain = on_domain, .robot = "r1", .security = credentials_of_agent}, Role::agent, "agent");
  service.publish(mission(1));
  agent.publish(status(1));
  const bool in = receives(agent, mission(1), seconds);
  return {in, receives(service, status(1), in ? seconds : 0.5)};
}

TEST_F(Security, ValidCredentialsPass) {
  const Exchange good = exchange(of("service"), of("agent"), test::own_domain(), long_enough);
  EXPECT_TRUE(good.in);
  EXPECT_TRUE(good.out);
}

TEST_F(Security, ParticipantsWithoutSecurityAreCutOff) {
  for (const auto& [service, agent] : {std::pair{of("service"), ""s}, std::pair{""s, of("agent")}}) {
    const Exchange bad = exchange(service, agent, test::own_domain(), for_nothing);
    EXPECT_FALSE(bad.in) << service << agent;
    EXPECT_FALSE(bad.out) << service << agent;
  }
  const Exchange open = exchange("", "", test::own_domain(), long_enough);
  EXPECT_TRUE(open.in && open.out) << "without security on either side the messages pass";
}

TEST_F(Security, CredentialsOfAnotherAuthorityAreRefused) {
  const Exchange bad = exchange(of("service"), of("agent", "theirs"), test::own_domain(), for_nothing);
  EXPECT_FALSE(bad.in);
  EXPECT_FALSE(bad.out);
  const Exchange among_them =
      exchange(of("service", "theirs"), of("agent", "theirs"), test::own_domain(), long_enough);
  EXPECT_TRUE(among_them.in && among_them.out)
      << "the credentials are valid for participants that trust that authority";
}

TEST_F(Security, SelfSignedPermissionsAreRefused) {
  // An identity of our authority with permissions of another authority.
  const std::string forged = copy_of("agent", "forged");
  for (const char* file : {"permissions_ca.cert.pem", "governance.p7s", "permissions.p7s"})
    fs::copy_file(of("agent", "theirs") + "/" + file, forged + "/" + file,
                  fs::copy_options::overwrite_existing);
  const Exchange bad = exchange(of("service"), forged, test::own_domain(), for_nothing);
  EXPECT_FALSE(bad.in);
  EXPECT_FALSE(bad.out);
}

/// Issues an agent's certificate that expires in so many seconds.
void issue_for(int seconds, const std::string& agent, const std::string& authority) {
  const std::string ends = "$(date -u -d '+" + std::to_string(seconds) + " seconds' +%Y%m%d%H%M%SZ)";
  const std::string begins = "$(date -u -d '-1 hour' +%Y%m%d%H%M%SZ)";
  const test::Outcome done = test::shell(
      "cd '" + authority + "' && openssl req -new -key '" + agent + "/key.pem' -subj /CN=agent -out '" +
      agent + "/csr' && openssl ca -config openssl.cnf -batch -notext -startdate " + begins + " -enddate " +
      ends + " -in '" + agent + "/csr' -out '" + agent + "/cert.pem'");
  ASSERT_EQ(done.exit_code, 0) << done.output;
}

TEST_F(Security, ExpiredCredentialsAreRefused) {
  constexpr int valid_for = 6;
  const std::string short_lived = copy_of("agent", "short-lived");
  issue_for(valid_for, short_lived, of("ca"));
  const auto expired = Clock::now() + std::chrono::seconds(valid_for + 1);
  DdsBus agent({.domain = test::own_domain(), .robot = "r1", .security = short_lived}, Role::agent, "agent");
  agent.publish(status(1));
  {
    DdsBus service({.domain = test::own_domain(), .security = of("service")}, Role::service, "service");
    service.publish(mission(1));
    EXPECT_TRUE(receives(agent, mission(1), valid_for)) << "while they are valid";
    EXPECT_TRUE(receives(service, status(1), valid_for)) << "while they are valid";
  }
  std::this_thread::sleep_until(expired);
  // A new participant does not trust the agent any more, though the agent still runs.
  DdsBus service({.domain = test::own_domain(), .security = of("service")}, Role::service, "service");
  service.publish(mission(2));
  EXPECT_FALSE(receives(agent, mission(2), for_nothing));
  EXPECT_FALSE(receives(service, status(1), 0.5));
  // And the agent does not start again.
  EXPECT_THROW(check_credentials(short_lived, Role::agent), std::runtime_error);
}

TEST_F(Security, RevokedCredentialsAreRefused) {
  const std::string keys = (folder->path() / "revoked").string();
  ASSERT_EQ(test::shell(make_keys("'" + keys + "'")).exit_code, 0);
  const std::string old = (folder->path() / "old-agent").string();
  fs::copy(keys + "/agent", old);
  const Exchange before = exchange(keys + "/service", old, test::own_domain(), long_enough);
  EXPECT_TRUE(before.in && before.out);
  ASSERT_EQ(test::shell(make_keys("'" + keys + "' --revoke agent")).exit_code, 0);
  const Exchange after = exchange(keys + "/service", old, test::own_domain(), for_nothing);
  EXPECT_FALSE(after.in);
  EXPECT_FALSE(after.out);
  const Exchange renewed = exchange(keys + "/service", keys + "/agent", test::own_domain(), long_enough);
  EXPECT_TRUE(renewed.in && renewed.out);
}

TEST_F(Security, ARoleDoesNotStartWithCredentialsOfAnotherRole) {
  EXPECT_NO_THROW(
      DdsBus({.domain = test::own_domain(), .security = of("service")}, Role::service, "service"));
  for (const auto& [credentials, role] : {std::pair{"agent", Role::service},
                                          {"agent", Role::broker},
                                          {"observer", Role::agent},
                                          {"broker", Role::observer}}) {
    EXPECT_THROW(DdsBus({.domain = test::own_domain(), .security = of(credentials)}, role, "other"),
                 std::runtime_error)
        << credentials;
  }
}

/// A single participant with static discovery. DDS itself then accepts or refuses the endpoints of each
/// topic, without the earlier checks of the bus.
class Participant {
 public:
  explicit Participant(const std::string& credentials) {
    dds::DomainParticipantQos qos;
    secure(credentials, qos);
    qos.name(static_participant);
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(
        std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>());
    auto& discovery = qos.wire_protocol().builtin.discovery_config;
    discovery.use_SIMPLE_EndpointDiscoveryProtocol = false;
    discovery.use_STATIC_EndpointDiscoveryProtocol = true;
    discovery.static_edp_xml_config(("data://" + static_endpoints(Role::service)).c_str());
    participant_ = dds::DomainParticipantFactory::get_instance()->create_participant(test::own_domain(), qos);
  }
  ~Participant() {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  /// Null if DDS refuses it.
  template <class M>
  dds::DataWriter* writer() {
    dds::DataWriterQos qos;
    qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
    qos.durability().kind = dds::TRANSIENT_LOCAL_DURABILITY_QOS;
    qos.endpoint().user_defined_id = qos.endpoint().entity_id = static_cast<std::int16_t>(writer_id<M>());
    return participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT)->create_datawriter(topic_of<M>(), qos);
  }
  template <class M>
  dds::DataReader* reader() {
    dds::DataReaderQos qos;
    qos.endpoint().user_defined_id = qos.endpoint().entity_id = static_cast<std::int16_t>(reader_id<M>());
    return participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT)
        ->create_datareader(topic_of<M>(), qos);
  }

 private:
  template <class M>
  dds::Topic* topic_of() {
    const std::string name(Topic<M>::info.name);
    if (auto* const known = participant_->lookup_topicdescription(name))
      return static_cast<dds::Topic*>(known);
    const dds::TypeSupport type(new typename DdsType<M>::Support());
    type.register_type(participant_);
    return participant_->create_topic(name, type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
  }
  dds::DomainParticipant* participant_ = nullptr;
};

template <class M>
void expect_as_in_table(Participant& participant, Role role, const std::string& name) {
  EXPECT_EQ(participant.writer<M>() != nullptr, Topic<M>::written_by(role))
      << name << " writes " << Topic<M>::info.name;
  EXPECT_EQ(participant.reader<M>() != nullptr, Topic<M>::read_by(role))
      << name << " reads " << Topic<M>::info.name;
}

template <class... Ms>
void expect_all_as_in_table(const std::variant<Ms...>*, const std::string& credentials, Role role,
                            const std::string& name) {
  Participant participant(credentials);
  (expect_as_in_table<Ms>(participant, role, name), ...);
}

TEST_F(Security, ThePermissionsMatchTheTableOfTopics) {
  const std::vector<std::pair<Role, std::string>> roles = {
      {Role::broker, "broker"},
      {Role::claimant, "agent"},  // it may become an agent
      {Role::service, "service"},
      {Role::observer, "observer"},
      {Role::replayer, "replayer"}};
  for (const auto& [role, name] : roles)
    expect_all_as_in_table(static_cast<const Message*>(nullptr), of(name), role, name);
}

TEST_F(Security, PeersRefuseWritesThatTheCredentialsForbid) {
  // With static discovery, endpoints do not announce their protection, which would keep them from matching.
  // Our own authority tells this process alone that writing is free, so that it does not refuse forbidden
  // writes by itself.
  as_authority(
      "sed 's/<enable_write_access_control>true/<enable_write_access_control>false/' governance.xml >lax.xml "
      "&& "
      "openssl smime -sign -text -in lax.xml -out lax.p7s -signer permissions_ca.cert.pem -inkey "
      "permissions_ca.key.pem");
  const std::string lax_agent = copy_of("agent", "lax-agent");
  const std::string lax_service = copy_of("service", "lax-service");
  for (const std::string& lax : {lax_agent, lax_service})
    fs::copy_file(of("ca") + "/lax.p7s", lax + "/governance.p7s", fs::copy_options::overwrite_existing);
  DdsBus robot({.domain = test::own_domain(), .discovery = static_discovery, .security = of("agent")},
               Role::agent, "robot");
  const auto write_mission = [](Participant& participant, int number) {
    dds::DataWriter* const writer = participant.writer<Mission>();
    ASSERT_NE(writer, nullptr) << "the process itself must not refuse the write";
    auto sample = to_dds(mission(number));
    EXPECT_TRUE(writer->write(&sample));
  };
  {
    Participant impostor(lax_agent);
    write_mission(impostor, 1);
    EXPECT_FALSE(receives(robot, mission(1), for_nothing));
  }
  Participant service(lax_service);
  write_mission(service, 2);
  EXPECT_TRUE(receives(robot, mission(2), long_enough))
      << "the same passes with the credentials of a service";
}

class SecurityByDiscovery : public Security, public testing::WithParamInterface<const char*> {};

TEST_P(SecurityByDiscovery, AStateReachesItsRecipientsAndEveryObserver) {
  const auto settings = [&](const RobotName& robot, const std::string& role) {
    return DdsSettings{
        .domain = test::own_domain(), .robot = robot, .discovery = GetParam(), .security = of(role)};
  };
  DdsBus sender(settings("a", "agent"), Role::agent, "a");
  DdsBus near(settings("b", "agent"), Role::agent, "b");
  DdsBus far(settings("c", "agent"), Role::agent, "c");
  DdsBus watcher(settings("", "observer"), Role::observer, "watcher");
  const auto end = Clock::now() + 20s;
  std::set<std::uint32_t> at_near;
  std::set<std::uint32_t> at_far;
  std::set<std::uint32_t> at_watcher;
  const auto take = [](DdsBus& bus, std::set<std::uint32_t>& heard) {
    for (const Arrival& arrival : bus.take()) {
      if (const auto* state = std::get_if<RobotState>(arrival.message.get())) heard.insert(state->sequence);
    }
  };
  for (std::uint32_t k = 1;
       (at_far.size() < 10 || at_near.size() < 60 || at_watcher.size() < 60) && Clock::now() < end; ++k) {
    const double stamp = 0.01 * k;
    const RobotState state{.robot = "a",
                           .sequence = k,
                           .promise = {.stamp = stamp,
                                       .decision_time = stamp + 0.05,
                                       .next_velocity = {0, 0},
                                       .expiry = stamp + 0.1},
                           .radius = 5,
                           .max_speed = 20,
                           .max_acceleration = 40};
    sender.publish(
        Outgoing(state, k % 8 == 0 ? std::vector<RobotName>{"b", "c"} : std::vector<RobotName>{"b"}));
    std::this_thread::sleep_for(10ms);
    take(near, at_near);
    take(far, at_far);
    take(watcher, at_watcher);
  }
  EXPECT_GE(at_far.size(), 10u);
  for (const std::uint32_t sequence : at_far) EXPECT_EQ(sequence % 8, 0u);
  EXPECT_GE(at_near.size(), 60u);
  EXPECT_GE(at_watcher.size(), 60u);
}

INSTANTIATE_TEST_SUITE_P(Discovery, SecurityByDiscovery,
                         testing::Values(multicast_discovery, static_discovery));

}  // namespace
}  // namespace coppice
