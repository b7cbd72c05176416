// Tests of the monitor's API over HTTP: what it refuses, and what it answers. A small service that is no
// fleet answers the orders, except in the last tests, which have a real fleet. They need curl.
//
// CTest: PARALLEL

#include <future>
#include <regex>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "monitor/monitor.h"
#include "tests/domains.h"
#include "tests/processes.h"
#include "tests/support.h"
#include "tests/web/client.h"
#include "tests/web/packages.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;

constexpr const char* token = "0123456789abcdef";
constexpr const char* fine = "Authorization: Bearer 0123456789abcdef\r\n";
constexpr const char* to_1_2 = R"({"goal": {"x": 1, "y": 2}})";

/// A request that is the last one of its connection.
std::string request(const std::string& method, const std::string& path, const std::string& headers = fine,
                    const std::string& body = "") {
  return fmt::format(
      "{} {} HTTP/1.1\r\nHost: 127.0.0.1:8090\r\nConnection: close\r\nContent-Length: {}\r\n{}\r\n{}", method,
      path, body.size(), headers, body);
}

struct HttpApiTest : testing::Test {
  std::unique_ptr<Monitor> monitor = monitor_with({.port = 0, .token = token});
  WallTime now = 1000;
  std::string refuses = "";  ///< the reason for which the service refuses all orders
  std::string no_room = "";  ///< why it cannot save orders, as it says of itself
  bool is_silent = false;    ///< the service

  static std::unique_ptr<Monitor> monitor_with(const WebSettings& settings) {
    return std::make_unique<Monitor>(settings, "nowhere", false, [] { return std::string("drawn"); });
  }
  void turn() {
    now += 0.05;  // waits are short
    if (!no_room.empty())
      monitor->take({arrival_of(ServiceStatus{.service = 1, .run = {1}, .problem = no_room}, now)});
    monitor->turn(now, now, 0.01);
    for (const OrderMessage& order : monitor->take_orders()) {
      if (!is_silent) answer(order);
    }
  }
  void answer(const OrderMessage& order) {
    const bool fails = !refuses.empty();
    monitor->take({arrival_of(OrderStatus{.order = order,
                                          .state = fails ? OrderState::failed : OrderState::accepted,
                                          .reason = refuses,
                                          .accepted_at = now,
                                          .ended_at = fails ? now : 0},
                              now)});
  }
  /// What this returns, which asks the monitor.
  template <class Ask>
  auto served(Ask&& ask, int most_turns) {
    auto answer = std::async(std::launch::async, std::forward<Ask>(ask));
    for (int turns = 0; turns < most_turns && answer.wait_for(0s) != std::future_status::ready; ++turns)
      turn();
    return answer.get();
  }
  /// The whole answer to these bytes.
  std::string ask(const std::string& bytes) {
    return served([&] { return test::Client(monitor->port()).ask(bytes); }, 1000);
  }
  int status(const std::string& bytes) {
    const std::string answer = ask(bytes);
    return answer.starts_with("HTTP/1.1 ") ? std::stoi(answer.substr(9, 3)) : 0;
  }
};

testing::AssertionResult has(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << '"' << part << "\" is not in: " << text;
}

TEST_F(HttpApiTest, ARequestNeedsTheToken) {
  for (const char* headers :
       {"", "Authorization: Bearer 0123456789abcdeg\r\n", "Authorization: Basic x\r\n"}) {
    const std::string answer = ask(request("POST", "/api/orders", headers, to_1_2));
    EXPECT_TRUE(has(answer, "HTTP/1.1 401 Unauthorized\r\n"));
    EXPECT_TRUE(has(answer, "WWW-Authenticate: Bearer\r\n"));
    EXPECT_TRUE(has(answer, "Content-Type: application/problem+json\r\n"));
  }
  EXPECT_EQ(status(request("GET", "/api/nothing", "")), 401) << "nothing is told without a token";
}

