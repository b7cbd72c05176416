// Tests of what `coppice doctor` reports for machines of several kinds.
#include "coppice/run/diagnosis.h"

#include <functional>

#include <gtest/gtest.h>

#include "coppice/run/time_scale.h"

namespace coppice {
namespace {

/// A machine that suits eight robots, without any fault.
Machine sound() {
  return {.versions = "1",
          .cores = 2,
          .memory_available = 8ull << 30,
          .receive_buffer = 4 << 20,
          .open_files = 1024,
          .open_files_left = 100'000,
          .threads_left = 10'000,
          .loopback_works = true,
          .interfaces = {{"lo", true}, {"eth0", true}},
          .free_ports = 100,
          .clock_synchronised = true};
}

Finding finding(const Machine& machine, const FleetPlan& plan, const std::string& check) {
  for (const Finding& f : diagnose(machine, plan)) {
    if (f.check == check) return f;
  }
  ADD_FAILURE() << "no check is called " << check;
  return {};
}

TEST(Diagnosis, AMachineWithoutFaultsPasses) {
  const auto findings = diagnose(sound(), {});
  for (const Finding& f : findings) {
    EXPECT_EQ(f.verdict, Verdict::ok) << f.check << ": " << f.found;
    EXPECT_TRUE(f.advice.empty()) << f.check;
  }
  EXPECT_EQ(exit_code(findings), 0);
}

TEST(Diagnosis, EachFaultFailsExactlyItsCheckAndComesWithAdvice) {
  struct Case {
    std::string check;
    Verdict verdict;
    std::function<void(Machine&, FleetPlan&)> spoil;
  };
  const std::vector<Case> cases{
      {"cores", Verdict::warn, [](Machine& m, FleetPlan& p) { m.cores = 0.3, p.robots = 9; }},
      {"memory", Verdict::fail, [](Machine& m, FleetPlan&) { m.memory_available = 100 << 20; }},
      {"memory", Verdict::warn, [](Machine& m, FleetPlan&) { m.memory_available.reset(); }},
      {"UDP receive buffer", Verdict::warn,
       [](Machine& m, FleetPlan& p) { m.receive_buffer = 212'992, p.robots = 40; }},
      {"open files", Verdict::fail, [](Machine& m, FleetPlan&) { m.open_files = 20; }},
      {"open files", Verdict::fail, [](Machine& m, FleetPlan&) { m.open_files_left = 200; }},
      {"threads", Verdict::fail, [](Machine& m, FleetPlan&) { m.threads_left = 100; }},
      {"loopback", Verdict::fail, [](Machine& m, FleetPlan&) { m.loopback_works = false; }},
      {"discovery", Verdict::fail, [](Machine&, FleetPlan& p) { p.discovery = "nonsense"; }},
      {"multicast", Verdict::fail, [](Machine& m, FleetPlan&) { m.interfaces.clear(); }},
      {"multicast", Verdict::fail,
       [](Machine& m, FleetPlan&) {
         for (auto& i : m.interfaces) i.multicast_works = false;
       }},
      {"multicast", Verdict::warn, [](Machine& m, FleetPlan&) { m.interfaces[1].multicast_works = false; }},
      {"ports of the domain", Verdict::fail, [](Machine& m, FleetPlan&) { m.free_ports = 9; }},
      {"ports of the domain", Verdict::warn, [](Machine& m, FleetPlan&) { m.domain_in_use = true; }},
      {"ports of the domain", Verdict::warn, [](Machine&, FleetPlan& p) { p.domain = 150; }},
      {"clock", Verdict::warn, [](Machine& m, FleetPlan&) { m.clock_synchronised = false; }},
      {"clock", Verdict::warn, [](Machine& m, FleetPlan&) { m.clock_jump = -0.2; }},
  };
  for (std::size_t k = 0; k < cases.size(); ++k) {
    Machine machine = sound();
    FleetPlan plan;
    cases[k].spoil(machine, plan);
    const auto findings = diagnose(machine, plan);
    for (const Finding& f : findings) {
      const bool spoilt = f.check == cases[k].check;
      EXPECT_EQ(f.verdict, spoilt ? cases[k].verdict : Verdict::ok)
          << k << ": " << f.check << ": " << f.found;
      EXPECT_EQ(f.advice.empty(), !spoilt) << k << ": " << f.check;
    }
    EXPECT_EQ(exit_code(findings), cases[k].verdict == Verdict::fail ? 1 : 0) << k;
  }
}

TEST(Diagnosis, DiscoveryServersNeedNoMulticast) {
  Machine machine = sound();
  machine.interfaces.clear();
  for (const char* servers : {"10.0.0.1:11811", "10.0.0.1", "10.0.0.1;10.0.0.2"})
    EXPECT_EQ(finding(machine, {.discovery = servers}, "multicast").verdict, Verdict::ok) << servers;
  for (const char* way : {"", "static", "multicast"})
    EXPECT_EQ(finding(machine, {.discovery = way}, "multicast").verdict, Verdict::fail) << way;
}

TEST(Diagnosis, AnUnknownDiscoveryServerIsNamedWithItsSource) {
  const Finding lost = finding(sound(), {.discovery = "nonsense"}, "discovery");
  EXPECT_NE(lost.found.find("\"nonsense\""), std::string::npos) << lost.found;
  EXPECT_NE(lost.advice.find("ROS_DISCOVERY_SERVER"), std::string::npos) << lost.advice;
  EXPECT_NE(lost.advice.find("HOST:PORT"), std::string::npos) << lost.advice;
  Machine machine = sound();
  machine.servers.are_usable = true;
  EXPECT_EQ(finding(machine, {.discovery = "here:11811"}, "discovery").verdict, Verdict::ok);
  machine.servers.unknown = {"there"};
  const Finding one = finding(machine, {.discovery = "here:11811;there"}, "discovery");
  EXPECT_EQ(one.verdict, Verdict::warn);
  EXPECT_NE(one.found.find("no address: there"), std::string::npos) << one.found;
}

TEST(Diagnosis, TheRequirementsGrowWithTheNumberOfRobots) {
  Machine machine = sound();
  machine.memory_available = 1ull << 30;
  machine.threads_left = 1000;
  EXPECT_EQ(exit_code(diagnose(machine, {.robots = 20})), 0);
  EXPECT_EQ(finding(machine, {.robots = 60}, "memory").verdict, Verdict::fail);
  EXPECT_EQ(finding(machine, {.robots = 200}, "threads").verdict, Verdict::fail);
  EXPECT_EQ(finding(machine, {.robots = 200}, "ports of the domain").verdict, Verdict::fail);
  machine.open_files_left.reset();
  machine.threads_left.reset();  // without a limit
  EXPECT_EQ(finding(machine, {.robots = 200}, "threads").verdict, Verdict::ok);
}

TEST(Diagnosis, TheAdvisedDomainPassesTheCheck) {
  for (const int robots : {1, 100, 900}) {
    Machine machine = sound();
    machine.free_ports = 2000;
    FleetPlan plan{.robots = robots, .domain = 200};
    const std::string advice = finding(machine, plan, "ports of the domain").advice;
    plan.domain = std::stoi(advice.substr(advice.rfind(' ')));
    EXPECT_EQ(finding(machine, plan, "ports of the domain").verdict, Verdict::ok) << robots << ": " << advice;
    ++plan.domain;
    EXPECT_EQ(finding(machine, plan, "ports of the domain").verdict, Verdict::warn)
        << robots << ": " << advice;
  }
}

TEST(Diagnosis, TheTableHasALineForEachCheckAndForEachAdvice) {
  Machine machine = sound();
  machine.loopback_works = false;
  const std::string table = table_of(diagnose(machine, {}));
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), static_cast<int>(diagnose(machine, {}).size()) + 1);
  EXPECT_NE(table.find("FAIL  loopback"), std::string::npos) << table;
  EXPECT_NE(table.find("-> ip link set lo up"), std::string::npos) << table;
}

TEST(TimeScale, TheDefaultTimeScaleFallsOnceTheProcessorsAreTooFew) {
  EXPECT_EQ(usual_time_scale(1, 2), 1);
  EXPECT_EQ(usual_time_scale(50, 2), 1);
  EXPECT_NEAR(usual_time_scale(200, 2), 0.125, 1e-12);
  EXPECT_NEAR(usual_time_scale(200, 8), 1, 1e-12);
  EXPECT_LT(usual_time_scale(100, 2), 0.5);
}

}  // namespace
}  // namespace coppice
