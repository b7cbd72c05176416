// The server's end of a WebSocket. For the files of the web server alone.
#pragma once

#include <memory>
#include <vector>

#include <boost/beast/websocket.hpp>

#include "monitor/server/web_shared.h"

namespace coppice::web {

namespace websocket = beast::websocket;

class WebSocketSession : public Speaker, public std::enable_shared_from_this<WebSocketSession> {
 public:
  WebSocketSession(beast::tcp_stream stream, Place place, Shared& shared, Channel channel);

  void accept(const Request& request);
  /// Sends the next messages, unless earlier ones are still being sent. Cuts off a client that does not take
  /// them.
  void speak() override;

 private:
  void send_next();
  void read();
  void close();
  void say_goodbye();
  void cut_off();

  websocket::stream<beast::tcp_stream> socket_;
  Place place_;
  Shared& shared_;
  Channel channel_;
  WebTalk talk_;
  beast::flat_buffer buffer_;
  std::vector<Outbound> messages_;
  std::size_t sending_ = 0;
  Clock::time_point send_began_{};
  bool closing_ = false;
};

}  // namespace coppice::web
