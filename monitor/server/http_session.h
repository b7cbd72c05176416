// Answers HTTP requests on one connection. For the files of the web server alone.
//
// The order of the checks: what is no HTTP, a Host that may belong to another site, the rights to use the
// API, a body that is too large. A body is read only after that.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>

#include "monitor/server/web_shared.h"

namespace coppice::web {

/// Answers one request after the other, until a request asks for a WebSocket or for events.
class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(asio::ip::tcp::socket socket, Shared& shared);

  void read();
  /// Replies to the request that waits, or waits on.
  void poll();

 private:
  using Response = http::response<http::string_body>;

  void on_head(error_code error);
  void on_request();
  void on_api_request();
  bool may_log_in(bool shows_token);
  std::string client() const;
  void upgrade();
  void read_body();
  void on_body(error_code error);
  void use(WebAnswer answer);
  void wait(WebWait wait);

  bool has_body() const;
  bool leaves_bytes() const;
  void refuse(unsigned status, const std::string& why);
  void reply(WebReply reply);
  void send(Response response);
  void on_sent();
  void drain();

  beast::tcp_stream stream_;
  Place place_;
  Shared& shared_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> head_parser_;
  std::optional<http::request_parser<http::string_body>> body_parser_;  ///< none: the body was not read
  Request request_;                                                     ///< the line and the headers
  WebWait wait_;
  Response response_;
  std::array<char, 4096> drained_{};
};

}  // namespace coppice::web
