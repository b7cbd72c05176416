// Tests of the web server's limits, with small values: clients that do not read, clients that do not ask, and
// too many clients.
//
// CTest: PARALLEL

#include "monitor/web_server.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "coppice/files/input_error.h"
#include "tests/processes.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;

class Client {
 public:
  explicit Client(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  ~Client() { close(socket_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void say(const std::string& bytes) const {
    EXPECT_EQ(send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL), std::ssize(bytes));
  }
  void ask_for_web_socket() const {
    say("GET /live HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
  }
  /// What has arrived so far.
  std::string heard() const {
    std::string all(1 << 16, '\0');
    const ssize_t size = recv(socket_, all.data(), all.size(), MSG_DONTWAIT);
    all.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return all;
  }
  bool is_closed() const {
    pollfd look{.fd = socket_, .events = POLLRDHUP};
    return poll(&look, 1, 0) == 1 && (look.revents & (POLLRDHUP | POLLHUP | POLLERR)) != 0;
  }

 private:
  int socket_;
};

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
