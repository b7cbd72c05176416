#include "dds/dds_bus.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <type_traits>
#include <utility>

#include <fastdds/dds/core/condition/StatusCondition.hpp>
#include <fastdds/dds/core/condition/WaitSet.hpp>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastrtps/config.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "dds/checked_type.h"
#include "dds/conversion.h"
#include "dds/participant.h"
#include "dds/qos.h"
#include "dds/security.h"
#include "dds/senders.h"
#include "dds/static_endpoints.h"
#include "dds/transport.h"
#include "dds/type_objects.h"
#include "messages/topics.h"
#include "messages/validation.h"

namespace coppice {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::Duration_t;

namespace {

// How soon a lost sample of a reliable topic is asked for again: the default of 3 s is longer than a plan
// takes; but what a busy process has not acknowledged yet must not add to what keeps it busy. Among agents
// all are asked for all, whenever one has come.
constexpr std::uint32_t heartbeat_nanoseconds = 100'000'000;
constexpr std::uint32_t heartbeat_among_agents_nanoseconds = 500'000'000;
// What came in disorder or was lost is asked for once for all that came in this time: over links with 100 ms
// +- 50 ms delay, asking at every heartbeat doubled the traffic until all had their trees, and the
// processors' load.
constexpr std::uint32_t heartbeat_response_nanoseconds = 20'000'000;
// How often a reader that has heard nothing of a writer yet says that it is there: the writer says so, too.
constexpr std::uint32_t first_contact_nanoseconds = 500'000'000;
constexpr int most_taken = 1000;    // samples of a topic at a time
constexpr double longest_held = 1;  // seconds until its sender must be known
constexpr std::chrono::milliseconds longest_farewell{500};
constexpr std::size_t rejections_logged = 10;  // then every thousandth

/// Servers tell everybody of everybody, whatever the domain is: what they find keeps to its own by partition.
template <class Qos>
Qos of_domain(const DdsSettings& settings) {
  Qos qos;
  if (are_servers(discovery_of(settings)))
    qos.partition().push_back(fmt::format("domain-{}", settings.domain).c_str());
  return qos;
}

template <class M>
dds::DataWriterQos writer_qos() {
  constexpr TopicInfo info = Topic<M>::info;
  constexpr bool among_agents = Topic<M>::written_by(Role::agent) && Topic<M>::read_by(Role::agent);
  dds::DataWriterQos qos;
  apply(info, qos);
  // Fragments of a large sample leave in DDS's own thread; a small one need not wait for that.
  qos.publish_mode().kind = info.reliability == Reliability::reliable ? dds::ASYNCHRONOUS_PUBLISH_MODE
                                                                      : dds::SYNCHRONOUS_PUBLISH_MODE;
  qos.reliable_writer_qos().times.heartbeatPeriod =
      Duration_t(0, among_agents ? heartbeat_among_agents_nanoseconds : heartbeat_nanoseconds);
  qos.reliable_writer_qos().times.nackResponseDelay = Duration_t(0, 0);
  return qos;
}

dds::DataReaderQos reader_qos(const TopicInfo& info) {
  dds::DataReaderQos qos;
  apply(info, qos);
  qos.reliable_reader_qos().times.heartbeatResponseDelay = Duration_t(0, heartbeat_response_nanoseconds);
  qos.reliable_reader_qos().times.initialAcknackDelay = Duration_t(0, first_contact_nanoseconds);
  return qos;
}

template <class Qos>
void number(std::uint16_t id, Qos& qos) {
  qos.endpoint().user_defined_id = static_cast<std::int16_t>(id);
  qos.endpoint().entity_id = static_cast<std::int16_t>(id);
}

/// The ends of one topic in this process; either may be missing.
template <class M>
struct Ends {
  dds::DataWriter* writer = nullptr;
  dds::DataReader* reader = nullptr;
  WallTime run = 0;    ///< of the last sample that was written, where all of a run are kept
  std::string map_id;  ///< likewise, of a map
};

/// Whether what a writer keeps for who comes late, all of a run or all trees of a map, is of use to nobody
/// once this is said: processes may live for months.
template <class M>
bool outdates(const M& message, Ends<M>& ends) {
  if constexpr (std::is_same_v<M, InactiveTreeMessage>)
    return std::exchange(ends.map_id, message.map_id) != message.map_id;
  else if constexpr (Topic<M>::info.depth == 0 && requires { message.run; })
    return std::exchange(ends.run, message.run) != message.run;
  else
    return false;
}

}  // namespace

/// Whether what arrives ends a wait. States come in swarms, and are looked at once in a control period.
template <class M>
constexpr bool wakes = Topic<M>::info.reliability == Reliability::reliable;

struct DdsBus::Implementation {
  Role role;
  Recipients recipients;  // of whoever is there; with security, of whoever has proved who it is
  Announcements announcements;
  Traffic traffic;
  Senders senders;
  Discoveries discoveries;
  dds::DomainParticipant* participant = nullptr;
  dds::Publisher* publisher = nullptr;
  dds::Subscriber* subscriber = nullptr;
  std::tuple<Ends<MapMessage>, Ends<Mission>, Ends<RootNodes>, Ends<InactiveTreeMessage>, Ends<RobotState>,
             Ends<JointPlanMessage>, Ends<PathMessage>, Ends<TrackMessage>, Ends<AgentStatus>,
             Ends<BrokerStatus>, Ends<Claim>, Ends<Assignment>, Ends<ActiveTreesMessage>, Ends<ServiceStatus>>
      topics;
  dds::WaitSet wait_set;
  struct Received {
    Arrival arrival;
    eprosima::fastrtps::rtps::GuidPrefix_t from;
    std::string_view topic;
  };
  std::vector<Received> held;  ///< of senders that are not known yet
  bool more = false;           ///< the last take left samples behind
  std::size_t rejected = 0;
  std::size_t lost = 0;

