// One direction of a link between two hosts that loses, delays and duplicates frames: the rules of
// tc-netem(8), for kernels without it, with a seed.
//
// Times are seconds of any clock that does not run backwards.
#pragma once

#include <cstddef>
#include <random>
#include <string_view>
#include <vector>

namespace coppice::test {

struct LinkRule {
  double loss = 0;       ///< share of the frames, 0..1, independent for each
  double duplicate = 0;  ///< share of the frames that arrive twice
  double delay = 0;      ///< seconds
  double jitter = 0;     ///< seconds on either side of the delay, uniform and independent for each: frames
                         ///< overtake each other
  double rate = 0;       ///< bits per second; 0: no limit
  std::size_t limit = 1000;  ///< frames under way; more are dropped
  bool multicast = true;     ///< false: no multicast but address resolution (ARP, IPv6 ND) passes
  bool down = false;
};

/// Any of "loss 20% delay 100ms 50ms duplicate 1% rate 10mbit limit 500 multicast off down"; none of them: a
/// clean link. Throws std::invalid_argument that names what it does not understand.
LinkRule parse_link_rule(std::string_view text);

/// Whether an Ethernet frame goes to a group and is no address resolution.
bool is_multicast(const unsigned char* frame, std::size_t size);

class Link {
 public:
  struct Counts {
    std::size_t came = 0;
    std::size_t lost = 0;  ///< by chance, or because the link was down
    std::size_t doubled = 0;
    std::size_t over_limit = 0;
    std::size_t multicast = 0;  ///< frames that were blocked
  };

  LinkRule rule{};

  /// The times at which the frame arrives: none, one or two.
  std::vector<double> pass(std::size_t size, bool multicast, double now, std::mt19937_64& random);
  /// A frame under way arrived.
  void came_out() { --under_way_; }
  const Counts& counts() const { return counts_; }

 private:
  double due(std::size_t size, double now, std::mt19937_64& random);

  Counts counts_;
  std::size_t under_way_ = 0;
  double busy_until_ = 0;  ///< with the frames before this one, if there is a rate
};

}  // namespace coppice::test
