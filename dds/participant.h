// How a process takes part in DDS: how it finds others and is found, and what it records of each participant
// that it discovers.
#pragma once

#include <string>

#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include "dds/dds_bus.h"
#include "dds/senders.h"
#include "dds/transport.h"

namespace coppice {

/// The way of discovery, or the servers, that the settings ask for; else the default
/// (DdsSettings::discovery).
std::string discovery_of(const DdsSettings& settings);

/// What the transport of a participant needs, and what outlives the participant.
struct ParticipantParts {
  /// `is_secure`: with DDS-Security.
  explicit ParticipantParts(bool is_secure) : recipients(is_secure), whereabouts(networks, is_secure) {}

  Recipients recipients;  ///< where each process can be reached; with security, each authenticated process
  Announcements announcements{};
  Traffic traffic{};
  OwnNetworks networks{};
  Whereabouts whereabouts;
};

/// `parts` must outlive the participant. Throws std::runtime_error if the settings
/// contradict each other, name no discovery servers, or need a multicast port that another program has.
eprosima::fastdds::dds::DomainParticipantQos participant_qos(const DdsSettings& settings, Role role,
                                                             const std::string& sender,
                                                             ParticipantParts& parts);

/// Passes on discovered participants to Recipients and Whereabouts (addresses) and Senders (names of robots).
class Discoveries final : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  /// `robot`: the robot whose agent this process is; empty for other processes.
  Discoveries(ParticipantParts& parts, Senders& senders, RobotName robot)
      : parts_(parts), senders_(senders), robot_(std::move(robot)) {}
  void on_participant_discovery(eprosima::fastdds::dds::DomainParticipant*,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override {
    parts_.recipients.discover(info);
    parts_.whereabouts.discover(info);
    senders_.discover(info);
    if (info.status == info.DISCOVERED_PARTICIPANT) look_for_a_double(info.info.m_guid.guidPrefix);
    if (info.status == info.REMOVED_PARTICIPANT || info.status == info.DROPPED_PARTICIPANT)
      parts_.announcements.forget(info.info.m_guid.guidPrefix);
  }
  void onParticipantAuthentication(eprosima::fastdds::dds::DomainParticipant*,
                                   eprosima::fastrtps::rtps::ParticipantAuthenticationInfo&& info) override {
    if (info.status == info.AUTHORIZED_PARTICIPANT) parts_.recipients.authenticate(info.guid);
  }

 private:
  void look_for_a_double(const eprosima::fastrtps::rtps::GuidPrefix_t& participant) const;

  ParticipantParts& parts_;
  Senders& senders_;
  RobotName robot_;
};

}  // namespace coppice