TEST_F(HttpApiTest, WrongTokensAreLimitedAndAnOperatorIsHeardAllTheSame) {
  const auto wrong = [&](int k) {
    return ask(request("GET", "/api/robots", fmt::format("Authorization: Bearer wrong{:011}\r\n", k)));
  };
  EXPECT_EQ(status(request("POST", "/api/stop")), 200) << "an operator at this address";
  for (int k = 0; k < 10; ++k) EXPECT_TRUE(has(wrong(k), "HTTP/1.1 401 ")) << k;
  for (int k = 10; k < 30; ++k) {
    const std::string answer = wrong(k);
    EXPECT_TRUE(has(answer, "HTTP/1.1 429 Too Many Requests\r\n"));
    EXPECT_TRUE(std::regex_search(answer, std::regex("Retry-After: [1-6]\r\n"))) << answer;
    EXPECT_TRUE(has(answer, R"("detail":"Too many wrong tokens from 127.0.0.1: wait )"));
  }
  EXPECT_EQ(status(request("POST", "/api/stop")), 200) << "STOP does not wait for others' mistakes";
  EXPECT_EQ(status(request("GET", "/api/robots", "")), 401) << "a request without a token is no guess";
  EXPECT_TRUE(has(ask("GET /metrics HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n"),
                  "coppice_monitor_refused_logins_total 30\n"));
}

TEST_F(HttpApiTest, AGuessThatIsRightIsNotTold) {
  for (int k = 0; k < 10; ++k)
    EXPECT_EQ(status(request("GET", "/api/robots", "Authorization: Bearer wrong\r\n")), 401);
  EXPECT_EQ(status(request("GET", "/api/robots")), 429)
      << "nobody at this address has shown the token before";
}

TEST_F(HttpApiTest, AProxyOnThisMachineSaysForWhomItAsks) {
  const auto wrong_from = [&](const std::string& address) {
    return request("GET", "/api/robots",
                   "Authorization: Bearer wrong\r\nX-Forwarded-For: 10.0.0.1, " + address + "\r\n");
  };
  monitor = monitor_with({.port = 0, .proxies = {"https://fleet.example"}, .token = token});
  for (int k = 0; k < 10; ++k) EXPECT_EQ(status(wrong_from("192.0.2.7")), 401);
  EXPECT_EQ(status(wrong_from("192.0.2.7")), 429);
  EXPECT_EQ(status(wrong_from("192.0.2.8")), 401);
  monitor = monitor_with({.port = 0, .token = token});
  for (int k = 0; k < 10; ++k) EXPECT_EQ(status(wrong_from(fmt::format("192.0.2.{}", k))), 401);
  EXPECT_EQ(status(wrong_from("192.0.2.99")), 429) << "without a proxy, anybody may have written the header";
}

TEST_F(HttpApiTest, PagesOfOtherSitesAreRefused) {
  const std::string token_and_origin = std::string(fine) + "Origin: ";
  EXPECT_EQ(status(request("POST", "/api/stop", token_and_origin + "https://evil.example\r\n")), 403);
  EXPECT_EQ(status(request("POST", "/api/stop", token_and_origin + "http://127.0.0.1:8090\r\n")), 200);
  EXPECT_EQ(status("POST /api/stop HTTP/1.1\r\nHost: evil.example\r\nConnection: close\r\n" +
                   std::string(fine) + "\r\n"),
            421);
}

TEST_F(HttpApiTest, AnOrderIsAnsweredWhenTheServiceHasTakenIt) {
  const std::string answer = ask(request("POST", "/api/orders", fine, to_1_2));
  EXPECT_TRUE(has(answer, "HTTP/1.1 201 Created\r\n"));
  EXPECT_TRUE(has(answer, "Location: /api/orders/drawn\r\n"));
  EXPECT_TRUE(has(answer, "Content-Type: application/json\r\n"));
  EXPECT_TRUE(has(answer, R"({"id":"drawn","action":"go","state":"accepted")"));
  EXPECT_TRUE(has(ask(request("GET", "/api/orders/drawn")), R"({"id":"drawn")"));
  EXPECT_TRUE(has(ask(request("GET", "/api/orders?state=accepted")), R"({"orders":[{"id":"drawn")"));
  EXPECT_TRUE(has(ask(request("GET", "/api/robots")), R"({"robots":[]})"));
}

TEST_F(HttpApiTest, RefusalsAreTold) {
  refuses = "(1, 2) is in an obstacle";
  const std::string answer = ask(request("POST", "/api/orders", fine, to_1_2));
  EXPECT_TRUE(has(answer, "HTTP/1.1 422 "));
  EXPECT_TRUE(has(answer, R"("detail":"(1, 2) is in an obstacle")"));
  const std::string malformed = ask(request("POST", "/api/orders", fine, "{\n\"goal\": {\"x\": 1,}}"));
  EXPECT_TRUE(has(malformed, "HTTP/1.1 400 "));
  EXPECT_TRUE(has(malformed, "body:2: goal.x: a comma before }, expected none"));
  EXPECT_TRUE(has(ask(request("PUT", "/api/orders")), "Allow: GET, POST\r\n"));
}

TEST_F(HttpApiTest, AServiceThatSaysNothingIsTold) {
  is_silent = true;
  EXPECT_EQ(status(request("POST", "/api/orders", fine, to_1_2)), 504);
}

TEST_F(HttpApiTest, ABodyThatIsTooLargeIsRefusedHoweverItIsSent) {
  const std::string large(10 << 20, ' ');
  EXPECT_EQ(status(request("POST", "/api/orders", fine, large)), 413);
  EXPECT_EQ(status(request("POST", "/api/orders", "", large)), 401);
  EXPECT_EQ(status(request("POST", "/api/orders", fine, std::string((64 << 10) + 1, ' '))), 413);
  EXPECT_EQ(status(request("POST", "/api/orders", fine, std::string(64 << 10, ' '))), 400);
  EXPECT_EQ(status(fmt::format(
                "POST /api/orders HTTP/1.1\r\nHost: 127.0.0.1\r\nTransfer-Encoding: chunked\r\n{}\r\n"
                "a00000\r\n{}\r\n0\r\n\r\n",
                fine, large)),
            413);
  EXPECT_EQ(status(request("POST", "/", "", large)), 413);
}

TEST_F(HttpApiTest, AConnectionServesOneRequestAfterTheOther) {
  std::string first = request("POST", "/api/orders", fine, to_1_2);
  first.replace(first.find("Connection: close\r\n"), 19, "Expect: 100-continue\r\n");
  const std::string answers = ask(first + request("GET", "/api/orders"));
  EXPECT_TRUE(answers.starts_with("HTTP/1.1 100 Continue\r\n\r\nHTTP/1.1 201 Created\r\n")) << answers;
  EXPECT_TRUE(has(answers, R"({"orders":[{"id":"drawn")"));
}

TEST_F(HttpApiTest, WithoutATokenThereIsNoApi) {
  monitor = monitor_with({.port = 0});
  for (const char* path : {"/api", "/api/orders", "/api/stop"}) {
    EXPECT_EQ(status(request("POST", path)), 404) << path;
    EXPECT_EQ(status(request("GET", path, "Authorization: Bearer \r\n")), 404) << path;
  }
}

TEST_F(HttpApiTest, EventsArriveAsTheyHappen) {
  const test::Client client(monitor->port());
  client.say(request("GET", "/api/events"));
  std::string heard;
  const auto hears = [&](const std::string& part) {
    return test::within(10s, [&] {
      turn();
      heard += client.heard();
      return heard.find(part) != std::string::npos;
    });
  };
  EXPECT_TRUE(hears("event: halt\ndata: {\"everybody\":\"none\"")) << heard;
  EXPECT_TRUE(has(heard, "Content-Type: text/event-stream\r\n"));
  EXPECT_EQ(status(request("POST", "/api/orders", fine, to_1_2)), 201);
  EXPECT_TRUE(hears("event: order\ndata: {\"id\":\"drawn\"")) << heard;
}

TEST_F(HttpApiTest, AClientThatDoesNotReadItsEventsIsCutOff) {
  monitor = monitor_with({.port = 0, .token = token, .limits = {.blocked_seconds = 1}});
  for (int k = 0; k < 1000; ++k) {
    answer({.id = fmt::format("a{}", k), .visits = std::vector<Visit>(200, Visit{.position = {1.25, 2.5}})});
  }
  const test::Client slow(monitor->port());
  slow.say(request("GET", "/api/events"));
  EXPECT_TRUE(test::within(10s, [&] { return turn(), monitor->is_watched(); }));
  EXPECT_EQ(status(request("GET", "/api/robots")), 200) << "others are served";
  EXPECT_TRUE(test::within(10s, [&] { return turn(), !monitor->is_watched(); }));
}

struct ServedFleetTest : testing::Test {
  test::TemporaryFolder folder;

  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
  std::string said(const std::string& name) const { return test::contents(path(name)); }
  std::string url() const {
    const std::string text = said("monitor.log");
    return text.substr(0, text.find('\n'));
  }
  test::Outcome curl(const std::string& options) const {
    return test::shell(
        fmt::format("curl -s -w ' %{{http_code}}' -H 'Authorization: Bearer {}' {}", token, options));
  }
  std::string post(const std::string& what, const std::string& body) const {
    return curl(fmt::format("'{}api/{}' -d '{}'", url(), what, body)).output;
  }
  std::string get(const std::string& what) const { return curl("'" + url() + "api/" + what + "'").output; }
  /// Most bytes in memory that a process has had so far.
  static long most_memory(pid_t process) {
    const std::string status = test::contents(fmt::format("/proc/{}/status", process));
    return std::stol(status.substr(status.find("VmHWM:") + 6)) << 10;
  }
  /// A scenario whose robots have no goals.
  std::string site() const {
    const std::string with_goals = test::contents(test::scenarios() / "rooms-8.json");
    folder.write("site.json", std::regex_replace(with_goals, std::regex(R"("goal": \{[^}]*\},)"), ""));
    return path("site.json");
  }
};

TEST_F(ServedFleetTest, AFleetObeysOrdersOverHttp) {
  folder.write("token", std::string(token) + "\n");
  const test::Background fleet(
      {test::program("coppice"), "serve", site(), "--map", (test::scenarios() / "rooms-8.map").string(),
       "--robots", "4", "--time-scale", "4", "--quiet", "--domain", test::domain_name()},
      path("serve.log"));
  const test::Background monitor({test::program("coppice"), "monitor", "--domain", test::domain_name(),
                                  "--port", "0", "--control", "--token-file", path("token")},
                                 path("monitor.log"));
  ASSERT_TRUE(test::within(20s, [&] { return said("monitor.log").starts_with("http://"); }));
  const std::string order = R"({"id": "mine", "robot": "r2", "goal": {"x": 428, "y": 300}, "by": "a test"})";
  const std::string first = [&] {
    std::string answer;
    test::within(60s, [&] { return (answer = post("orders", order)).ends_with("201"); });
    return answer;
  }();
  ASSERT_TRUE(first.ends_with(" 201") || first.ends_with(" 200")) << first << said("serve.log");
  EXPECT_TRUE(post("orders", order).ends_with(" 200"));
  EXPECT_TRUE(has(said("monitor.log"), "a test at 127.0.0.1: send r2 to (428, 300) as order mine"));

  EXPECT_TRUE(has(post("orders", R"({"goal": {"x": 0.5, "y": 0.5}})"), "is in an obstacle"));
  EXPECT_TRUE(has(post("orders", R"({"robot": "r9", "goal": {"x": 428, "y": 300}})"),
                  R"("detail":"r9 is no robot of this fleet"} 422)"));
  EXPECT_TRUE(has(post("stop", R"({"robots": ["r9"]})"), "422"));
  const long before = most_memory(monitor.pid());
  folder.write("large", std::string(10 << 20, ' '));
  EXPECT_TRUE(
      has(curl(fmt::format("-H Expect: '{}api/orders' --data-binary @'{}'", url(), path("large"))).output,
          "413"));
  EXPECT_LT(most_memory(monitor.pid()), before + (4 << 20));

  EXPECT_TRUE(post("stop", "").ends_with(" 200"));
  EXPECT_TRUE(test::within(10s, [&] {
    return get("robots").find(R"("phase":"halted")") != std::string::npos;
  })) << get("robots");
  EXPECT_TRUE(has(get("robots"), R"("halt":"stopped")"));
  EXPECT_TRUE(post("release", R"({"robots": ["r1", "r2", "r3", "r4"]})").ends_with(" 200"));
  EXPECT_TRUE(test::within(60s, [&] {
    return get("orders/mine").find(R"("state":"done","robot":"r2")") != std::string::npos;
  })) << get("orders/mine");
  EXPECT_TRUE(
      has(curl("-X DELETE " + url() + "api/orders/mine").output, "order mine has ended already: done"));
  post("orders", R"({"id": "next", "robot": "r2", "goal": {"x": 428, "y": 360}})");
  EXPECT_TRUE(
      has(curl("-X DELETE " + url() + "api/orders/next").output, R"("state":"cancelled","robot":"r2")"));
}

/// What a fleet that is well does not answer.
TEST_F(HttpApiTest, AnswersInTroubleFitTheDescriptionOfTheApi) {
  ASSERT_EQ(test::missing_packages(test::web_tests()), "");
  ASSERT_EQ(test::missing_packages(test::page_sources()), "");
  const auto expect_fit = [&](const std::string& trouble) {
    const std::string command =
        fmt::format("timeout 60 node '{}/refusals_fit.mjs' http://127.0.0.1:{}/ {} {}",
                    test::web_tests().string(), monitor->port(), token, trouble);
    const test::Outcome outcome = served([&] { return test::shell(command); }, 10'000);
    EXPECT_EQ(outcome.exit_code, 0) << trouble << ": " << outcome.output;
  };
  refuses = no_room = std::string(cannot_be_saved) + "the disk of /var/lib/hall is full";
  expect_fit("full");
  monitor = monitor_with({.port = 0, .token = token});
  no_room = "";
  is_silent = true;
  expect_fit("silent");
  monitor = monitor_with({.port = 0});
  expect_fit("absent");
}

/// The page's types are made from the same description.
TEST_F(ServedFleetTest, RealAnswersFitTheDescriptionOfTheApi) {
  ASSERT_EQ(test::missing_packages(test::web_tests()), "");
  ASSERT_EQ(test::missing_packages(test::page_sources()), "");
  folder.write("token", token);
  const test::Background fleet(
      {test::program("coppice"), "serve", site(), "--map", (test::scenarios() / "rooms-8.map").string(),
       "--robots", "4", "--time-scale", "4", "--quiet", "--domain", test::domain_name()},
      path("serve.log"));
  const test::Background monitor({test::program("coppice"), "monitor", "--domain", test::domain_name(),
                                  "--port", "0", "--control", "--token-file", path("token")},
                                 path("monitor.log"));
  ASSERT_TRUE(test::within(20s, [&] { return said("monitor.log").starts_with("http://"); }));
  const test::Outcome outcome = test::shell(fmt::format("timeout 200 node '{}/answers_fit.mjs' '{}' {} 2>&1",
                                                        test::web_tests().string(), url(), token));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output << said("monitor.log") << said("serve.log");
}

TEST_F(ServedFleetTest, ControlNeedsATokenThatIsHardToGuess) {
  const auto refusal = [&](const std::string& options) {
    return test::shell(fmt::format("timeout 20 '{}' monitor --domain {} --port 0 {} 2>&1",
                                   test::program("coppice"), test::own_domain(), options));
  };
  folder.write("short", "0123456789abcde\n0123456789abcdef\n");
  const std::string file = path("short");
  const test::Outcome outcome = refusal("--control --token-file '" + file + "'");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.output, file + ":1: expected a token of at least 16 characters, found 15\n");
  EXPECT_EQ(refusal("--control").exit_code, 2);
  EXPECT_EQ(refusal("--token-file '" + file + "'").exit_code, 2);
  EXPECT_EQ(refusal("fleet.mcap --control --token-file '" + file + "'").exit_code, 2);
  EXPECT_EQ(refusal("--control --token-file '" + path("none") + "'").exit_code, 2);
}

}  // namespace
}  // namespace coppice
