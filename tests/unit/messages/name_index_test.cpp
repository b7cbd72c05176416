// Tests of the numbering of names.
#include "messages/name_index.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace coppice {
namespace {

TEST(NameIndex, NumbersComeInOrderAndStay) {
  NameIndex index;
  std::vector<RobotName> names;
  for (int k = 0; k < 500; ++k) {
    names.push_back(fmt::format("r{}", k));
    names.push_back(fmt::format("a robot with a long name, number {}", k));
  }
  EXPECT_FALSE(index.find("r0"));
  for (std::size_t k = 0; k < names.size(); ++k) EXPECT_EQ(index.insert(names[k]), std::pair(k, true));
  for (std::size_t k = 0; k < names.size(); ++k) {
    EXPECT_EQ(index.insert(names[k]), std::pair(k, false));
    EXPECT_EQ(index.find(names[k]), k);
  }
  EXPECT_FALSE(index.find("r500"));
  EXPECT_FALSE(index.find("a robot with a long name, number 500"));
}

TEST(NameIndex, ShortNamesWithTheSamePrefixDiffer) {
  NameIndex index;
  const std::vector<RobotName> names{
      "a", "aa", std::string("a\0", 2), std::string("\0a", 2), "\xff", "1234567", "12345678"};
  for (std::size_t k = 0; k < names.size(); ++k) EXPECT_EQ(index.insert(names[k]), std::pair(k, true));
}

}  // namespace
}  // namespace coppice
