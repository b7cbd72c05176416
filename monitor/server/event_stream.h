// A reply that does not end: server-sent events. For the files of the web server alone.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "monitor/server/web_shared.h"

namespace coppice::web {

/// Sends each next piece when the one before is sent, so a slow client costs one piece of memory. A client
/// that does not take its piece in time is cut off.
class EventStream : public Speaker, public std::enable_shared_from_this<EventStream> {
 public:
  EventStream(beast::tcp_stream stream, Place place, Shared& shared, WebStream events);

  void begin();
  void speak() override;

 private:
  void send(std::string bytes);
  void watch();
  void cut_off();

  beast::tcp_stream stream_;
  Place place_;
  Shared& shared_;
  WebStream events_;
  std::string bytes_;  ///< being sent; empty: none
  Clock::time_point send_began_{};
  std::array<char, 256> ignored_{};  ///< what the client says
};

}  // namespace coppice::web
