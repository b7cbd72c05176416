#include "monitor/server/login_guard.h"

#include <algorithm>

namespace coppice {

double LoginGuard::left(const Client& client, double now) const {
  return std::min(burst, client.left + (now - client.at) / between);
}

LoginGuard::Client& LoginGuard::client(const std::string& address, double now) {
  if (clients_.size() >= most && !clients_.contains(address))
    clients_.erase(std::ranges::min_element(clients_, {}, [](const auto& one) { return one.second.at; }));
  return clients_.try_emplace(address, Client{.at = now}).first->second;
}

LoginGuard::Verdict LoginGuard::on(const std::string& address, bool is_right, double now) {
  Client& one = client(address, now);
  one.left = left(one, now);
  one.at = now;
  if (is_right && one.is_known) return Verdict::heard;
  if (one.left < 1) return Verdict::limited;
  if (is_right) {
    one.is_known = true;
  } else {
    one.left -= 1;
  }
  return Verdict::heard;
}

double LoginGuard::wait(const std::string& address, double now) const {
  const auto known = clients_.find(address);
  return known == clients_.end() ? 0 : between * std::max(0.0, 1 - left(known->second, now));
}

}  // namespace coppice
