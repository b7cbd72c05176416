// Tests of the limit for wrong tokens.

#include "monitor/server/login_guard.h"

#include <string>

#include <gtest/gtest.h>

namespace coppice {
namespace {

using Verdict = LoginGuard::Verdict;

int heard(LoginGuard& guard, const std::string& address, int wrong_ones, double from, double until) {
  int count = 0;
  for (int k = 0; k < wrong_ones; ++k)
    count += guard.on(address, false, from + k * (until - from) / wrong_ones) == Verdict::heard;
  return count;
}

TEST(LoginGuard, SomeWrongTokensAreHeardAtOnceAndThenOneInSixSeconds) {
  LoginGuard guard;
  EXPECT_EQ(guard.wait("a", 0), 0);
  EXPECT_EQ(heard(guard, "a", 100, 0, 0), 10);
  EXPECT_DOUBLE_EQ(guard.wait("a", 0), 6);
  EXPECT_NEAR(heard(guard, "a", 100'000, 0, 600), 100, 1);
  EXPECT_EQ(heard(guard, "a", 100, 1e6, 1e6), 10) << "after a long time";
}

TEST(LoginGuard, AddressesDoNotDisturbEachOther) {
  LoginGuard guard;
  heard(guard, "a", 100, 0, 0);
  EXPECT_EQ(guard.on("b", true, 0), Verdict::heard);
  EXPECT_EQ(guard.on("c", false, 0), Verdict::heard);
}

TEST(LoginGuard, WhatIsShownBeyondTheLimitIsNotLookedAt) {
  LoginGuard guard;
  heard(guard, "a", 10, 0, 0);
  EXPECT_EQ(guard.on("a", true, 0), Verdict::limited);
  EXPECT_EQ(guard.on("a", true, 6), Verdict::heard);
}

TEST(LoginGuard, AnOperatorIsHeardWhateverOthersAtTheAddressDo) {
  LoginGuard guard;
  guard.on("a", true, 0);
  heard(guard, "a", 1000, 1, 1);
  EXPECT_EQ(guard.on("a", true, 1), Verdict::heard);
  EXPECT_EQ(guard.on("a", false, 1), Verdict::limited);
}

TEST(LoginGuard, ItForgetsTheOldestOfVeryManyAddresses) {
  LoginGuard guard;
  heard(guard, "first", 10, 0, 0);
  for (std::size_t k = 0; k < LoginGuard::most; ++k) guard.on(std::to_string(k), false, 1);
  EXPECT_EQ(guard.wait("first", 1), 0);
}

}  // namespace
}  // namespace coppice
