#include "coppice/run/diagnosis.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "coppice/run/time_scale.h"
#include "dds/discovery.h"

namespace coppice {

namespace {

// Needs of one process, measured, with a margin (docs/performance.md).
constexpr std::uint64_t memory_a_process = 32ull << 20;
constexpr std::uint64_t files_a_process = 32;
constexpr std::uint64_t threads_a_process = 10;
constexpr int other_processes = 4;       // broker, service, discovery server, command
constexpr double worth_telling = 0.005;  // seconds by which a clock must jump to be reported

using Check = Finding (*)(const Machine&, const FleetPlan&);

std::uint64_t processes(const FleetPlan& plan) {
  return static_cast<std::uint64_t>(plan.robots + other_processes);
}

std::string mebibytes(std::uint64_t bytes) {
  return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1 << 20));
}

std::string number(const SystemLimit& limit) {
  return limit ? std::to_string(*limit) : "no limit";
}

bool allows(const SystemLimit& limit, std::uint64_t needed) {
  return !limit || *limit >= needed;
}

Finding versions(const Machine& m, const FleetPlan&) {
  return {"versions", Verdict::ok, m.versions};
}

Finding cores(const Machine& m, const FleetPlan& plan) {
  Finding finding{"cores", Verdict::ok, fmt::format("{:g}", m.cores)};
  if (plan.robots > robots_a_core * m.cores) {
    finding.verdict = Verdict::warn;
    finding.advice = fmt::format("slow fleet time down: --time-scale {:.2g}",
                                 usual_time_scale(static_cast<std::size_t>(plan.robots), m.cores));
  }
  return finding;
}

Finding memory(const Machine& m, const FleetPlan& plan) {
  const std::uint64_t needed = processes(plan) * memory_a_process;
  if (!m.memory_available) return {"memory", Verdict::warn, "cannot be read", "mount /proc"};
  Finding finding{"memory", Verdict::ok,
                  fmt::format("{} available, {} needed", mebibytes(*m.memory_available), mebibytes(needed))};
  if (*m.memory_available < needed) {
    finding.verdict = Verdict::fail;
    finding.advice = "fewer robots on this machine, or a higher memory limit";
  }
  return finding;
}

Finding receive_buffer(const Machine& m, const FleetPlan& plan) {
  Finding finding{
      "UDP receive buffer", Verdict::ok,
      fmt::format("{} of {} granted", mebibytes(m.receive_buffer), mebibytes(wanted_receive_buffer))};
  if (m.receive_buffer < wanted_receive_buffer && plan.robots >= large_fleet) {
    finding.verdict = Verdict::warn;
    finding.advice = fmt::format("sysctl -w net.core.rmem_max={}", wanted_receive_buffer);
  }
  return finding;
}

Finding open_files(const Machine& m, const FleetPlan& plan) {
  Finding finding{
      "open files", Verdict::ok,
      fmt::format("{} per process, {} left in all", number(m.open_files), number(m.open_files_left))};
  if (!allows(m.open_files, files_a_process)) {
    finding.verdict = Verdict::fail;
    finding.advice = "ulimit -n 1024";
  } else if (!allows(m.open_files_left, processes(plan) * files_a_process)) {
    finding.verdict = Verdict::fail;
    finding.advice = fmt::format("raise sysctl fs.file-max by {}", processes(plan) * files_a_process);
  }
  return finding;
}

Finding threads(const Machine& m, const FleetPlan& plan) {
  const std::uint64_t needed = processes(plan) * threads_a_process;
  Finding finding{"threads", Verdict::ok, fmt::format("{} left, {} needed", number(m.threads_left), needed)};
  if (!allows(m.threads_left, needed)) {
    finding.verdict = Verdict::fail;
    finding.advice = "raise the limit: ulimit -u, the container's pids limit, or sysctl kernel.threads-max";
  }
  return finding;
}

Finding loopback(const Machine& m, const FleetPlan&) {
  if (m.loopback_works) return {"loopback", Verdict::ok, "a datagram to 127.0.0.1 arrived"};
  return {"loopback", Verdict::fail, "no datagram arrives at 127.0.0.1", "ip link set lo up"};
}

