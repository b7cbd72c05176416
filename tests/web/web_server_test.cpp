// Tests of the web server's limits, with small values: clients that do not read, clients that do not ask, and
// too many clients.
//
// CTest: PARALLEL

#include "monitor/server/web_server.h"

#include <gtest/gtest.h>

#include "coppice/files/input_error.h"
#include "tests/processes.h"
#include "tests/web/client.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;
using test::Client;

struct WebServerTest : testing::Test {
  int asked = 0;

  std::unique_ptr<WebServer> server(const WebLimits& limits, std::size_t size = 1000) {
    return std::make_unique<WebServer>(
        WebSettings{.port = 0, .limits = limits},
        WebHandlers{.get =
                        [](std::string_view) {
                          return WebReply{"text/plain", "here"};
                        },
                    .talk =
                        [this, size](Channel) {
                          return WebTalk{.next =
                                             [this, size] {
                                               ++asked;
                                               return std::vector{
                                                   Outbound{std::make_shared<const std::string>(size, 'x')}};
                                             },
                                         .heard = [](std::string_view, bool) { return true; }};
                        }});
  }
};

template <class Condition>
bool serves_until(WebServer& server, Condition condition) {
  return test::within(10s, [&] {
    server.serve(0.01);
    return condition();
  });
}

constexpr const char* request = "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n";

TEST_F(WebServerTest, AClientThatDoesNotReadIsCutOffAndDelaysNobody) {
  const auto served = server({.blocked_seconds = 1}, 16 << 20);
  const Client slow(served->port());
  slow.ask_for_web_socket();
  ASSERT_TRUE(serves_until(*served, [&] { return served->web_sockets() == 1 && asked == 1; }));
  const Client other(served->port());
  other.say(request);
  EXPECT_TRUE(serves_until(*served, [&] { return other.heard().ends_with("here"); }));
  EXPECT_EQ(served->web_sockets(), 1u);
  EXPECT_TRUE(serves_until(*served, [&] { return served->web_sockets() == 0; }));
  EXPECT_EQ(asked, 1) << "no frame is made for a client that does not read";
}

TEST_F(WebServerTest, AClientThatReadsIsServedAgainAtEachTurn) {
  const auto served = server({});
  const Client reader(served->port());
  reader.ask_for_web_socket();
  std::size_t heard = 0;
  EXPECT_TRUE(serves_until(*served, [&] { return (heard += reader.heard().size()) > 20'000; }));
  EXPECT_GE(served->bytes_sent(), 19'000u);
}

TEST_F(WebServerTest, AClientThatSendsNoRequestIsDisconnected) {
  const auto served = server({.request_seconds = 0.2});
  const Client silent(served->port());
  const Client halting(served->port());
  halting.say("GET / HTTP/1.1\r\nHo");
  EXPECT_TRUE(serves_until(*served, [&] { return silent.is_closed() && halting.is_closed(); }));
}

TEST_F(WebServerTest, AClientBeyondTheLimitIsRefused) {
  const auto served = server({.connections = 2});
  const Client one(served->port());
  const Client two(served->port());
  for (int turn = 0; turn < 10; ++turn) served->serve(0.01);
  EXPECT_FALSE(one.is_closed() || two.is_closed());
  {
    const Client three(served->port());
    EXPECT_TRUE(serves_until(*served, [&] { return three.is_closed(); }));
  }
  one.say("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n");
  EXPECT_TRUE(serves_until(*served, [&] { return one.is_closed(); }));
  const Client four(served->port());
  four.say(request);
  EXPECT_TRUE(serves_until(*served, [&] { return four.heard().ends_with("here"); })) << "there is room again";
}

TEST_F(WebServerTest, AServerThatEndsClosesItsConnections) {
  auto served = server({}, 16 << 20);
  const Client talks(served->port());
  const Client asks(served->port());
  talks.ask_for_web_socket();
  ASSERT_TRUE(serves_until(*served, [&] { return asked == 1; }));
  served.reset();
  EXPECT_TRUE(test::within(1s, [&] { return asks.is_closed(); }));
}

TEST_F(WebServerTest, InvalidAddressesAreRefused) {
  EXPECT_THROW(WebServer({.address = "localhost"}, {}), InputError);
  EXPECT_THROW(WebServer({.address = "192.0.2.1", .port = 0}, {}), InputError)
      << "no address of this machine";
}

}  // namespace
}  // namespace coppice
