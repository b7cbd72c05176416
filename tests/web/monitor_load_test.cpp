// Tests of what monitors cost. In the first, 200 robots send their positions 20 times a second, and a page
// looks on; this fleet is simulated without a bus (docs/metrics.md tells the cost of the bus). In the second,
// ten monitors come and go while a fleet drives.
//
// CTest: RUN_SERIAL

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <thread>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "files/report_file.h"
#include "monitor/monitor.h"
#include "runtime/process.h"
#include "tests/domains.h"
#include "tests/processes.h"
#include "tests/support.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;

constexpr int robots = 200;
constexpr double period = 1.0 / 20;

/// Processor seconds of this thread.
double processor_seconds() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double resident_megabytes() {
  std::ifstream file("/proc/self/statm");
  double total = 0;
  double resident = 0;
  file >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

std::string name(int robot) {
  return "r" + std::to_string(robot + 1);
}

Point2 place(int robot, double time) {
  return Point2(20 + 2 * robot, 250) + 15 * Point2(std::cos(time + robot), std::sin(time + robot));
}

/// Map, missions, paths, a forest of 50 x 2000 nodes, and root trees of 200 nodes.
std::vector<Arrival> beginning(WallTime now) {
  std::vector<Arrival> all;
  MapMessage map{"m", {.width = 512, .height = 512}};
  map.map.blocked.assign(512 * 512, 0);
  all.push_back(arrival_of(map, now));
  for (int robot = 0; robot < robots; ++robot) {
    all.push_back(arrival_of(Mission{.robot = name(robot),
                                     .number = 1,
                                     .map_id = "m",
                                     .radius = 2,
                                     .max_speed = 20,
                                     .clock = {.epoch = now}},
                             now));
    PathMessage path{name(robot), 1, {}};
    RootNodes nodes{.robot = name(robot), .mission = 1};
    for (int k = 0; k < 200; ++k) nodes.nodes.push_back({Root::start, Point2(robot, k), k - 1});
    for (int k = 0; k < 20; ++k) path.waypoints.emplace_back(robot, 20 * k);
    all.push_back(arrival_of(path, now));
    all.push_back(arrival_of(nodes, now));
  }
  for (std::uint32_t number = 0; number < 50; ++number) {
    InactiveTreesMessage tree{.id = {1, number}, .map_id = "m", .radius = 2};
    for (int k = 0; k < 2000; ++k) tree.nodes.push_back({Point2(number, 0.2 * k), k - 1, 5});
    all.push_back(arrival_of(tree, now));
  }
  return all;
}

/// The messages of a robot in a period; once a second with its status.
void say(std::vector<Arrival>& all, int robot, std::uint32_t step, double time, WallTime now) {
  all.push_back(arrival_of(
      RobotState{.robot = name(robot),
                 .sequence = step,
                 .promise = {.stamp = time,
                             .position = place(robot, time),
                             .velocity = (place(robot, time + period) - place(robot, time)) / period,
                             .decision_time = time + period,
                             .expiry = time + 2 * period},
                 .radius = 2,
                 .phase = Phase::driving},
      now));
  if (step % 20 != static_cast<std::uint32_t>(robot % 20)) return;
  all.push_back(arrival_of(AgentStatus{.robot = name(robot),
                                       .mission = 1,
                                       .phase = Phase::driving,
                                       .driven_length = time,
                                       .load = {.periods = step}},
                           now));
}

/// A client that reads all that arrives as fast as it arrives.
class Onlooker {
 public:
  Onlooker(const std::string& url, const std::string& handshake)
      : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1))));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(write(socket_, handshake.data(), handshake.size()), std::ssize(handshake));
    thread_ = std::thread([this] {
      std::array<char, 1 << 16> buffer{};
      for (ssize_t size = 0; (size = read(socket_, buffer.data(), buffer.size())) > 0;) bytes_ += size;
    });
  }
  ~Onlooker() {
    shutdown(socket_, SHUT_RDWR);
    thread_.join();
    close(socket_);
  }
  Onlooker(const Onlooker&) = delete;
  Onlooker& operator=(const Onlooker&) = delete;
  void say(const std::string& bytes) const {
    EXPECT_EQ(write(socket_, bytes.data(), bytes.size()), std::ssize(bytes));
  }
  double bytes() const { return static_cast<double>(bytes_); }

 private:
  int socket_;
  std::atomic<ssize_t> bytes_ = 0;
  std::thread thread_;
};

std::string handshake(const std::string& path, const std::string& more) {
  return "GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n" +
         more + "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
}

/// A text message from a client, with a mask of zeros (RFC 6455, 5.2).
std::string frame(const std::string& text) {
  std::string bytes{'\x81', static_cast<char>(0x80 | 126), static_cast<char>(text.size() >> 8),
                    static_cast<char>(text.size() & 0xff)};
  return bytes + std::string(4, '\0') + text;
}

struct Cost {
  double of_one_core;
  double megabytes_a_second;
};