  Implementation(Role role_of_process, bool is_secure, const RobotName& robot)
      : role(role_of_process), recipients(is_secure), discoveries(recipients, senders, announcements, robot) {}

  /// Whatever it throws, the destructor runs: DDS's threads know the members above.
  Implementation(const DdsSettings& settings, Role role_of_process, const std::string& sender)
      : Implementation(role_of_process, !settings.security.empty(), settings.robot) {
    if (!settings.security.empty()) check_credentials(settings.security, role);
    // A megabyte of them, for tools that see the endpoints.
    if (discovery_of(settings) != static_discovery) register_type_objects();
    participant = disabled_participant(settings, sender);
    publisher =
        required(participant->create_publisher(of_domain<dds::PublisherQos>(settings)), "a publisher");
    subscriber =
        required(participant->create_subscriber(of_domain<dds::SubscriberQos>(settings)), "a subscriber");
    std::apply([&](auto&... ends) { (open(ends), ...); }, topics);
    if (participant->enable() != eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK)
      throw std::runtime_error(
          "DDS could not enable the participant (are all of the domain's ports in use?)");
    senders.note_own(participant->guid().guidPrefix, settings.robot, role == Role::replayer);
    std::apply([&](auto&... ends) { (expect_enabled(ends), ...); }, topics);
    announcements.begin();
  }

  ~Implementation() {
    if (participant == nullptr) return;
    const auto latest = std::chrono::steady_clock::now() + longest_farewell;
    std::apply([&](auto&... ends) { (wait_for_readers(ends, latest), ...); }, topics);
    std::apply([&](auto&... ends) { (detach(ends), ...); }, topics);
    participant->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant);
  }

  /// To be enabled when it is complete, so that those whom it discovers need not be told of each endpoint.
  dds::DomainParticipant* disabled_participant(const DdsSettings& settings, const std::string& sender) {
    auto* const factory = dds::DomainParticipantFactory::get_instance();
    dds::DomainParticipantFactoryQos usual;
    factory->get_qos(usual);
    dds::DomainParticipantFactoryQos later = usual;
    later.entity_factory().autoenable_created_entities = false;
    factory->set_qos(later);
    auto* const created =
        factory->create_participant(static_cast<std::uint32_t>(settings.domain),
                                    participant_qos(settings, role, sender, recipients, announcements, traffic),
                                    &discoveries, dds::StatusMask::none());
    factory->set_qos(usual);
    return required(created, "a participant (is the domain between 0 and 232?)");
  }

