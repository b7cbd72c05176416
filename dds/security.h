// DDS-Security for a participant: it proves who it is, may do what its permissions say, and speaks in cipher.
//
// All that it needs is a folder, with the names that ROS 2 (SROS 2) uses; deploy/security/make-keys makes one
// for each role:
//   identity_ca.cert.pem     who vouches for identities
//   cert.pem, key.pem        this participant's identity, and its private key (not encrypted)
//   permissions_ca.cert.pem  who vouches for the two signed documents:
//   governance.p7s           what is protected, and how
//   permissions.p7s          what this participant may write and read
//   identity_crl.pem         identities that were taken back; may be missing
#pragma once

#include <string>

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include "messages/bus.h"

namespace coppice {

/// Throws std::runtime_error with the file's name if one cannot be read, is not valid (yet, or any more),
/// does not belong to the others, or lacks a topic that the role writes or reads: Fast DDS would say less of
/// it, and to its log only.
void check_credentials(const std::string& folder, Role role);

/// Sets up a participant with the folder's credentials.
void secure(const std::string& folder, eprosima::fastdds::dds::DomainParticipantQos& qos);

}  // namespace coppice
