// What a machine needs for a fleet, and whether it has it: the judging part of `coppice doctor`. What was
// found on the machine goes in, a verdict on each point comes out.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dds/datagram.h"
#include "dds/discovery.h"

namespace coppice {

/// What is asked of the machine.
struct FleetPlan {
  int robots = 8;
  int domain = 0;
  std::string discovery{};  ///< as for DdsSettings; empty: by multicast
};

/// A limit of the system; none: there is none, or it cannot be read.
using SystemLimit = std::optional<std::uint64_t>;

struct NetworkInterface {
  std::string name;
  bool multicast_works = false;  ///< a datagram sent on it to a group came back to a member on it
};

/// What was found. Bytes and seconds.
struct Machine {
  std::string versions;
  double cores = 1;
  SystemLimit memory_available{};
  std::uint64_t receive_buffer = 0;  ///< what a socket is granted that asks for wanted_receive_buffer
  SystemLimit open_files{};          ///< of one process
  SystemLimit open_files_left{};     ///< of the whole system
  SystemLimit threads_left{};        ///< of this user and system
  bool loopback_works = false;       ///< a datagram to 127.0.0.1 arrived
  ServerExamination servers{};       ///< if the plan names any
  std::vector<NetworkInterface> interfaces{};  ///< those that are up and say that they can multicast
  int free_ports = 0;                          ///< pairs, of those that participants of the domain may take
  bool domain_in_use = false;                  ///< somebody has joined it already
  int first_ephemeral_port = 32768;            ///< those from here on the system hands out to anybody
  bool clock_synchronised = false;
  double clock_jump =
      0;  ///< between the clock that can be set and the one that cannot, while it was looked at
};

enum class Verdict : unsigned char { ok, warn, fail };

struct Finding {
  std::string check;
  Verdict verdict = Verdict::ok;
  std::string found;
  std::string advice{};  ///< what to change; empty if it is ok
};

/// One finding a check, always the same checks in the same order.
std::vector<Finding> diagnose(const Machine& machine, const FleetPlan& plan);

/// 1 if a finding is a failure.
int exit_code(const std::vector<Finding>& findings);
std::string table_of(const std::vector<Finding>& findings);

}  // namespace coppice
