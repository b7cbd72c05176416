// Limits how fast the token can be guessed from one address.
//
// An address may be wrong a few times, and then once in a while. What it shows beyond that is not looked at,
// so that it does not learn which token is right. An address that has shown the token before is always heard:
// the mistakes of one client must not keep an operator at the same address from stopping the fleet.
//
// A state machine: times come in, in seconds of any clock that never goes back.
#pragma once

#include <cstddef>
#include <map>
#include <string>

namespace coppice {

class LoginGuard {
 public:
  static constexpr double burst = 10;          ///< wrong tokens that are answered at once
  static constexpr double between = 6;         ///< seconds, until one more is
  static constexpr std::size_t most = 10'000;  ///< addresses that it knows; then it forgets the oldest

  enum class Verdict : unsigned char { heard, limited };

  /// Notes that the address has shown a token, and says whether that counts.
  Verdict on(const std::string& address, bool is_right, double now);
  /// Seconds until the next token of this address is looked at; 0: at once.
  double wait(const std::string& address, double now) const;

 private:
  struct Client {
    double left = burst;  ///< wrong tokens that are answered, at time `at`
    double at = 0;
    bool is_known = false;  ///< it has shown the token
  };
  double left(const Client& client, double now) const;
  Client& client(const std::string& address, double now);

  std::map<std::string, Client> clients_;
};

}  // namespace coppice
