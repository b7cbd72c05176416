#include "files/number_check.h"

#include <cmath>
#include <string>

#include <fmt/format.h>

namespace coppice {

namespace {

template <class Fine>
CLI::Validator number(Fine&& fine, const std::string& expected, const std::string& type) {
  return {[=](std::string& text) {
            double value = 0;
            const bool is_number = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
            return is_number && fine(value)
                       ? std::string()
                       : fmt::format("{} is not allowed, expected a number {}", text, expected);
          },
          type};
}

}  // namespace

CLI::Validator number_between(double least, double most) {
  return number([=](double x) { return x >= least && x <= most; }, fmt::format("from {} to {}", least, most),
                fmt::format("{} to {}", least, most));
}

CLI::Validator number_above_zero() {
  return number([](double x) { return x > 0; }, "above 0", "above 0");
}

CLI::Validator number_not_negative() {
  return number([](double x) { return x >= 0; }, "of at least 0", "0 or more");
}

}  // namespace coppice
