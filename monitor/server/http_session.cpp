#include "monitor/server/http_session.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <boost/asio/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "monitor/server/event_stream.h"
#include "monitor/server/web_problem.h"
#include "monitor/server/web_rules.h"
#include "monitor/server/web_socket_session.h"

namespace coppice::web {

namespace {

constexpr const char* content_policy =
    "default-src 'self'; connect-src 'self'; img-src 'self' data:; style-src 'self'";
constexpr const char* foreign_page =
    "Pages of other sites are not served. If this is the page behind a proxy: the monitor needs "
    "--proxy-origin with the origin of the page.";
constexpr std::string_view go_on = "HTTP/1.1 100 Continue\r\n\r\n";

/// True if the bytes are no HTTP; false if they are incomplete or late.
bool is_bad_request(const error_code& error) {
  return error.category() == http::make_error_code(http::error::bad_method).category() &&
         error != http::error::end_of_stream && error != http::error::partial_message;
}

}  // namespace

HttpSession::HttpSession(asio::ip::tcp::socket socket, Shared& shared)
    : stream_(std::move(socket)), place_(shared), shared_(shared) {}

void HttpSession::read() {
  body_parser_.reset();
  head_parser_.emplace();
  head_parser_->header_limit(shared_.limits.header);
  head_parser_->body_limit(std::numeric_limits<std::uint64_t>::max());  // on_api_request looks at its size
  stream_.expires_after(seconds(shared_.limits.request_seconds));
  http::async_read_header(
      stream_, buffer_, *head_parser_,
      [self = shared_from_this()](error_code error, std::size_t) { self->on_head(error); });
}

void HttpSession::on_head(error_code error) {
  request_ = error ? Request() : head_parser_->get();
  if (error == http::error::header_limit) return refuse(431, "The request is too long.");
  if (is_bad_request(error)) return refuse(400, "This is not an HTTP request.");
  if (error) return;  // the client has gone, or is too slow
  if (!is_fine_host(view_of(request_[http::field::host]), shared_.proxies))
    return refuse(421,
                  "Use an IP address or localhost: any other name may belong to another site. The name of a "
                  "proxy needs --proxy-origin.");
  is_of_api(path_of(view_of(request_.target()))) ? on_api_request() : on_request();
}

void HttpSession::on_request() {
  if (has_body()) return refuse(413, "Requests have no body here.");
  if (beast::websocket::is_upgrade(request_)) return upgrade();
  if (request_.method() != http::verb::get && request_.method() != http::verb::head)
    return reply({"text/plain; charset=utf-8", "Only GET and HEAD.\n", 405, {{"Allow", "GET, HEAD"}}});
  auto found = shared_.handlers.get(path_of(view_of(request_.target())));
  found ? reply(std::move(*found)) : refuse(404, "Not found.");
}

void HttpSession::on_api_request() {
  const ApiAccess access =
      api_access(view_of(request_[http::field::authorization]), view_of(request_[http::field::origin]),
                 view_of(request_[http::field::host]), shared_.token, shared_.proxies);
  if (access == ApiAccess::absent) return refuse(404, "This monitor has no API: it needs --control.");
  if (access == ApiAccess::foreign_origin) return refuse(403, foreign_page);
  if (!may_log_in(access == ApiAccess::granted)) return;
  if (head_parser_->content_length().value_or(0) > shared_.limits.body)
    return refuse(413, fmt::format("Expected a body of at most {} bytes.", shared_.limits.body));
  read_body();
}

/// Replies if the request does not show the token, or if too many from its address did not.
bool HttpSession::may_log_in(bool shows_token) {
  WebReply refusal =
      problem_reply(401, "Expected a header Authorization: Bearer TOKEN with this monitor's token.");
  refusal.headers = {{"WWW-Authenticate", "Bearer"}};
  if (request_.find(http::field::authorization) == request_.end()) return reply(std::move(refusal)), false;
  const std::string address = client();
  const double now = std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
  const bool was_limited = shared_.guard.wait(address, now) > 0;
  const bool is_heard = shared_.guard.on(address, shows_token, now) == LoginGuard::Verdict::heard;
  if (is_heard && shows_token) return true;
  ++shared_.refused_logins;
  const double wait = std::ceil(shared_.guard.wait(address, now));
  if (!is_heard) {
    refusal = problem_reply(429, fmt::format("Too many wrong tokens from {}: wait {:g} s.", address, wait));
    refusal.headers = {{"Retry-After", fmt::format("{:g}", wait)}};
  }
  if (!was_limited)
    spdlog::warn("{} showed a wrong token{}", address,
                 wait > 0 ? fmt::format(" too often: what it shows counts again in {:g} s", wait) : "");
  reply(std::move(refusal));
  return false;
}

/// The address for the log and for limits. A proxy on this machine says for whom it asks.
std::string HttpSession::client() const {
  error_code error;
  const auto address = stream_.socket().remote_endpoint(error).address();
  if (!shared_.proxies.empty() && address.is_loopback()) {
    std::string_view forwarded;
    const auto [from, until] = request_.equal_range("X-Forwarded-For");
    for (auto field = from; field != until; ++field) forwarded = last_address(view_of(field->value()));
    if (!forwarded.empty()) return std::string(forwarded);
  }
  return address.to_string();
}

void HttpSession::upgrade() {
  const auto subprotocols = view_of(request_[http::field::sec_websocket_protocol]);
  const auto channel = channel_of(path_of(view_of(request_.target())), subprotocols);
  if (!channel) return refuse(404, "WebSockets are at /live.");
  if (!may_connect(*channel, view_of(request_[http::field::origin]), view_of(request_[http::field::host]),
                   shared_.origins, shared_.proxies))
    return refuse(403, foreign_page);
  std::make_shared<WebSocketSession>(std::move(stream_), std::move(place_), shared_, *channel)
      ->accept(request_);
}

void HttpSession::read_body() {
  body_parser_.emplace(std::move(*head_parser_));
  body_parser_->body_limit(shared_.limits.body);
  const auto read = [self = shared_from_this()](error_code error, std::size_t) {
    if (error) return;
    http::async_read(self->stream_, self->buffer_, *self->body_parser_,
                     [self](error_code problem, std::size_t) { self->on_body(problem); });
  };
  const bool waits = beast::iequals(request_[http::field::expect], "100-continue");
  waits ? asio::async_write(stream_, asio::buffer(go_on), read) : read({}, 0);
}

void HttpSession::on_body(error_code error) {
  if (error) body_parser_->get().body().clear();
  if (error == http::error::body_limit)
    return refuse(413, fmt::format("Expected a body of at most {} bytes.", shared_.limits.body));
  if (is_bad_request(error)) return refuse(400, "This is not an HTTP request.");
  if (error) return;
  const std::string client = this->client();
  const std::string_view target = view_of(request_.target());
  use(shared_.handlers.api({.method = view_of(request_.method_string()),
                            .path = path_of(target),
                            .query = query_of(target),
                            .body = body_parser_->get().body(),
                            .client = client}));
}

void HttpSession::use(WebAnswer answer) {
  if (auto* const now = std::get_if<WebReply>(&answer)) return reply(std::move(*now));
  if (auto* const later = std::get_if<WebWait>(&answer)) return wait(std::move(*later));
  std::make_shared<EventStream>(std::move(stream_), std::move(place_), shared_,
                                std::move(std::get<WebStream>(answer)))
      ->begin();
}

void HttpSession::wait(WebWait wait) {
  wait_ = std::move(wait);
  stream_.expires_never();
  shared_.waiting.push_back(shared_from_this());
  shared_.context->stop();  // ends this turn
}

void HttpSession::poll() {
  auto due = wait_.poll();
  due ? reply(std::move(*due)) : shared_.waiting.push_back(shared_from_this());
}

bool HttpSession::has_body() const {
  return head_parser_->chunked() || head_parser_->content_length().value_or(0) > 0;
}

/// Whether the client may still send bytes of its request.
bool HttpSession::leaves_bytes() const {
  if (body_parser_) return !body_parser_->is_done();
  return head_parser_->is_header_done() && has_body();
}

void HttpSession::refuse(unsigned status, const std::string& why) {
  WebReply refusal = is_of_api(path_of(view_of(request_.target())))
                         ? problem_reply(status, why)
                         : WebReply{"text/plain; charset=utf-8", why + "\n", status};
  refusal.headers.emplace_back("Connection", "close");
  reply(std::move(refusal));
}

void HttpSession::reply(WebReply reply) {
  Response response(static_cast<http::status>(reply.status), request_.version());
  response.set(http::field::content_type, reply.type);
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Content-Security-Policy", content_policy);
  response.set(http::field::cache_control, "no-cache");
  response.keep_alive(request_.keep_alive() && !leaves_bytes());
  for (const auto& [name, value] : reply.headers) response.set(name, value);
  response.content_length(reply.body.size());
  if (request_.method() != http::verb::head) response.body() = std::move(reply.body);
  send(std::move(response));
}

void HttpSession::send(Response response) {
  response_ = std::move(response);
  stream_.expires_after(seconds(shared_.limits.blocked_seconds));
  http::async_write(stream_, response_, [self = shared_from_this()](error_code error, std::size_t) {
    if (!error) self->on_sent();
  });
}

void HttpSession::on_sent() {
  if (response_.keep_alive()) return read();
  error_code ignored;
  stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
  stream_.expires_after(seconds(shared_.limits.request_seconds));
  if (leaves_bytes()) drain();
}

/// Takes what a refused client still sends, for a while. Closed at once, the connection would be reset, and
/// the client could not read why.
void HttpSession::drain() {
  stream_.async_read_some(asio::buffer(drained_), [self = shared_from_this()](error_code error, std::size_t) {
    if (!error) self->drain();
  });
}

}  // namespace coppice::web
