// Numbers as text, both ways. The result does not depend on the locale of the program or of a stream.
#pragma once

#include <array>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace coppice {

/// The number if `text` is nothing but a decimal number: 12, -0.5, +.5, 1e-3. Infinite values and NaN are
/// none.
inline std::optional<double> decimal_number(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = problem == std::errc() && end == text.data() + text.size() && value - value == 0;
  return is_number ? std::optional(value) : std::nullopt;
}

/// As %g prints it, with so many significant digits at most.
inline std::string number_text(double value, int digits = 6) {
  std::array<char, 32> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, digits).ptr;
  return {text.data(), end};
}

/// Two numbers that a message compares: in few digits, but in so many that they differ if the numbers do.
inline std::pair<std::string, std::string> told_apart(double a, double b) {
  constexpr int few = 4;
  constexpr int exact = 17;
  for (int digits = few;; ++digits) {
    std::pair texts{number_text(a, digits), number_text(b, digits)};
    if (digits == exact || texts.first != texts.second || a == b) return texts;
  }
}

}  // namespace coppice
