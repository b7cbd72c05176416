// Serves a page, other HTTP resources and WebSockets on one port: HTTP/1.1 (RFC 9112) and WebSocket (RFC
// 6455) by Boost.Beast, in the caller's thread.
//
// web_rules.h decides which clients may connect. WebLimits bounds everything that a client could make large.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "monitor/outbound.h"
#include "monitor/web_rules.h"

namespace coppice {

struct WebLimits {
  std::size_t connections = 64;    ///< at a time; further ones are closed
  std::uint32_t header = 8 << 10;  ///< bytes of a request's line and headers; bodies are refused
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
  WebLimits limits{};
};

struct WebReply {
  std::string type;
  std::string body;
};

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
  std::size_t web_sockets() const;   ///< number of open ones
  std::uint64_t bytes_sent() const;  ///< over WebSockets

  /// Serves for `seconds`, after asking every open WebSocket for its next messages.
  void serve(double seconds);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace coppice
