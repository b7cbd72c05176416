#include "monitor/web_server.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <fmt/format.h>

#include "coppice/files/input_error.h"

namespace coppice {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;
using Request = http::request<http::empty_body>;
using Response = http::response<http::string_body>;

constexpr const char* content_policy =
    "default-src 'self'; connect-src 'self'; img-src 'self' data:; style-src 'self'";

Clock::duration seconds(double s) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
}

std::string_view view_of(beast::string_view text) {
  return {text.data(), text.size()};
}

class WebSocketSession;

/// Shared by all connections, and outlives them.
struct Shared {
  WebLimits limits;
  std::vector<std::string> origins;
  WebHandlers handlers;
  std::size_t connections = 0;
  std::uint64_t bytes_sent = 0;
  std::vector<std::weak_ptr<WebSocketSession>> web_sockets{};
};

/// Counts a connection as long as it exists.
class Place {
 public:
  explicit Place(Shared& shared) : shared_(&shared) { ++shared.connections; }
  ~Place() {
    if (shared_ != nullptr) --shared_->connections;
  }
  Place(Place&& other) noexcept : shared_(std::exchange(other.shared_, nullptr)) {}
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;
  Place& operator=(Place&&) = delete;

 private:
  Shared* shared_;
};

class WebSocketSession : public std::enable_shared_from_this<WebSocketSession> {
 public:
  WebSocketSession(beast::tcp_stream stream, Place place, Shared& shared, Channel channel)
      : socket_(std::move(stream)), place_(std::move(place)), shared_(shared), channel_(channel) {}

  void accept(const Request& request) {
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
      self->shared_.web_sockets.push_back(self);
      self->read();
      self->speak();
    });
  }

  /// Sends the next messages, unless earlier ones are still being sent. Cuts off a client that does not take
  /// them.
  void speak() {
    if (sending_ < messages_.size()) {
      if (Clock::now() - send_began_ > seconds(shared_.limits.blocked_seconds)) cut_off();
      return;
    }
    if (closing_) return;
    messages_ = talk_.next();
    sending_ = 0;
    send_next();
  }

 private:
  void send_next() {
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

  void read() {
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
  void close() {
    closing_ = true;
    if (sending_ == messages_.size()) say_goodbye();
  }

  void say_goodbye() {
    messages_.clear();
    sending_ = 0;
    socket_.async_close(websocket::close_code::bad_payload, [self = shared_from_this()](error_code) {});
  }

  void cut_off() {
    closing_ = true;
    beast::get_lowest_layer(socket_).close();
  }

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

Response reply_to(const Request& request, http::status status, std::string type, std::string body) {
  Response response(status, request.version());
  response.set(http::field::content_type, type);
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Content-Security-Policy", content_policy);
  response.set(http::field::cache_control, "no-cache");
  response.keep_alive(request.keep_alive());
  response.content_length(body.size());
  if (request.method() != http::verb::head) response.body() = std::move(body);
  return response;
}

Response refusal(const Request& request, http::status status, const std::string& why) {
  Response response = reply_to(request, status, "text/plain; charset=utf-8", why + "\n");
  response.keep_alive(false);
  return response;
}

/// True if the bytes are no HTTP; false if they are incomplete or late.
bool is_bad_request(const error_code& error) {
  return error.category() == http::make_error_code(http::error::bad_method).category() &&
         error != http::error::end_of_stream && error != http::error::partial_message;
}

Response answer(const Request& request, const WebHandlers& handlers) {
  if (request.method() != http::verb::get && request.method() != http::verb::head) {
    Response response = refusal(request, http::status::method_not_allowed, "Only GET and HEAD.");
    response.set(http::field::allow, "GET, HEAD");
    return response;
  }
  auto reply = handlers.get(path_of(view_of(request.target())));
  if (!reply) return refusal(request, http::status::not_found, "Not found.");
  return reply_to(request, http::status::ok, std::move(reply->type), std::move(reply->body));
}

/// Answers one request after the other, until a request asks for a WebSocket.
class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(asio::ip::tcp::socket socket, Shared& shared)
      : stream_(std::move(socket)), place_(shared), shared_(shared) {}

  void read() {
    parser_.emplace();
    parser_->header_limit(shared_.limits.header);
    stream_.expires_after(seconds(shared_.limits.request_seconds));
    http::async_read_header(
        stream_, buffer_, *parser_,
        [self = shared_from_this()](error_code error, std::size_t) { self->on_read(error); });
  }

 private:
  void on_read(error_code error) {
    if (error == http::error::header_limit)
      return send(refusal({}, http::status::request_header_fields_too_large, "The request is too long."));
    if (is_bad_request(error))
      return send(refusal({}, http::status::bad_request, "This is not an HTTP request."));
    if (error) return;  // the client has gone, or is too slow
    const Request& request = parser_->get();
    if (!is_fine_host(view_of(request[http::field::host])))
      return send(refusal(request, http::status::misdirected_request,
                          "Use an IP address or localhost: any other name may belong to another site."));
    if (parser_->chunked() || parser_->content_length().value_or(0) > 0)
      return send(refusal(request, http::status::payload_too_large, "Requests have no body here."));
    if (websocket::is_upgrade(request)) return upgrade(request);
    send(answer(request, shared_.handlers));
  }

  void upgrade(const Request& request) {
    const auto channel =
        channel_of(path_of(view_of(request.target())), view_of(request[http::field::sec_websocket_protocol]));
    if (!channel) return send(refusal(request, http::status::not_found, "WebSockets are at /live."));
    if (!may_connect(*channel, view_of(request[http::field::origin]), view_of(request[http::field::host]),
                     shared_.origins))
      return send(refusal(request, http::status::forbidden, "Pages of other sites may not connect."));
    std::make_shared<WebSocketSession>(std::move(stream_), std::move(place_), shared_, *channel)
        ->accept(request);
  }

  void send(Response response) {
    response_ = std::move(response);
    stream_.expires_after(seconds(shared_.limits.blocked_seconds));
    http::async_write(stream_, response_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return;
      if (self->response_.keep_alive()) return self->read();
      self->stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, error);
    });
  }

  beast::tcp_stream stream_;
  Place place_;
  Shared& shared_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  Response response_;
};

