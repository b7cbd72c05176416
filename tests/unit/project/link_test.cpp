// Tests of the simulated links of network tests.

#include "tests/network/link.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace coppice::test {
namespace {

constexpr int many = 20000;

struct Passed {
  std::vector<double> delays;
  int doubled = 0;
};

/// Passes `many` frames, one each millisecond.
Passed pass_many(Link& link, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  Passed passed;
  for (int k = 0; k < many; ++k) {
    const double now = 100 + 0.001 * k;
    const auto out = link.pass(1000, false, now, random);
    passed.doubled += out.size() == 2;
    for (const double due : out) {
      passed.delays.push_back(due - now);
      link.came_out();
    }
  }
  return passed;
}

Link link_of(const std::string& rule) {
  Link link;
  link.rule = parse_link_rule(rule);
  return link;
}

TEST(Link, RulesAreParsedInTheWordsOfNetem) {
  const LinkRule rule =
      parse_link_rule(" loss 20%  delay 100ms 50ms duplicate 0.5% rate 10mbit limit 7 multicast off down");
  EXPECT_DOUBLE_EQ(rule.loss, 0.2);
  EXPECT_DOUBLE_EQ(rule.delay, 0.1);
  EXPECT_DOUBLE_EQ(rule.jitter, 0.05);
  EXPECT_DOUBLE_EQ(rule.duplicate, 0.005);
  EXPECT_DOUBLE_EQ(rule.rate, 1e7);
  EXPECT_EQ(rule.limit, 7u);
  EXPECT_FALSE(rule.multicast);
  EXPECT_TRUE(rule.down);
  EXPECT_DOUBLE_EQ(parse_link_rule("delay 2s loss 1%").jitter, 0);
  EXPECT_DOUBLE_EQ(parse_link_rule("").loss, 0);
  for (const char* wrong : {"loss", "loss 20", "loss 101%", "loss -1%", "loss nan%", "delay 5", "rate 1",
                            "jitter 5ms", "multicast", "multicast no", "delay 1ms 2"})
    EXPECT_THROW(parse_link_rule(wrong), std::invalid_argument) << wrong;
}

TEST(Link, ALinkLosesAndDuplicatesItsShare) {
  Link link = link_of("loss 20% duplicate 10%");
  const Passed passed = pass_many(link);
  EXPECT_NEAR(static_cast<double>(link.counts().lost), 0.2 * many, 250);  // 4 standard deviations
  EXPECT_NEAR(passed.doubled, 0.8 * 0.1 * many, 160);
  EXPECT_EQ(passed.delays.size(), many - link.counts().lost + link.counts().doubled);
}

TEST(Link, DelaysAreSpreadEvenlyAroundTheMean) {
  Link link = link_of("delay 100ms 50ms");
  const auto delays = pass_many(link).delays;
  const auto [least, most] = std::ranges::minmax(delays);
  EXPECT_GE(least, 0.05);
  EXPECT_LE(most, 0.15);
  EXPECT_LT(least, 0.051);
  EXPECT_GT(most, 0.149);
  EXPECT_NEAR(std::accumulate(delays.begin(), delays.end(), 0.0) / many, 0.1, 0.001);
}

TEST(Link, TheSameSeedGivesTheSameDelays) {
  const auto delays = [](std::uint64_t seed) {
    Link link = link_of("loss 30% delay 10ms 5ms");
    return pass_many(link, seed).delays;
  };
  EXPECT_EQ(delays(3), delays(3));
  EXPECT_NE(delays(3), delays(4));
}

TEST(Link, ARateDelaysFramesOneAfterTheOther) {
  Link link = link_of("rate 8mbit delay 5ms");  // 1 ms for 1000 bytes
  std::mt19937_64 random(1);
  for (int k = 1; k <= 10; ++k) {
    const auto out = link.pass(1000, false, 0, random);
    ASSERT_EQ(out.size(), 1u);
    EXPECT_NEAR(out[0], 0.005 + 0.001 * k, 1e-9);
  }
  EXPECT_NEAR(link.pass(1000, false, 1, random).at(0), 1.006, 1e-9);
}

TEST(Link, FramesBeyondTheLimitAreDropped) {
  Link link = link_of("delay 1s limit 3");
  std::mt19937_64 random(1);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(link.pass(100, false, 0, random).size(), 1u);
  EXPECT_TRUE(link.pass(100, false, 0, random).empty());
  EXPECT_EQ(link.counts().over_limit, 1u);
  link.came_out();
  EXPECT_EQ(link.pass(100, false, 0, random).size(), 1u);
}

TEST(Link, NothingPassesALinkThatIsDownAndNoMulticastIfItIsOff) {
  std::mt19937_64 random(1);
  Link down = link_of("down");
  EXPECT_TRUE(down.pass(100, false, 0, random).empty());
  Link quiet = link_of("multicast off");
  EXPECT_TRUE(quiet.pass(100, true, 0, random).empty());
  EXPECT_EQ(quiet.pass(100, false, 0, random).size(), 1u);
  EXPECT_EQ(quiet.counts().multicast, 1u);
}

TEST(Link, MulticastIsToldFromAddressResolution) {
  std::array<unsigned char, 60> frame{};
  EXPECT_FALSE(is_multicast(frame.data(), frame.size()));
  frame[0] = 0x01;  // 01:00:5e, the IPv4 groups
  frame[1] = 0x00;
  frame[2] = 0x5e;
  EXPECT_TRUE(is_multicast(frame.data(), frame.size()));
  EXPECT_FALSE(is_multicast(frame.data(), 10)) << "no frame";
  std::fill_n(frame.begin(), 6, 0xff);  // ARP asks all hosts
  EXPECT_FALSE(is_multicast(frame.data(), frame.size()));
  frame[0] = frame[1] = 0x33;
  frame[12] = 0x86;
  frame[13] = 0xdd;
  frame[20] = 17;  // UDP
  EXPECT_TRUE(is_multicast(frame.data(), frame.size()));
  frame[20] = 58;
  frame[54] = 135;  // a neighbour solicitation
  EXPECT_FALSE(is_multicast(frame.data(), frame.size()));
}

}  // namespace
}  // namespace coppice::test
