// Tests of how many decisions of a robot may have reached no peer.
#include "robot_agent/peers/loss.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "robot_agent/peers/fleet.h"

namespace coppice {
namespace {

/// The loss count after the states with these numbers arrived in this order.
LossCount counted(const std::vector<std::uint32_t>& numbers) {
  LossCount loss;
  Received received;
  for (const std::uint32_t number : numbers) loss.add(received.hear(number * heartbeat_interval));
  return loss;
}

std::vector<std::uint32_t> numbers_up_to(std::uint32_t end, auto&& came) {
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t k = 0; k < end; ++k) {
    if (came(k)) numbers.push_back(k);
  }
  return numbers;
}

TEST(Loss, UnheardStatesBecomeRarerWithCopiesAndWitnesses) {
  const LossCount two_thirds = counted(numbers_up_to(3000, [](auto k) { return k % 6 < 2; }));
  // A loss of more than half is never assumed to last.
  EXPECT_EQ(two_thirds.unheard_states(1), 19);  // 0.5^20 is the first power below one in a million
  EXPECT_EQ(two_thirds.unheard_states(10), 1);
  EXPECT_EQ(two_thirds.unheard_states(20), 0);

  const LossCount none = counted(numbers_up_to(10000, [](auto) { return true; }));
  EXPECT_EQ(none.unheard_states(1), 2);
  EXPECT_EQ(none.unheard_states(3), 0);
}

TEST(Loss, EnoughCopiesReachAtLeastOneListener) {
  for (const std::uint32_t lost : {0u, 1u, 3u, 5u}) {  // of ten states
    const LossCount loss =
        counted(numbers_up_to(3000, [&](auto k) { return (k * 7 + k / 10) % 10 >= lost; }));
    for (std::size_t listeners = 1; listeners <= 6; ++listeners) {
      const int copies = loss.copies_for(listeners);
      EXPECT_GE(copies, 1);
      if (copies < 16) {
        EXPECT_EQ(loss.unheard_states(listeners * static_cast<std::size_t>(copies)), 0) << lost;
      }
      if (copies > 1) {
        EXPECT_GT(loss.unheard_states(listeners * static_cast<std::size_t>(copies - 1)), 0) << lost;
      }
    }
  }
  const LossCount none = counted(numbers_up_to(3000, [](auto) { return true; }));
  EXPECT_EQ(none.copies_for(3), 1);  // so that no copies are sent in a fleet without loss
}

TEST(Loss, RestartsPausesAndLateOrDoubleStatesAreNoLoss) {
  std::vector<std::uint32_t> numbers = numbers_up_to(10000, [](auto) { return true; });
  for (std::size_t k = 0; k + 7 < numbers.size(); k += 7) {
    std::swap(numbers[k], numbers[k + 5]);
    numbers[k + 6] = numbers[k + 3];
    numbers[k + 3] += 3;  // arrives instead, and the other one a second time
  }
  for (std::uint32_t k = 0; k < 100; ++k) numbers.push_back(k);
  for (std::uint32_t k = 5000; k < 5100; ++k) numbers.push_back(k);
  EXPECT_EQ(counted(numbers).unheard_states(1), 2);
}

TEST(Loss, APeerThatIsHeardRarelySaysNothingAboutLoss) {
  for (const std::uint32_t stride : {2u, 4u, 8u, 16u}) {
    const LossCount loss = counted(numbers_up_to(5000, [&](auto k) { return k % stride == 0; }));
    EXPECT_EQ(loss.unheard_states(1), LossCount().unheard_states(1));
  }
}

/// A witness hears each state. After a while this one is a witness for two heartbeats of eight only, and
/// hears every second heartbeat besides.
TEST(Loss, APeerThatIsAWitnessByTurnsSaysNothingAboutLoss) {
  const LossCount loss =
      counted(numbers_up_to(5000, [](auto k) { return k < 2000 || k % 2 == 0 || k % 8 == 5; }));
  EXPECT_EQ(loss.unheard_states(1), 2);
}

/// Also where much is lost, the states between those that came are as likely to be lost as all others.
TEST(Loss, TheShareOfIndependentLossesIsFound) {
  std::mt19937_64 random(1);
  for (const double share : {0.02, 0.1, 0.3}) {
    std::bernoulli_distribution lost(share);
    const LossCount loss = counted(numbers_up_to(50'000, [&](auto) { return !lost(random); }));
    const double exact = std::ceil(std::log(1e-6) / std::log(share));
    EXPECT_NEAR(loss.unheard_states(1) + 1, exact, std::max(1.0, 0.2 * exact)) << share;
  }
}

}  // namespace
}  // namespace coppice
