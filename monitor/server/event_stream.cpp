#include "monitor/server/event_stream.h"

#include <utility>

#include <boost/asio/write.hpp>

namespace coppice::web {

namespace {

// Without a length, so it lasts until the connection is closed (RFC 9112, 6.3).
constexpr const char* head_of_stream =
    "HTTP/1.1 200 OK\r\n"
    "Content-Type: text/event-stream\r\n"
    "Cache-Control: no-store\r\n"
    "X-Accel-Buffering: no\r\n"  // nginx would hold events back
    "X-Content-Type-Options: nosniff\r\n"
    "Connection: close\r\n"
    "\r\n";

}  // namespace

EventStream::EventStream(beast::tcp_stream stream, Place place, Shared& shared, WebStream events)
    : stream_(std::move(stream)), place_(std::move(place)), shared_(shared), events_(std::move(events)) {}

void EventStream::begin() {
  stream_.expires_never();
  shared_.speakers.push_back(weak_from_this());
  send(head_of_stream);
  watch();
}

void EventStream::speak() {
  if (!bytes_.empty()) {
    if (Clock::now() - send_began_ > seconds(shared_.limits.blocked_seconds)) cut_off();
    return;
  }
  if (std::string next = events_.next(); !next.empty()) send(std::move(next));
}

void EventStream::send(std::string bytes) {
  bytes_ = std::move(bytes);
  send_began_ = Clock::now();
  asio::async_write(stream_, asio::buffer(bytes_),
                    [self = shared_from_this()](error_code error, std::size_t size) {
                      self->shared_.bytes_sent += size;
                      if (error) return self->cut_off();
                      self->bytes_.clear();
                    });
}

/// Notices when the client closes the connection. The pending read also keeps this object alive.
void EventStream::watch() {
  stream_.async_read_some(asio::buffer(ignored_), [self = shared_from_this()](error_code error, std::size_t) {
    error ? self->cut_off() : self->watch();
  });
}

void EventStream::cut_off() {
  stream_.close();
}

}  // namespace coppice::web
