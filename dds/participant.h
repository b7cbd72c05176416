// How a process takes part in DDS: by which ways it finds others and is found, and what it notes of those
// that it discovers.
#pragma once

#include <string>

#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include "dds/dds_bus.h"
#include "dds/senders.h"
#include "dds/transport.h"

namespace coppice {

/// What is asked for, or what suits: a way of discovery.h, or servers.
std::string discovery_of(const DdsSettings& settings);

/// The last three must outlive the participant. Throws std::runtime_error if the settings do not go together,
/// or name no discovery servers.
eprosima::fastdds::dds::DomainParticipantQos participant_qos(const DdsSettings& settings, Role role,
                                                             const std::string& sender, Recipients& recipients,
                                                             Announcements& announcements, Traffic& traffic);

/// Tells the recipients who is where, and the senders who is who.
class Discoveries final : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  /// `robot`: whose agent this process is; empty: nobody's.
  Discoveries(Recipients& recipients, Senders& senders, Announcements& announcements, RobotName robot)
      : recipients_(recipients), senders_(senders), announcements_(announcements), robot_(std::move(robot)) {}
  void on_participant_discovery(eprosima::fastdds::dds::DomainParticipant*,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override {
    recipients_.discover(info);
    senders_.discover(info);
    if (info.status == info.DISCOVERED_PARTICIPANT) look_for_a_double(info.info.m_guid.guidPrefix);
    if (info.status == info.REMOVED_PARTICIPANT || info.status == info.DROPPED_PARTICIPANT)
      announcements_.forget(info.info.m_guid.guidPrefix);
  }
  void onParticipantAuthentication(eprosima::fastdds::dds::DomainParticipant*,
                                   eprosima::fastrtps::rtps::ParticipantAuthenticationInfo&& info) override {
    if (info.status == info.AUTHORIZED_PARTICIPANT) recipients_.authenticate(info.guid);
  }

 private:
  void look_for_a_double(const eprosima::fastrtps::rtps::GuidPrefix_t& participant) const;

  Recipients& recipients_;
  Senders& senders_;
  Announcements& announcements_;
  RobotName robot_;
};

}  // namespace coppice
