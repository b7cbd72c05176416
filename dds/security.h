// DDS-Security for a participant: it proves its identity, may only do what its permissions say, and encrypts
// its messages.
//
// It needs one folder, with the file names of ROS 2 (SROS 2). deploy/security/make-keys makes one for each
// role:
//   identity_ca.cert.pem     certificate of the authority that signs identities
//   cert.pem, key.pem        this participant's identity, and its private key (not encrypted)
//   permissions_ca.cert.pem  certificate of the authority that signs the next two documents
//   governance.p7s           what is protected, and how
//   permissions.p7s          what this participant may write and read
//   identity_crl.pem         revoked identities; may be missing
#pragma once

#include <string>

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include "messages/bus.h"

namespace coppice {

/// Throws std::runtime_error with the file's name if a file cannot be read, is not valid now, does not belong
/// to the other files, or lacks a topic that the role writes or reads. Fast DDS itself reports less, and only
/// to its log.
void check_credentials(const std::string& folder, Role role);

/// Sets up a participant with the folder's credentials.
void secure(const std::string& folder, eprosima::fastdds::dds::DomainParticipantQos& qos);

}  // namespace coppice
