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
#include "messages/topics.h"
#include "messages/validation.h"

namespace coppice {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::Duration_t;

namespace {

// How soon a reader asks again for a lost sample of a reliable topic. The default of 3 s is longer than a
// plan takes. But a short period adds load to a process that is too busy to acknowledge. Among agents it is
// longer, because every agent answers every other one.
constexpr std::uint32_t heartbeat_nanoseconds = 100'000'000;
constexpr std::uint32_t heartbeat_among_agents_nanoseconds = 500'000'000;
// A reader asks once for all samples that were lost or came out of order in this time. Over links with a
// delay of 100 ms +- 50 ms, asking at every heartbeat doubled the traffic and the processors' load until all
// agents had their trees.
constexpr std::uint32_t heartbeat_response_nanoseconds = 20'000'000;
// How often a reader announces itself to a writer that it has not heard yet. The writer does so, too.
constexpr std::uint32_t first_contact_nanoseconds = 500'000'000;
constexpr int most_taken = 1000;                 // samples of a topic in one call
constexpr std::chrono::seconds longest_held{1};  // that a sample waits until its sender is known
constexpr std::chrono::milliseconds longest_farewell{500};
constexpr std::size_t rejections_logged = 10;  // afterwards every thousandth rejection is logged

/// Discovery servers connect the participants of all domains. A partition per domain keeps the domains apart.
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
  // DDS's own thread sends maps and trees, which are large. It spins while another thread holds its writer
  // (Fast DDS 2.9, FlowControllerImpl::run), so an agent sends at once: it writes small samples, and often.
  qos.publish_mode().kind =
      Topic<M>::written_by(Role::agent) ? dds::SYNCHRONOUS_PUBLISH_MODE : dds::ASYNCHRONOUS_PUBLISH_MODE;
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

/// The writer and the reader of one topic in this process. Either may be missing.
template <class M>
struct Ends {
  dds::DataWriter* writer = nullptr;
  dds::DataReader* reader = nullptr;
  /// Of the last written sample, for topics that keep all samples of a run, or of a mission.
  RunId run;
  std::uint32_t mission = 0;
  std::string map_id;  ///< map of the last written sample, for topics that keep all trees of a map
};

/// True if the message begins a new run (or mission, or map), so that the samples that the writer keeps for
/// late readers are no longer of use. They are then dropped, because processes and runs may live for months.
template <class M>
bool outdates(const M& message, Ends<M>& ends) {
  if constexpr (std::is_same_v<M, InactiveTreesMessage>) {
    return std::exchange(ends.map_id, message.map_id) != message.map_id;
  } else if constexpr (std::is_same_v<M, RootNodes>) {
    const bool same_run = std::exchange(ends.run, message.run) == message.run;
    return std::exchange(ends.mission, message.mission) != message.mission || !same_run;
  } else if constexpr (std::is_same_v<M, TrackMessage>) {
    return std::exchange(ends.run, message.run) != message.run;
  } else {
    return false;
  }
}

}  // namespace

/// Whether an arriving sample ends a wait. Robot states arrive often, and are read once a control period.
template <class M>
constexpr bool wakes = Topic<M>::info.reliability == Reliability::reliable;

struct DdsBus::Implementation {
  Role role;
  ParticipantParts parts;
  Senders senders;
  Discoveries discoveries;
  dds::DomainParticipant* participant = nullptr;
  dds::Publisher* publisher = nullptr;
  dds::Subscriber* subscriber = nullptr;
  std::tuple<Ends<MapMessage>, Ends<Mission>, Ends<RootNodes>, Ends<InactiveTreesMessage>, Ends<RobotState>,
             Ends<JointPlanMessage>, Ends<ReservationMessage>, Ends<PathMessage>, Ends<TrackMessage>,
             Ends<AgentStatus>, Ends<BrokerStatus>, Ends<Claim>, Ends<Assignment>, Ends<ActiveTreesMessage>,
             Ends<ServiceStatus>, Ends<OrderMessage>, Ends<OrderStatus>, Ends<HaltMessage>>
      topics;
  dds::WaitSet wait_set;
  struct Received {
    Arrival arrival;
    eprosima::fastrtps::rtps::GuidPrefix_t from;
    std::string_view topic;
    std::chrono::steady_clock::time_point since{};  ///< when it was taken
  };
  std::vector<Received> held;  ///< from senders that are not known yet
  bool more = false;           ///< the last take left samples behind
  std::size_t rejected = 0;
  std::size_t lost = 0;

  Implementation(Role role_of_process, bool is_secure, const RobotName& robot)
      : role(role_of_process), parts(is_secure), discoveries(parts, senders, robot) {}

