#include "monitor/server/web_socket_session.h"

#include <string>
#include <utility>

namespace coppice::web {

WebSocketSession::WebSocketSession(beast::tcp_stream stream, Place place, Shared& shared, Channel channel)
    : socket_(std::move(stream)), place_(std::move(place)), shared_(shared), channel_(channel) {}

void WebSocketSession::accept(const Request& request) {
  const WebLimits& limits = shared_.limits;
  beast::get_lowest_layer(socket_).expires_never();  // the WebSocket has its own timeouts
  socket_.set_option(
      websocket::stream_base::timeout{seconds(limits.request_seconds), seconds(limits.idle_seconds), true});
  socket_.read_message_max(limits.frame);
  socket_.set_option(websocket::stream_base::decorator(
      [spoken = foxglove_subprotocol(view_of(request[http::field::sec_websocket_protocol]))](
          websocket::response_type& answer) {
        if (spoken) answer.set(http::field::sec_websocket_protocol, std::string(*spoken));
      }));
  socket_.async_accept(request, [self = shared_from_this()](error_code error) {
    if (error) return;
    self->talk_ = self->shared_.handlers.talk(self->channel_);
    self->shared_.speakers.push_back(self);
    self->read();
    self->speak();
  });
}

void WebSocketSession::speak() {
  if (sending_ < messages_.size()) {
    if (Clock::now() - send_began_ > seconds(shared_.limits.blocked_seconds)) cut_off();
    return;
  }
  if (closing_) return;
  messages_ = talk_.next();
  sending_ = 0;
  send_next();
}

void WebSocketSession::send_next() {
  if (sending_ == messages_.size()) {
    messages_.clear();
    sending_ = 0;
    return;
  }
  const Outbound& message = messages_[sending_];
  send_began_ = Clock::now();
  socket_.text(message.text);
  socket_.async_write(asio::buffer(*message.bytes),
                      [self = shared_from_this()](error_code error, std::size_t size) {
                        self->shared_.bytes_sent += size;
                        if (error) return self->cut_off();
                        if (self->closing_) return self->say_goodbye();
                        ++self->sending_;
                        self->send_next();
                      });
}

void WebSocketSession::read() {
  socket_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
    if (error) return self->cut_off();
    const auto bytes = self->buffer_.cdata();
    const std::string_view message(static_cast<const char*>(bytes.data()), bytes.size());
    if (!self->talk_.heard(message, self->socket_.got_text())) return self->close();
    self->buffer_.consume(self->buffer_.size());
    self->read();
  });
}

/// Closes after the current message. A close is a write, and only one write at a time is allowed.
void WebSocketSession::close() {
  closing_ = true;
  if (sending_ == messages_.size()) say_goodbye();
}

void WebSocketSession::say_goodbye() {
  messages_.clear();
  sending_ = 0;
  socket_.async_close(websocket::close_code::bad_payload, [self = shared_from_this()](error_code) {});
}

void WebSocketSession::cut_off() {
  closing_ = true;
  beast::get_lowest_layer(socket_).close();
}

}  // namespace coppice::web
