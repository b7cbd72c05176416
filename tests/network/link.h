// One direction of a link between two hosts, that loses, delays and doubles frames: the rules of tc-netem(8),
// for kernels that have none, and decided here by a seed.
//
// Times are seconds of any clock that does not run back.
#pragma once

#include <cstddef>
#include <random>
#include <string_view>
#include <vector>

namespace coppice::test {

struct LinkRule {
  double loss = 0;       ///< share of the frames, 0..1, each by itself
  double duplicate = 0;  ///< share of the frames that come twice
  double delay = 0;      ///< seconds
  double jitter = 0;     ///< seconds on either side of the delay, uniformly, each by itself: frames overtake
  double rate = 0;       ///< bits per second; 0: no limit
  std::size_t limit = 1000;  ///< frames under way; what comes on top is dropped
  bool multicast = true;     ///< false: no multicast passes, but what finds addresses (ARP, IPv6's ND)
  bool down = false;
};

/// "loss 20% delay 100ms 50ms duplicate 1% rate 10mbit limit 500 multicast off down", any of these; none: a
/// clean link. Throws std::invalid_argument that names what it does not understand.
LinkRule parse_link_rule(std::string_view text);

/// What is of interest in an Ethernet frame: whether it is for a group, other than to find addresses.
bool is_multicast(const unsigned char* frame, std::size_t size);

class Link {
 public:
  struct Counts {
    std::size_t came = 0;
    std::size_t lost = 0;  ///< by chance, or because the link was down
    std::size_t doubled = 0;
    std::size_t over_limit = 0;
    std::size_t multicast = 0;  ///< kept off
  };

  LinkRule rule{};

  /// When the frame comes out at the other end: never, once or twice.
  std::vector<double> pass(std::size_t size, bool multicast, double now, std::mt19937_64& random);
  /// One that was under way came out.
  void came_out() { --under_way_; }
  const Counts& counts() const { return counts_; }

 private:
  double due(std::size_t size, double now, std::mt19937_64& random);

  Counts counts_;
  std::size_t under_way_ = 0;
  double busy_until_ = 0;  ///< with the frames before this one, where there is a rate
};

}  // namespace coppice::test