asio::ip::tcp::endpoint endpoint_of(const WebSettings& settings) {
  error_code error;
  const auto address = asio::ip::make_address(settings.address, error);
  if (error) throw InputError(fmt::format("--address {}: expected an IP address", settings.address));
  return {address, settings.port};
}

}  // namespace

struct WebServer::Implementation {
  // The context holds the connections, so it is destroyed before `shared`.
  Shared shared;
  asio::io_context context{1};
  asio::ip::tcp::acceptor acceptor{context};

  void listen(asio::ip::tcp::endpoint endpoint, bool else_any_port) {
    try {
      acceptor.open(endpoint.protocol());
      acceptor.set_option(asio::socket_base::reuse_address(true));
      error_code problem;
      acceptor.bind(endpoint, problem);
      if (problem == asio::error::address_in_use && else_any_port) {
        endpoint.port(0);
        acceptor.bind(endpoint);
      } else if (problem) {
        throw boost::system::system_error(problem);
      }
      acceptor.listen();
    } catch (const boost::system::system_error& problem) {
      throw InputError(fmt::format("{}:{}: cannot listen there: {}", endpoint.address().to_string(),
                                   endpoint.port(), problem.code().message()));
    }
  }

  void accept() {
    acceptor.async_accept([this](error_code error, asio::ip::tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (!error && shared.connections < shared.limits.connections) {
        socket.set_option(asio::socket_base::send_buffer_size(shared.limits.send_buffer), error);
        socket.set_option(asio::ip::tcp::no_delay(true), error);
        std::make_shared<HttpSession>(std::move(socket), shared)->read();
      }
      accept();
    });
  }
};

WebServer::WebServer(const WebSettings& settings, WebHandlers handlers)
    : implementation_(new Implementation{.shared = {.limits = settings.limits,
                                                    .origins = settings.origins,
                                                    .handlers = std::move(handlers)}}) {
  implementation_->listen(endpoint_of(settings), settings.else_any_port);
  implementation_->accept();
}

WebServer::~WebServer() = default;

std::uint16_t WebServer::port() const {
  return implementation_->acceptor.local_endpoint().port();
}

std::string WebServer::url() const {
  const auto address = implementation_->acceptor.local_endpoint().address();
  const std::string host = address.is_v6() ? fmt::format("[{}]", address.to_string()) : address.to_string();
  return fmt::format("http://{}:{}/", host, port());
}

std::size_t WebServer::web_sockets() const {
  return static_cast<std::size_t>(std::ranges::count_if(implementation_->shared.web_sockets,
                                                        [](const auto& one) { return !one.expired(); }));
}

std::uint64_t WebServer::bytes_sent() const {
  return implementation_->shared.bytes_sent;
}

void WebServer::serve(double duration) {
  auto& all = implementation_->shared.web_sockets;
  std::erase_if(all, [](const auto& one) { return one.expired(); });
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (const auto session = all[k].lock()) session->speak();
  }
  implementation_->context.restart();
  implementation_->context.run_for(seconds(duration));
}

}  // namespace coppice
