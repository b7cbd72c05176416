#include "monitor/server/web_server.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "coppice/files/input_error.h"
#include "monitor/server/http_session.h"

namespace coppice {

namespace {

namespace asio = boost::asio;
using boost::system::error_code;

asio::ip::tcp::endpoint endpoint_of(const WebSettings& settings) {
  error_code error;
  const auto address = asio::ip::make_address(settings.address, error);
  if (error) throw InputError(fmt::format("--address {}: expected an IP address", settings.address));
  return {address, settings.port};
}

}  // namespace

struct WebServer::Implementation {
  // The context holds the connections, so it is destroyed before `shared`.
  web::Shared shared;
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
        std::make_shared<web::HttpSession>(std::move(socket), shared)->read();
      }
      accept();
    });
  }
};

WebServer::WebServer(const WebSettings& settings, WebHandlers handlers)
    : implementation_(new Implementation{.shared = {.limits = settings.limits,
                                                    .origins = settings.origins,
                                                    .proxies = settings.proxies,
                                                    .token = settings.token,
                                                    .handlers = std::move(handlers)}}) {
  implementation_->shared.context = &implementation_->context;
  implementation_->listen(endpoint_of(settings), settings.else_any_port);
  implementation_->accept();
}

WebServer::~WebServer() {
  implementation_->shared.waiting.clear();  // their sockets need the context
}

std::uint16_t WebServer::port() const {
  return implementation_->acceptor.local_endpoint().port();
}

std::string WebServer::url() const {
  const auto address = implementation_->acceptor.local_endpoint().address();
  const std::string host = address.is_v6() ? fmt::format("[{}]", address.to_string()) : address.to_string();
  return fmt::format("http://{}:{}/", host, port());
}

std::size_t WebServer::web_sockets() const {
  return static_cast<std::size_t>(std::ranges::count_if(implementation_->shared.speakers,
                                                        [](const auto& one) { return !one.expired(); }));
}

std::uint64_t WebServer::bytes_sent() const {
  return implementation_->shared.bytes_sent;
}

std::uint64_t WebServer::refused_logins() const {
  return implementation_->shared.refused_logins;
}

bool WebServer::owes_replies() const {
  return !implementation_->shared.waiting.empty();
}

void WebServer::serve(double duration) {
  auto& all = implementation_->shared.speakers;
  std::erase_if(all, [](const auto& one) { return one.expired(); });
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (const auto session = all[k].lock()) session->speak();
  }
  for (const auto& session : std::exchange(implementation_->shared.waiting, {})) session->poll();
  implementation_->context.restart();
  implementation_->context.run_for(web::seconds(duration));
}

}  // namespace coppice
