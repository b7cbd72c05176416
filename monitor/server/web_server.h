// Serves a page, other HTTP resources, an HTTP API and WebSockets on one port: HTTP/1.1 (RFC 9112) and
// WebSocket (RFC 6455) by Boost.Beast, in the caller's thread.
//
// http_session.h answers requests; web_socket_session.h and event_stream.h are connections that last.
// web_rules.h decides which clients may connect. WebLimits bounds everything that a client could make large.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "monitor/server/web_rules.h"
#include "monitor/view/outbound.h"

namespace coppice {

struct WebLimits {
  std::size_t connections = 64;    ///< at a time; further ones are closed
  std::uint32_t header = 8 << 10;  ///< bytes of a request's line and headers
  std::size_t body = 64 << 10;     ///< bytes of the body of a request to the API; others have none
  std::size_t frame = 64 << 10;    ///< bytes of a WebSocket message from a client
  double request_seconds = 10;     ///< until a request is complete
  double idle_seconds = 60;        ///< of a client that neither sends nor answers pings
  double blocked_seconds = 20;     ///< of a client that does not take its messages
  int send_buffer = 256 << 10;     ///< bytes in the kernel, which a slow client receives late
};

struct WebSettings {
  std::string address = "127.0.0.1";   ///< IP address of this machine to listen at
  std::uint16_t port = 8090;           ///< 0: any free port
  bool else_any_port = false;          ///< if `port` is taken
  std::vector<std::string> origins{};  ///< further origins of pages that may connect as Foxglove
  ProxyOrigins proxies{};              ///< origins at which proxies serve the page
  std::string token{};                 ///< that requests to the API show; empty: there is no API
  WebLimits limits{};
};

struct WebReply {
  std::string type;
  std::string body;
  unsigned status = 200;
  std::vector<std::pair<std::string, std::string>> headers{};  ///< further ones, by name
};

/// A request to the API that is allowed (api_access). The views hold during the call.
struct WebRequest {
  std::string_view method;
  std::string_view path;
  std::string_view query;
  std::string_view body;
  std::string_view client;  ///< the address that it came from
};

/// The reply comes later.
struct WebWait {
  /// Asked at each turn until it returns the reply.
  std::function<std::optional<WebReply>()> poll;
};

/// The reply does not end: server-sent events (HTML standard, 9.2).
struct WebStream {
  /// Returns the next bytes, if any. Called again when these are sent.
  std::function<std::string()> next;
};

using WebAnswer = std::variant<WebReply, WebWait, WebStream>;

/// The server's end of a WebSocket.
struct WebTalk {
  /// Returns the next messages. Called again when these are sent.
  std::function<std::vector<Outbound>()> next;
  /// Handles a received message. False: the message is invalid, and the connection is closed.
  std::function<bool(std::string_view message, bool text)> heard;
};

struct WebHandlers {
  std::function<std::optional<WebReply>(std::string_view path)> get;  ///< nothing: there is no such path
  std::function<WebTalk(Channel)> talk;
  std::function<WebAnswer(const WebRequest&)> api{};  ///< needed if there is a token
};

class WebServer {
 public:
  /// Listens. Throws InputError if it cannot listen at this address.
  WebServer(const WebSettings& settings, WebHandlers handlers);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  std::uint16_t port() const;
  std::string url() const;
  std::size_t web_sockets() const;       ///< number of open ones, with event streams
  std::uint64_t bytes_sent() const;      ///< over these
  std::uint64_t refused_logins() const;  ///< requests to the API with a wrong token
  bool owes_replies() const;             ///< requests wait for a reply that comes later

  /// Serves for `seconds`, after asking every open WebSocket for its next messages. Returns at once when a
  /// request is to be answered later, so that its caller may act on it.
  void serve(double seconds);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace coppice
