// The page of a real monitor, of a fleet that drives and of a recording of one, used as a person uses it: by
// Debian's chromium, which playwright-core drives. Says so where they are missing.
//
// COPPICE_PAGE_SHOTS: a folder in which the screenshots stay.

#include <cstdlib>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/processes.h"
#include "tests/support.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;

constexpr int domain = 156;

std::filesystem::path web() {
  return std::filesystem::path(COPPICE_SOURCE_DIR) / "tests/web";
}

struct Page : testing::Test {
  void SetUp() override {
    const bool there = test::shell("command -v node && command -v chromium").exit_code == 0 &&
                       std::filesystem::exists(web() / "node_modules/playwright-core");
    if (!there) GTEST_SKIP() << "needs node, chromium, and `npm ci` in tests/web";
  }

  std::filesystem::path path(const std::string& name) const { return folder.path() / name; }
  std::unique_ptr<test::Background> start(std::vector<std::string> arguments, const std::string& log) const {
    arguments.insert(arguments.begin(), test::program("coppice"));
    return std::make_unique<test::Background>(arguments, path(log));
  }
  /// The monitor's first line.
  std::string url() const {
    const auto line = [&] {
      const std::string said = test::contents(path("monitor.log"));
      return said.starts_with("http://") ? said.substr(0, said.find('\n')) : std::string();
    };
    EXPECT_TRUE(test::within(20s, [&] { return !line().empty(); })) << test::contents(path("monitor.log"));
    return line();
  }
  void use_page(const std::string& of_what) const {
    const char* const kept = std::getenv("COPPICE_PAGE_SHOTS");
    const std::string shots = kept != nullptr ? std::string(kept) + "/" + of_what : path("shots").string();
    const test::Outcome outcome = test::shell(
        fmt::format("COPPICE_PAGE_URL={} COPPICE_PAGE_SHOTS='{}' node '{}/page/page.spec.mjs' 2>&1", url(),
                    shots, web().string()));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output << test::contents(path("monitor.log"));
    EXPECT_TRUE(std::filesystem::exists(shots + "/light.png"));
  }

  test::TemporaryFolder folder;
};

TEST_F(Page, ShowsAFleetThatDrives) {
  const auto monitor = start({"monitor", "--domain", std::to_string(domain), "--port", "0"}, "monitor.log");
  const auto run = start({"run", (test::scenarios() / "rooms-20.json").string(), "--domain",
                          std::to_string(domain), "--quiet", "--time-scale", "1", "--lifelong", "200"},
                         "run.log");
  use_page("fleet");
  EXPECT_FALSE(test::has_ended(run->pid()))
      << "the fleet drove all the time: " << test::contents(path("run.log"));
  run->send(SIGINT);
  run->wait();
}

TEST_F(Page, ShowsARecording) {
  const std::string file = path("fleet.mcap").string();
  EXPECT_EQ(
      start({"run", (test::scenarios() / "rooms-8.json").string(), "--domain", std::to_string(domain + 1),
             "--quiet", "--time-scale", "1", "--lifelong", "15", "--record", file},
            "run.log")
          ->wait(),
      0)
      << test::contents(path("run.log"));
  const auto monitor = start({"monitor", file, "--port", "0"}, "monitor.log");
  const test::Outcome outcome = test::shell(
      fmt::format("COPPICE_PAGE_URL={} node '{}/page/recording.spec.mjs' 2>&1", url(), web().string()));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output << test::contents(path("monitor.log"));
}

}  // namespace
}  // namespace coppice