  template <class M>
  void open(Ends<M>& ends) {
    using T = Topic<M>;
    if (!T::written_by(role) && !T::read_by(role)) return;
    dds::TypeSupport type(new CheckedType<typename DdsType<M>::Support>());
    // Cyclone DDS 0.10 refuses an endpoint whose type information it cannot parse, and it cannot parse Fast
    // DDS's; and type objects alone keep Fast DDS 2.9's own endpoints from matching. Names and QoS decide who
    // matches.
    type->auto_fill_type_information(false);
    type->auto_fill_type_object(false);
    type.register_type(participant);
    dds::Topic* topic = required(
        participant->create_topic(std::string(T::info.name), type.get_type_name(), dds::TOPIC_QOS_DEFAULT),
        "a topic");
    if (T::written_by(role)) {
      dds::DataWriterQos qos = writer_qos<M>();
      number(writer_id<M>(), qos);
      ends.writer = required(publisher->create_datawriter(topic, qos), "a writer");
    }
    if (T::read_by(role)) {
      dds::DataReaderQos qos = reader_qos(T::info);
      number(reader_id<M>(), qos);
      ends.reader = required(subscriber->create_datareader(topic, qos), "a reader");
      if (!wakes<M>) return;
      ends.reader->get_statuscondition().set_enabled_statuses(dds::StatusMask::data_available());
      wait_set.attach_condition(ends.reader->get_statuscondition());
    }
  }

  /// A participant counts as enabled also where one of its endpoints was refused.
  template <class M>
  void expect_enabled(const Ends<M>& ends) {
    if ((ends.writer != nullptr && !ends.writer->is_enabled()) ||
        (ends.reader != nullptr && !ends.reader->is_enabled()))
      throw std::runtime_error(fmt::format("DDS refused topic {}", Topic<M>::info.name));
  }

  template <class M>
  static void wait_for_readers(const Ends<M>& ends, std::chrono::steady_clock::time_point latest) {
    if (ends.writer == nullptr || Topic<M>::info.reliability != Reliability::reliable) return;
    const std::chrono::duration<double> left = latest - std::chrono::steady_clock::now();
    ends.writer->wait_for_acknowledgments(Duration_t(std::max(left.count(), 0.0)));
  }

  template <class M>
  void detach(Ends<M>& ends) {
    if (ends.reader != nullptr && wakes<M>) wait_set.detach_condition(ends.reader->get_statuscondition());
  }

  template <class M>
  void drain(Ends<M>& ends, std::vector<Arrival>& out) {
    if (ends.reader == nullptr) return;
    typename DdsType<M>::Type sample;
    dds::SampleInfo info;
    // Samples may come in as fast as they are taken: the role must get its turn.
    for (int taken = 0;
         ends.reader->take_next_sample(&sample, &info) == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
         ++taken) {
      if (!info.valid_data) continue;
      Message message = from_dds(sample);
      if (const auto problem = problem_with(message)) {
        reject(Topic<M>::info.name, *problem);
      } else {
        const auto writer = eprosima::fastrtps::rtps::iHandle2GUID(info.publication_handle);
        hand_over({arrival_of(std::move(message), seconds(info.reception_timestamp)), writer.guidPrefix,
                   Topic<M>::info.name},
                  out);
      }
      if (taken < most_taken) continue;
      more = true;
      return;
    }
  }

  /// If it comes from whom it says. What comes from one who is not known yet is held back: where endpoints
  /// are matched by a table, they are just before their participant is told of.
  void hand_over(Received received, std::vector<Arrival>& out) {
    const RobotName* const robot = sender_of(*received.arrival.message);
    const auto sender = robot != nullptr ? senders.robot_of(received.from) : std::nullopt;
    const bool waits = std::ranges::find(held, received.from, &Received::from) != held.end();
    if (!waits && senders.replays(received.from)) {
      hand_over_replayed(std::move(received), out);
    } else if (robot == nullptr || (sender == *robot && !waits)) {
      out.push_back(std::move(received.arrival));
    } else if (!sender || waits) {
      held.push_back(std::move(received));
    } else {
      reject(received.topic, "it is not from the agent of the robot that it names");
    }
  }

  /// What was recorded of others is for those who look on. A replayer is to hear of whoever else is there,
  /// and what it says itself comes back to it.
  void hand_over_replayed(Received received, std::vector<Arrival>& out) {
    const bool own = received.from == participant->guid().guidPrefix;
    const bool looks_on = role == Role::observer || role == Role::viewer;
    if (looks_on || (role == Role::replayer && !own)) {
      out.push_back(std::move(received.arrival));
    } else if (role != Role::replayer) {
      reject(received.topic, "it is of a recording that is replayed on this domain");
    }
  }

