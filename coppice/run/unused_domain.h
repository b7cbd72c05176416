// A DDS domain that a run has to itself on this machine.
#pragma once

#include <string>

namespace coppice {

/// Chooses an unused DDS domain from 1 to 100, and reserves it until it is destroyed. Up to domain 100 the
/// default ports stay below those that Linux gives to any program.
///
/// A domain is unused if no process of this machine has joined it and no other reservation holds it. The
/// reservation is needed because seconds pass until the first process of the fleet joins. It is a Unix socket
/// in the abstract namespace, which has the same scope as the ports (the network namespace), needs no file,
/// and ends with its process.
class UnusedDomain {
 public:
  /// The search begins at a domain that depends on `unique`. So runs on two hosts of one network meet in only
  /// one case of a hundred (--domain avoids it). Throws std::runtime_error if all domains are used.
  explicit UnusedDomain(const std::string& unique);
  ~UnusedDomain();
  UnusedDomain(UnusedDomain&&) = delete;
  UnusedDomain& operator=(UnusedDomain&&) = delete;

  int number() const { return number_; }

 private:
  int number_ = 0;
  int reservation_ = -1;
};

}  // namespace coppice
