#include "planning/nearest_name.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

const std::vector<std::string> names{"run", "simulate", "plan", "replay", "record", "monitor", "map"};

TEST(NearestName, ATypingErrorIsCorrected) {
  EXPECT_EQ(nearest_name("simulat", names), "simulate");
  EXPECT_EQ(nearest_name("simualte", names), "simulate") << "two letters swapped";
  EXPECT_EQ(nearest_name("rnu", names), "run");
  EXPECT_EQ(nearest_name("reply", names), "replay");
  EXPECT_EQ(nearest_name("mpa", names), "map");
  EXPECT_EQ(nearest_name("moniter", names), "monitor");
}

TEST(NearestName, AnAbbreviationIsCompletedIfItIsUnambiguous) {
  EXPECT_EQ(nearest_name("mon", names), "monitor");
  EXPECT_EQ(nearest_name("re", names), "") << "replay or record";
}

TEST(NearestName, AWordThatResemblesNoNameIsNotCorrected) {
  for (const char* text : {"", "x", "fly", "castle", "simultaneous"})
    EXPECT_EQ(nearest_name(text, names), "") << text;
  EXPECT_EQ(nearest_name(std::string(100'000, 'r'), names), "");
}

}  // namespace
}  // namespace coppice
