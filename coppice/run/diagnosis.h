// The part of `coppice doctor` that judges: takes the properties of a machine, and returns a verdict on each
// point that a fleet needs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dds/datagram.h"
#include "dds/discovery.h"

namespace coppice {

/// The fleet that the machine must run.
struct FleetPlan {
  int robots = 8;
  int domain = 0;
  std::string discovery{};  ///< as in DdsSettings; empty: multicast
};

/// A limit of the system; none: there is no limit, or it cannot be read.
using SystemLimit = std::optional<std::uint64_t>;

struct NetworkInterface {
  std::string name;
  bool multicast_works = false;  ///< a datagram to a group on this interface came back to a member
};

/// The properties of a machine. Bytes and seconds.
struct Machine {
  std::string versions;
  double cores = 1;
  SystemLimit memory_available{};
  std::uint64_t receive_buffer = 0;            ///< granted to a socket that requests wanted_receive_buffer
  SystemLimit open_files{};                    ///< for one process
  SystemLimit open_files_left{};               ///< for the whole system
  SystemLimit threads_left{};                  ///< for this user and system
  bool loopback_works = false;                 ///< a datagram to 127.0.0.1 arrived
  ServerExamination servers{};                 ///< if the plan names any
  std::vector<NetworkInterface> interfaces{};  ///< interfaces that are up and support multicast
  int free_ports = 0;                          ///< pairs of ports that participants of the domain may take
  bool domain_in_use = false;                  ///< a process has joined the domain
  int first_ephemeral_port = 32768;            ///< the system gives ports from this one on to any program
  bool clock_synchronised = false;
  double clock_jump = 0;  ///< of the settable clock against the steady one, during the check
};

enum class Verdict : unsigned char { ok, warn, fail };

struct Finding {
  std::string check;
  Verdict verdict = Verdict::ok;
  std::string found;
  std::string advice{};  ///< what to change; empty if it is ok
};

/// One finding for each check, always in the same order.
std::vector<Finding> diagnose(const Machine& machine, const FleetPlan& plan);

/// 1 if a check failed.
int exit_code(const std::vector<Finding>& findings);
std::string table_of(const std::vector<Finding>& findings);

}  // namespace coppice
