// Tests of what deploy/ holds for operations. The compose file is valid, and its fleet runs with each
// container as a host of its own on a network without multicast. The Kubernetes manifest and the systemd
// units are valid.
//
// CTest: RESOURCE_LOCK hosts

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "files/report_file.h"
#include "tests/support.h"

namespace coppice {
namespace {

const std::filesystem::path deploy = std::filesystem::path(COPPICE_SOURCE_DIR) / "deploy";

TEST(Deploy, TheComposeFileIsValid) {
  const test::Outcome outcome =
      test::shell("docker-compose -f '" + (deploy / "docker-compose.yml").string() + "' config --quiet");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
}

TEST(Deploy, TheComposeFileOfAStandingFleetIsValid) {
  const test::Outcome outcome =
      test::shell("docker-compose -f '" + (deploy / "docker-compose.yml").string() + "' -f '" +
                  (deploy / "docker-compose.standing.yml").string() + "' config");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("--serve"), std::string::npos) << outcome.output;
  EXPECT_NE(outcome.output.find("--control"), std::string::npos) << outcome.output;
}

TEST(Deploy, TheKubernetesManifestsFitThePrograms) {
  const std::filesystem::path check = std::filesystem::path(COPPICE_SOURCE_DIR) / "tests/network/manifest.py";
  for (const char* manifest : {"kubernetes.yaml", "kubernetes-standing.yaml"}) {
    const test::Outcome outcome = test::shell("/usr/bin/python3 '" + check.string() + "' '" +
                                              (deploy / manifest).string() + "' '" + COPPICE_BIN_DIR + "'");
    EXPECT_EQ(outcome.exit_code, 0) << manifest;
    EXPECT_EQ(outcome.output, "") << manifest;
  }
}

/// With the programs of this build on this machine's root file system; COPPICE_IMAGE_ROOT names the root of
/// an image instead.
TEST(Deploy, TheComposedFleetDrivesWithoutMulticast) {
#ifdef _GLIBCXX_TSAN
  GTEST_SKIP() << "containers do not load what the thread sanitizer needs (tests/tsan)";
#endif
  const std::string namespaces = test::shell("ip netns list | sort").output;
  const test::TemporaryFolder folder;
  const char* const image = std::getenv("COPPICE_IMAGE_ROOT");
  const std::string source = image != nullptr ? "--root '" + std::string(image) + "'"
                                              : "--programs '" + std::string(COPPICE_BIN_DIR) + "'";
  const test::Outcome outcome =
      test::shell("TIME_SCALE=10 '" + (deploy / "replay").string() + "' " + source + " --out '" +
                  folder.path().string() + "' --scale agent=8 --kill discovery@4 --timeout 120");
  if (outcome.exit_code == 77) GTEST_SKIP() << outcome.output;
  const std::filesystem::path logs = folder.path() / "logs";
  std::string said = outcome.output;
  for (const char* container : {"service", "broker", "discovery", "agent-1"})
    said += std::string("--- ") + container + "\n" + test::contents(logs / (std::string(container) + ".log"));
  ASSERT_EQ(outcome.exit_code, 0) << said;
  for (const char* service : {"discovery", "broker", "agent", "service"})
    EXPECT_NE(outcome.output.find(std::string(service) + " is healthy"), std::string::npos) << said;
  const proto::Report report = read_report(folder.path() / "report.json");
  EXPECT_EQ(report.outcome(), "arrived");
  EXPECT_EQ(report.robots_size(), 8);
  EXPECT_EQ(report.collisions(), 0u);
  EXPECT_GT(report.trees_published(), 0u) << "the broker took part";
  EXPECT_NE(outcome.output.find("discovery is killed"), std::string::npos) << said;
  // While the discovery server is gone, the service finds no agents and may warn of that.
  const test::Outcome warnings =
      test::shell("grep warning '" + (logs / "service.log").string() + "' | grep -v 'no agent has come'");
  EXPECT_EQ(warnings.output, "") << said;
  EXPECT_EQ(test::shell("ip netns list | sort").output, namespaces) << "namespaces are left";
}

TEST(Deploy, TheSystemdUnitsAreValid) {
  const test::TemporaryFolder folder;
  int units = 0;
  for (const auto& unit : std::filesystem::directory_iterator(deploy / "systemd")) {
    if (unit.path().extension() == ".cmake") continue;
    std::string text = test::contents(unit.path());
    const std::string installed = "/usr/local/bin/";
    for (std::size_t at = text.find(installed); at != std::string::npos; at = text.find(installed, at + 1))
      text.replace(at, installed.size(), std::string(COPPICE_BIN_DIR) + "/");
    const std::filesystem::path copy = folder.write(unit.path().filename().string(), text);
    const test::Outcome outcome = test::shell("systemd-analyze verify '" + copy.string() + "'");
    EXPECT_EQ(outcome.exit_code, 0) << unit.path() << ": " << outcome.output;
    EXPECT_EQ(outcome.output, "") << unit.path();
    ++units;
  }
  EXPECT_GE(units, 5);
}

// At boot the network may not be ready. That ends a program just as a wrong option does.
TEST(Deploy, UnitsOfABootAreAlwaysRestarted) {
  int units = 0;
  for (const auto& unit : std::filesystem::directory_iterator(deploy / "systemd")) {
    const std::string text = test::contents(unit.path());
    if (text.find("WantedBy=") == std::string::npos) continue;
    for (const char* setting : {"\nRestart=on-failure\n", "\nRestartSec=5\n", "\nStartLimitIntervalSec=0\n"})
      EXPECT_NE(text.find(setting), std::string::npos) << unit.path() << setting;
    EXPECT_EQ(text.find("RestartPreventExitStatus"), std::string::npos) << unit.path();
    ++units;
  }
  EXPECT_EQ(units, 4);
}

}  // namespace
}  // namespace coppice