Finding discovery(const Machine& m, const FleetPlan& plan) {
  if (!are_servers(plan.discovery))
    return {"discovery", Verdict::ok, plan.discovery.empty() ? multicast_discovery : plan.discovery};
  if (m.servers.are_usable && m.servers.unknown.empty())
    return {"discovery", Verdict::ok, "through " + plan.discovery};
  if (m.servers.are_usable)
    return {"discovery", Verdict::warn,
            fmt::format("of \"{}\", these have no address: {}", plan.discovery,
                        fmt::join(m.servers.unknown, ", ")),
            "start them, or correct their names: processes that start now continue without them"};
  return {"discovery", Verdict::fail, fmt::format("\"{}\" names no discovery servers", plan.discovery),
          fmt::format("--discovery or ROS_DISCOVERY_SERVER: {}", discovery_rule)};
}

Finding multicast(const Machine& m, const FleetPlan& plan) {
  std::string working;
  std::string silent;
  for (const NetworkInterface& interface : m.interfaces) {
    std::string& names = interface.multicast_works ? working : silent;
    names += (names.empty() ? "" : ", ") + interface.name;
  }
  Finding finding{"multicast", Verdict::ok, working.empty() ? "on no interface" : "on " + working};
  if (!silent.empty()) finding.found += ", not on " + silent;
  if (are_servers(plan.discovery)) {
    finding.found += "; not needed with discovery servers";
  } else if (working.empty()) {
    finding.verdict = Verdict::fail;
    finding.advice =
        "ip route add 224.0.0.0/4 dev INTERFACE; or coppice discovery, and --discovery HOST:PORT";
  } else if (!silent.empty()) {
    finding.verdict = Verdict::warn;
    finding.advice =
        "a fleet that has to cross " + silent + " needs coppice discovery, and --discovery HOST:PORT";
  }
  return finding;
}

Finding ports(const Machine& m, const FleetPlan& plan) {
  const int needed = plan.robots + other_processes;
  Finding finding{"ports of the domain", Verdict::ok,
                  fmt::format("{} free for participants, {} needed", m.free_ports, needed)};
  if (m.free_ports < needed) {
    finding.verdict = Verdict::fail;
    finding.advice = "use another --domain, below 100 for many robots, or stop the processes on this one";
  } else if (m.domain_in_use) {
    finding.verdict = Verdict::warn;
    finding.found += "; the domain is in use";
    finding.advice = "use another --domain, unless this is your fleet";
  } else if (participant_port(plan.domain, needed) >= m.first_ephemeral_port) {
    finding.verdict = Verdict::warn;
    finding.found +=
        fmt::format("; the system gives ports from {} on to any program", m.first_ephemeral_port);
    const int room = m.first_ephemeral_port - participant_port(0, needed);
    finding.advice = room > 0 ? fmt::format("use a --domain of at most {}", room / 250)
                              : "sysctl -w net.ipv4.ip_local_port_range=\"32768 60999\"";
  }
  return finding;
}

Finding clock(const Machine& m, const FleetPlan&) {
  Finding finding{"clock", Verdict::ok, m.clock_synchronised ? "synchronised" : "not synchronised"};
  if (std::abs(m.clock_jump) > worth_telling) {
    finding.verdict = Verdict::warn;
    finding.found += fmt::format(", jumped by {:.3f} s during the check", m.clock_jump);
    finding.advice = "let one program set the clock, and slew it instead of stepping";
  } else if (!m.clock_synchronised) {
    finding.verdict = Verdict::warn;
    finding.advice = "for a fleet on several hosts: apt install chrony (or systemd-timesyncd)";
  }
  return finding;
}

Finding shared_memory(const Machine&, const FleetPlan&) {
  return {"shared memory", Verdict::ok, "not used: /dev/shm may be of any size"};
}

constexpr std::array<Check, 12> checks{versions,   cores,   memory,   receive_buffer,
                                       open_files, threads, loopback, discovery,
                                       multicast,  ports,   clock,    shared_memory};

const char* text(Verdict verdict) {
  switch (verdict) {
    case Verdict::ok:
      return "ok";
    case Verdict::warn:
      return "warn";
    case Verdict::fail:
      break;
  }
  return "FAIL";
}

}  // namespace

std::vector<Finding> diagnose(const Machine& machine, const FleetPlan& plan) {
  std::vector<Finding> findings;
  for (const Check check : checks) findings.push_back(check(machine, plan));
  return findings;
}

int exit_code(const std::vector<Finding>& findings) {
  return std::ranges::count(findings, Verdict::fail, &Finding::verdict) > 0 ? 1 : 0;
}

std::string table_of(const std::vector<Finding>& findings) {
  std::string table;
  for (const Finding& f : findings) {
    table += fmt::format("{:<4}  {:<20} {}\n", text(f.verdict), f.check, f.found);
    if (!f.advice.empty()) table += fmt::format("{:<27}-> {}\n", "", f.advice);
  }
  return table;
}

}  // namespace coppice