struct MonitorLoadTest : testing::Test {
  Monitor monitor{{.port = 0}, "a made-up fleet"};
  WallTime began = DisciplinedClock::read().system;
  std::uint32_t step = 0;

  MonitorLoadTest() { monitor.take(beginning(began)); }

  Cost run(double seconds, const Onlooker& onlooker) {
    const double before = processor_seconds();
    const double had = onlooker.bytes();
    const WallTime start = DisciplinedClock::read().system;
    double making = 0;  // time to make the messages, which is no cost of a monitor
    while (DisciplinedClock::read().system < start + seconds) {
      const WallTime now = DisciplinedClock::read().system;
      const double made_from = processor_seconds();
      std::vector<Arrival> arrivals;
      while (step * period < now - began) {
        for (int robot = 0; robot < robots; ++robot) say(arrivals, robot, step, step * period, now);
        ++step;
      }
      making += processor_seconds() - made_from;
      monitor.take(arrivals);
      monitor.turn(now, now, 0.01);
    }
    const double took = DisciplinedClock::read().system - start;
    return {(processor_seconds() - before - making) / took, (onlooker.bytes() - had) / took / 1e6};
  }
};

TEST_F(MonitorLoadTest, TwoHundredRobotsTakeLessThanAThirdOfACore) {
  if (!test::wants_long_tests()) GTEST_SKIP() << test::why_not_long;
  const Onlooker page(monitor.url(), handshake("/live", ""));
  run(2, page);
  const Cost with_page = run(10, page);
  const double memory = resident_megabytes();
  std::cout << "with a page: " << 100 * with_page.of_one_core << " % of a core, "
            << with_page.megabytes_a_second << " MB/s, " << memory << " MB of memory\n";
  EXPECT_LT(with_page.of_one_core, 0.3);
  EXPECT_GT(with_page.megabytes_a_second, 0.1) << "the page received nothing";
  EXPECT_LT(memory, 200);

  const Onlooker foxglove(monitor.url(), handshake("/", "Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n"));
  run(0.5, foxglove);
  std::string wishes = R"({"op":"subscribe","subscriptions":[)";
  for (int channel = 1; channel <= 9; ++channel)
    wishes += (channel > 1 ? "," : "") + ("{\"id\":" + std::to_string(channel)) +
              ",\"channelId\":" + std::to_string(channel) + "}";
  foxglove.say(frame(wishes + "]}"));
  run(2, foxglove);
  const Cost with_both = run(10, foxglove);
  std::cout << "with Foxglove on all topics, too: " << 100 * with_both.of_one_core << " % of a core, "
            << with_both.megabytes_a_second << " MB/s to it, " << resident_megabytes() << " MB of memory\n";
  EXPECT_GT(with_both.megabytes_a_second, 0.1) << "Foxglove received nothing";
  EXPECT_LT(resident_megabytes(), 200);
}

/// The largest share of missed control periods among the robots of a fleet that drives for half a minute.
/// `meanwhile` is called while it drives.
double worst_share_missed(const std::filesystem::path& folder, int of_domain,
                          const std::function<void()>& meanwhile) {
  const std::string report = (folder / "report.json").string();
  test::Background run(
      {test::program("coppice"), "run", (test::scenarios() / "rooms-20.json").string(), "--domain",
       std::to_string(of_domain), "--quiet", "--time-scale", "1", "--lifelong", "30", "--report", report},
      folder / "run.log");
  std::this_thread::sleep_for(10s);
  meanwhile();
  EXPECT_EQ(run.wait(), 0) << test::contents(folder / "run.log");
  double worst = 0;
  const proto::Report said = read_report(report);
  for (const auto& robot : said.robots()) {
    EXPECT_GT(robot.load().periods(), 500U);
    worst = std::max(worst, static_cast<double>(robot.load().periods_missed()) / robot.load().periods());
  }
  return worst;
}

TEST(MonitorsOfAFleet, TenCostNoRobotItsDeadlines) {
  if (!test::wants_long_tests()) GTEST_SKIP() << test::why_not_long;
  const test::TemporaryFolder folder;
  const double alone = worst_share_missed(folder.path(), test::own_domain(), [] {});
  const double watched = worst_share_missed(folder.path(), test::own_domain(1), [&] {
    for (int round = 0; round < 3; ++round) {
      std::vector<std::unique_ptr<test::Background>> ten;
      for (int k = 0; k < 10; ++k)
        ten.push_back(std::make_unique<test::Background>(
            std::vector<std::string>{test::program("coppice"), "monitor", "--port", "0", "--domain",
                                     test::domain_name(1)},
            folder.path() / fmt::format("monitor{}.log", k)));
      std::this_thread::sleep_for(4s);
      for (const auto& watcher : ten) {
        watcher->send(SIGTERM);
        EXPECT_EQ(watcher->wait(), 0);
      }
    }
  });
  std::cout << fmt::format("worst robot, control periods missed: {:.2f} % alone, {:.2f} % watched\n",
                           100 * alone, 100 * watched);
  EXPECT_LE(watched, alone + 0.01);
}

}  // namespace
}  // namespace coppice
