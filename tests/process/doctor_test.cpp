// Tests of `coppice doctor` on this machine, and on machines that lack something: limits and an empty network
// imitate them.
//
// CTest: PARALLEL

#include <cstdint>
#include <string>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "dds/discovery.h"
#include "tests/domains.h"
#include "tests/support.h"

namespace coppice {
namespace {

test::Outcome doctor(const std::string& before, const std::string& options) {
  return test::shell(before + "'" + test::program("coppice") + "' doctor " + options);
}

/// The row of a check, without its advice.
std::string row(const std::string& table, const std::string& check) {
  const std::size_t name = table.find("  " + check + " ");
  if (name == std::string::npos) return {};
  const std::size_t begin = table.rfind('\n', name) + 1;  // npos + 1 is 0
  return table.substr(begin, table.find('\n', name) - begin);
}

TEST(Doctor, TheDoctorExaminesThisMachineAndExitsWithItsWorstFinding) {
  const test::Outcome outcome = doctor("", "--robots 2 --domain " + test::domain_name());
  EXPECT_EQ(outcome.exit_code, outcome.output.find("FAIL") == std::string::npos ? 0 : 1) << outcome.output;
  for (const char* check :
       {"versions", "cores", "memory", "UDP receive buffer", "open files", "threads", "loopback", "discovery",
        "multicast", "ports of the domain", "clock", "shared memory"}) {
    EXPECT_FALSE(row(outcome.output, check).empty()) << check << "\n" << outcome.output;
  }
  EXPECT_TRUE(row(outcome.output, "loopback").starts_with("ok"))
      << outcome.output;  // every test here needs it
  EXPECT_NE(row(outcome.output, "versions").find(COPPICE_VERSION ", Fast DDS 2."), std::string::npos);
}

TEST(Doctor, TooFewOpenFilesAreAFailure) {
  const test::Outcome outcome = doctor("ulimit -n 24; ", "--domain " + test::domain_name());
  EXPECT_EQ(outcome.exit_code, 1) << outcome.output;
  EXPECT_TRUE(row(outcome.output, "open files").starts_with("FAIL")) << outcome.output;
}

TEST(Doctor, MoreRobotsThanADomainHasPortsAreAFailure) {
  const test::Outcome outcome = doctor("", "--robots 2000 --domain " + test::domain_name());
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(row(outcome.output, "ports of the domain").starts_with("FAIL")) << outcome.output;
}

TEST(Doctor, ADomainInUseIsDetected) {
  EXPECT_EQ(row(doctor("", "--domain " + test::domain_name()).output, "ports of the domain").find("in use"),
            std::string::npos);
  const int somebody = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(domain_port(test::own_domain())));
  ASSERT_EQ(bind(somebody, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  const std::string ports = row(doctor("", "--domain " + test::domain_name()).output, "ports of the domain");
  close(somebody);
  EXPECT_NE(ports.find("in use"), std::string::npos) << ports;
}

TEST(Doctor, AHostWithoutANetworkNeedsLoopbackAndADiscoveryServer) {
  if (test::shell("unshare --net true").exit_code != 0)
    GTEST_SKIP() << "no right to make a network namespace";
  const test::Outcome bare = doctor("unshare --net ", "--domain " + test::domain_name());
  EXPECT_EQ(bare.exit_code, 1);
  EXPECT_TRUE(row(bare.output, "loopback").starts_with("FAIL")) << bare.output;
  EXPECT_TRUE(row(bare.output, "multicast").starts_with("FAIL")) << bare.output;
  const std::string up = "unshare --net sh -c 'ip link set lo up; exec \"$0\" \"$@\"' ";
  const test::Outcome served =
      doctor(up, "--robots 2 --domain " + test::domain_name() + " --discovery 127.0.0.1:11811");
  EXPECT_TRUE(row(served.output, "loopback").starts_with("ok")) << served.output;
  EXPECT_TRUE(row(served.output, "multicast").starts_with("ok")) << served.output;
  const test::Outcome by_environment =
      doctor("ROS_DISCOVERY_SERVER=127.0.0.1:11811 " + up, "--robots 2 --domain " + test::domain_name());
  EXPECT_TRUE(row(by_environment.output, "multicast").starts_with("ok")) << by_environment.output;
}

TEST(Doctor, DiscoveryServersMayOmitThePortButMustBeValid) {
  const std::string servers =
      row(doctor("ROS_DISCOVERY_SERVER=10.0.0.1 ", "--domain " + test::domain_name()).output, "multicast");
  EXPECT_TRUE(servers.ends_with("not needed with discovery servers")) << servers;
  const test::Outcome wrong =
      doctor("ROS_DISCOVERY_SERVER=10.0.0.1:99999 ", "--domain " + test::domain_name());
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_TRUE(row(wrong.output, "discovery").starts_with("FAIL")) << wrong.output;
  EXPECT_NE(row(wrong.output, "discovery").find("10.0.0.1:99999"), std::string::npos) << wrong.output;
}

TEST(Doctor, BadUsageIsRefused) {
  EXPECT_EQ(doctor("", "--robots 0").exit_code, 2);
  EXPECT_EQ(doctor("", "--domain 233").exit_code, 2);
}

}  // namespace
}  // namespace coppice