  /// Delegates to the constructor above, so that the destructor runs even if this one throws: DDS's threads
  /// use the members above.
  Implementation(const DdsSettings& settings, Role role_of_process, const std::string& sender)
      : Implementation(role_of_process, !settings.security.empty(), settings.robot) {
    if (!settings.security.empty()) check_credentials(settings.security, role);
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
    parts.announcements.begin();
  }

  ~Implementation() {
    if (participant == nullptr) return;
    const auto latest = std::chrono::steady_clock::now() + longest_farewell;
    std::apply([&](auto&... ends) { (wait_for_readers(ends, latest), ...); }, topics);
    std::apply([&](auto&... ends) { (detach(ends), ...); }, topics);
    participant->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant);
  }

  /// Creates the participant disabled. It is enabled when it is complete, so that the processes that it
  /// discovers need not be told of each endpoint separately.
  dds::DomainParticipant* disabled_participant(const DdsSettings& settings, const std::string& sender) {
    auto* const factory = dds::DomainParticipantFactory::get_instance();
    dds::DomainParticipantFactoryQos usual;
    factory->get_qos(usual);
    dds::DomainParticipantFactoryQos later = usual;
    later.entity_factory().autoenable_created_entities = false;
    factory->set_qos(later);
    auto* const created = factory->create_participant(static_cast<std::uint32_t>(settings.domain),
                                                      participant_qos(settings, role, sender, parts),
                                                      &discoveries, dds::StatusMask::none());
    factory->set_qos(usual);
    return required(created, "a participant (is the domain between 0 and 232?)");
  }

  template <class M>
  void open(Ends<M>& ends) {
    using T = Topic<M>;
    if (!T::written_by(role) && !T::read_by(role)) return;
    dds::TypeSupport type(new CheckedType<typename DdsType<M>::Support>());
    // No type information: Cyclone DDS 0.10 refuses an endpoint whose type information it cannot parse, and
    // it cannot parse Fast DDS's. No type objects: type objects alone keep Fast DDS 2.9's own endpoints from
    // matching. Endpoints match by topic name, type name and QoS.
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

  /// DDS reports a participant as enabled even if it refused one of its endpoints.
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
    // Bounded, because samples may arrive as fast as they are taken, and the role must get to run.
    for (int taken = 0;
         ends.reader->take_next_sample(&sample, &info) == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
         ++taken) {
      if (!info.valid_data) continue;
      Message message = from_dds(sample);
      if (const auto problem = problem_with(message)) {
        reject(Topic<M>::info.name, *problem);
      } else {
        const auto writer = eprosima::fastrtps::rtps::iHandle2GUID(info.publication_handle);
        hand_over({arrival_of(std::move(message), seconds(info.reception_timestamp),
                              seconds(info.source_timestamp)),
                   writer.guidPrefix, Topic<M>::info.name, std::chrono::steady_clock::now()},
                  out);
      }
      if (taken < most_taken) continue;
      more = true;
      return;
    }
  }

  /// Hands over a sample that comes from the robot that it names. A sample whose sender is not known yet is
  /// held back: with static discovery, endpoints are matched just before their participant is reported.
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
      reject(received.topic, "its sender is not the agent of the robot that it names");
    }
  }

  /// Observers and viewers receive a recording. A replayer notices other replayers and ignores its own
  /// samples. All other roles refuse a recording.
  void hand_over_replayed(Received received, std::vector<Arrival>& out) {
    const bool own = received.from == participant->guid().guidPrefix;
    const bool looks_on = role == Role::observer || role == Role::viewer || role == Role::dispatcher;
    if (looks_on || (role == Role::replayer && !own)) {
      out.push_back(std::move(received.arrival));
    } else if (role != Role::replayer) {
      reject(received.topic, "it belongs to a recording that is replayed on this domain");
    }
  }

  /// Hands over the samples that were held back, if their senders are known by now.
  void hand_over_held(std::vector<Arrival>& out) {
    const auto now = std::chrono::steady_clock::now();
    for (Received& received : std::exchange(held, {})) {
      if (!senders.robot_of(received.from) && now - received.since > longest_held) {
        reject(received.topic, "its sender is not known");
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
        if (outgoing.agents) limit.emplace(implementation_->parts.recipients, *outgoing.agents);
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
  implementation_->hand_over_held(out);
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
template std::size_t DdsBus::matched_readers<InactiveTreesMessage>() const;

bool DdsBus::hears_replay() const {
  return implementation_->senders.somebody_replays();
}

/// An agent's writer is matched with its own reader, too, which does not count.
BusCounts DdsBus::counts() const {
  return {.rejected = rejected(),
          .agents = std::max<std::size_t>(1, matched_readers<RobotState>()) - 1,
          .bytes_sent = implementation_->parts.traffic.bytes_sent,
          .bytes_received = implementation_->parts.traffic.bytes_received,
          .processor_seconds = static_cast<double>(std::clock()) / CLOCKS_PER_SEC};
}

}  // namespace coppice
