// Tests of samples that no correct process sends.
#include "dds/serialized.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "messages/messages.h"

namespace coppice {
namespace {

long peak_memory() {  // KiB
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

// Each zero might begin a member. Memory for all of them would be a hundred times as many bytes.
TEST(Serialized, ASequenceLongerThanItsTypeAllowsAllocatesNoMemory) {
  std::vector<std::uint8_t> bytes = serialized(JointPlanMessage{.round = {1, "a"}, .members = {}});
  // The offset of the members: behind the kind, the encapsulation, the leader, the epoch, the centre and the
  // reach.
  constexpr std::size_t length_of_members = 1 + 4 + 40;
  ASSERT_TRUE(deserialized(bytes).has_value());
  constexpr std::size_t zeros = 17'000'000;
  const std::array<std::uint8_t, 4> length{zeros & 0xff, zeros >> 8 & 0xff, zeros >> 16 & 0xff, zeros >> 24};
  std::ranges::copy(length, bytes.begin() + length_of_members);
  bytes.resize(bytes.size() + zeros);
  const long before = peak_memory();
  EXPECT_FALSE(deserialized(bytes).has_value());
  EXPECT_LT(peak_memory() - before, 100'000);
}

}  // namespace
}  // namespace coppice
