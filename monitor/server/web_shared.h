// What the connections of a web server share. For the files of the web server alone.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

#include "monitor/server/login_guard.h"
#include "monitor/server/web_server.h"

namespace coppice::web {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;
using Request = http::request<http::empty_body>;

inline Clock::duration seconds(double s) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
}

inline std::string_view view_of(beast::string_view text) {
  return {text.data(), text.size()};
}

/// A connection that lasts: at each turn it may send something.
class Speaker {
 public:
  virtual ~Speaker() = default;
  virtual void speak() = 0;
};

class HttpSession;

/// Outlives all connections.
struct Shared {
  WebLimits limits;
  std::vector<std::string> origins;
  ProxyOrigins proxies;
  std::string token;
  WebHandlers handlers;
  LoginGuard guard{};
  std::uint64_t refused_logins = 0;
  asio::io_context* context = nullptr;
  std::size_t connections = 0;
  std::uint64_t bytes_sent = 0;  ///< by speakers
  std::vector<std::weak_ptr<Speaker>> speakers{};
  std::vector<std::shared_ptr<HttpSession>> waiting{};  ///< they owe a reply
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

}  // namespace coppice::web
