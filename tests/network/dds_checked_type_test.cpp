// CTest: PARALLEL

#include <future>
#include <string>

#include <gtest/gtest.h>

#include "dds/checked_type.h"
#include "dds/conversion.h"

namespace coppice {
namespace {

using Type = CheckedType<DdsType<RobotState>::Support>;
using Key = eprosima::fastrtps::rtps::InstanceHandle_t;

Key key_of(Type& type, const std::string& robot) {
  auto sample = to_dds(RobotState{.robot = robot});
  Key key;
  type.getKey(&sample, &key, false);
  return key;
}

/// The number of keys that differ from the key computed alone.
int wrong_keys(Type& type, const std::string& robot, const Key& expected) {
  int wrong = 0;
  for (int k = 0; k < 20'000; ++k) wrong += key_of(type, robot) == expected ? 0 : 1;
  return wrong;
}

// An agent writes its own state while it receives the states of others.
TEST(CheckedType, ThreadsGetTheKeysOfTheirOwnSamples) {
  Type type;
  const Key a = key_of(type, "a");
  const Key b = key_of(type, std::string(64, 'b'));
  ASSERT_FALSE(a == b);
  auto writing = std::async(std::launch::async, [&] { return wrong_keys(type, "a", a); });
  EXPECT_EQ(wrong_keys(type, std::string(64, 'b'), b), 0);
  EXPECT_EQ(writing.get(), 0);
}

}  // namespace
}  // namespace coppice
