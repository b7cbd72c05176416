// Serves a page, what programs ask for by HTTP, and WebSockets, on one port: HTTP/1.1 (RFC 9112) and
// WebSocket (RFC 6455) by Boost.Beast, in the caller's thread.
//
// Who may connect is for web_rules.h to say. Everything that a client may make large is bounded by WebLimits.
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
  std::size_t connections = 64;    ///< at a time; who comes then is turned away
  std::uint32_t header = 8 << 10;  ///< bytes of a request's line and headers; bodies are not taken
  std::size_t frame = 64 << 10;    ///< bytes of a WebSocket message from a client
  double request_seconds = 10;     ///< until a request is there
  double idle_seconds = 60;        ///< of a client that neither asks nor answers pings
  double blocked_seconds = 20;     ///< of one that does not take what it is sent
  int send_buffer = 256 << 10;     ///< bytes in the kernel: what a slow client gets late
};

struct WebSettings {
  std::string address = "127.0.0.1";   ///< IP address of this machine to listen at
  std::uint16_t port = 8090;           ///< 0: any that is free
  bool else_any_port = false;          ///< if that one is taken
  std::vector<std::string> origins{};  ///< of pages elsewhere that may connect as Foxglove
  WebLimits limits{};
};

struct WebReply {
  std::string type;
  std::string body;
};

/// This end of a WebSocket.
struct WebTalk {
  /// What to send next; asked again when that is sent.
  std::function<std::vector<Outbound>()> next;
  /// A message that came. False: it is nothing that a client says, and the connection is closed.
  std::function<bool(std::string_view message, bool text)> heard;
};

struct WebHandlers {
  std::function<std::optional<WebReply>(std::string_view path)> get;  ///< none: there is nothing of that name
  std::function<WebTalk(Channel)> talk;
};

class WebServer {
 public:
  /// Listens. Throws InputError if it cannot at this address.
  WebServer(const WebSettings& settings, WebHandlers handlers);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  std::uint16_t port() const;
  std::string url() const;
  std::size_t web_sockets() const;   ///< that are open
  std::uint64_t bytes_sent() const;  ///< over these

  /// Serves for so many seconds, and first asks every open WebSocket what it has to say.
  void serve(double seconds);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace coppice
