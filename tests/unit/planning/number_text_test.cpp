// Tests of numbers as text.
#include "planning/number_text.h"

#include <limits>

#include <gtest/gtest.h>

namespace coppice {
namespace {

TEST(NumberText, DecimalNumbersAreRead) {
  EXPECT_EQ(decimal_number("12"), 12);
  EXPECT_EQ(decimal_number("-0.5"), -0.5);
  EXPECT_EQ(decimal_number("+.5"), 0.5);
  EXPECT_EQ(decimal_number("5."), 5);
  EXPECT_EQ(decimal_number("1e-3"), 1e-3);
}

TEST(NumberText, OtherTextIsNoNumber) {
  for (const char* const text : {"", "+", "-", "+-1", "++1", " 1", "1 ", "1,5", "1.000,5", "0x10", "one",
                                 "nan", "inf", ".inf", "1e999", "1m"})
    EXPECT_FALSE(decimal_number(text)) << text;
}

TEST(NumberText, NumbersArePrintedInFewDigits) {
  EXPECT_EQ(number_text(0.22018750000000001), "0.220188");
  EXPECT_EQ(number_text(0.22018750000000001, 4), "0.2202");
  EXPECT_EQ(number_text(1e9), "1e+09");
  EXPECT_EQ(number_text(0.5), "0.5");
  EXPECT_EQ(number_text(-0.000123456789), "-0.000123457");
  EXPECT_EQ(number_text(std::numeric_limits<double>::lowest(), 17), "-1.7976931348623157e+308");
}

TEST(NumberText, ComparedNumbersDifferAsTextIfTheyDiffer) {
  EXPECT_EQ(told_apart(0.21, 0.2201875), (std::pair<std::string, std::string>{"0.21", "0.2202"}));
  EXPECT_EQ(told_apart(0.22018, 0.2201875), (std::pair<std::string, std::string>{"0.22018", "0.22019"}));
  EXPECT_EQ(told_apart(0.3, 0.3), (std::pair<std::string, std::string>{"0.3", "0.3"}));
  const auto [a, b] = told_apart(1, 1 + std::numeric_limits<double>::epsilon());
  EXPECT_NE(a, b);
}

}  // namespace
}  // namespace coppice
