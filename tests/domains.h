// DDS domains for tests.
#pragma once

#include <cstddef>
#include <deque>
#include <string>

#include <unistd.h>

#include "coppice/run/unused_domain.h"

namespace coppice::test {

/// A DDS domain that this process has to itself on this machine until it ends; the same one for the same k.
/// Tests that name a number meet each other, and from domain 102 on the system may have given a port of the
/// domain to any program.
inline int own_domain(std::size_t k = 0) {
  static std::deque<UnusedDomain> domains;
  while (domains.size() <= k) domains.emplace_back(std::to_string(getpid()));
  return domains[k].number();
}

/// The same as text, for command lines and messages.
inline std::string domain_name(std::size_t k = 0) {
  return std::to_string(own_domain(k));
}

}  // namespace coppice::test