  /// What was held back, if its senders are known by now.
  void hand_over_held(WallTime now, std::vector<Arrival>& out) {
    for (Received& received : std::exchange(held, {})) {
      if (!senders.robot_of(received.from) && now - received.arrival.at > longest_held) {
        reject(received.topic, "it is from nobody that is known");
      } else {
        hand_over(std::move(received), out);
      }
    }
  }

  void reject(std::string_view topic, const std::string& problem) {
    ++rejected;
    if (rejected <= rejections_logged || rejected % 1000 == 0) {
      spdlog::warn("dropped a sample of topic {}: {} ({} dropped so far)", topic, problem, rejected);
    }
  }
};

std::string dds_version() {
  return FASTRTPS_VERSION_STR;
}

DdsBus::DdsBus(const DdsSettings& settings, Role role, const std::string& sender)
    : implementation_(std::make_unique<Implementation>(settings, role, sender)) {}

DdsBus::~DdsBus() = default;

void DdsBus::publish(const Outgoing& outgoing) {
  std::visit(
      [&]<class M>(const M& m) {
        dds::DataWriter* writer = std::get<Ends<M>>(implementation_->topics).writer;
        if (writer == nullptr)
          throw std::logic_error("this role does not write " + std::string(Topic<M>::info.name));
        if (outdates(m, std::get<Ends<M>>(implementation_->topics)) &&
            implementation_->role != Role::replayer)
          writer->clear_history(nullptr);
        auto sample = to_dds(m);
        std::optional<Recipients::Limit> limit;
        if (outgoing.agents) limit.emplace(implementation_->recipients, *outgoing.agents);
        if (!writer->write(&sample)) {
          ++implementation_->lost;
          spdlog::warn("could not write a sample of topic {}", Topic<M>::info.name);
        }
      },
      outgoing.message);
}

std::vector<Arrival> DdsBus::take() {
  std::vector<Arrival> out;
  implementation_->more = false;
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  implementation_->hand_over_held(std::chrono::duration<double>(now).count(), out);
  std::apply([&](auto&... ends) { (implementation_->drain(ends, out), ...); }, implementation_->topics);
  return out;
}

bool DdsBus::wait(double seconds) {
  if (seconds <= 0 || implementation_->more) return true;
  dds::ConditionSeq active;
  const auto whole = static_cast<std::int32_t>(seconds);
  const Duration_t timeout(whole, static_cast<std::uint32_t>((seconds - whole) * 1e9));
  return implementation_->wait_set.wait(active, timeout) ==
         eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
}

dds::DomainParticipant& DdsBus::participant() {
  return *implementation_->participant;
}

std::size_t DdsBus::rejected() const {
  return implementation_->rejected;
}
std::size_t DdsBus::lost() const {
  return implementation_->lost;
}

template <class M>
std::size_t DdsBus::matched_readers() const {
  const dds::DataWriter* writer = std::get<Ends<M>>(implementation_->topics).writer;
  if (writer == nullptr) return 0;
  dds::PublicationMatchedStatus status;
  writer->get_publication_matched_status(status);
  return static_cast<std::size_t>(status.current_count);
}

template std::size_t DdsBus::matched_readers<MapMessage>() const;
template std::size_t DdsBus::matched_readers<Mission>() const;
template std::size_t DdsBus::matched_readers<RobotState>() const;
template std::size_t DdsBus::matched_readers<Claim>() const;
template std::size_t DdsBus::matched_readers<InactiveTreeMessage>() const;

/// An agent is matched with itself, too.
bool DdsBus::hears_replay() const {
  return implementation_->senders.somebody_replays();
}

BusCounts DdsBus::counts() const {
  return {.rejected = rejected(),
          .agents = std::max<std::size_t>(1, matched_readers<RobotState>()) - 1,
          .bytes_sent = implementation_->traffic.bytes_sent,
          .bytes_received = implementation_->traffic.bytes_received,
          .processor_seconds = static_cast<double>(std::clock()) / CLOCKS_PER_SEC};
}

}  // namespace coppice
