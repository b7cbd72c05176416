// Parses whole numbers.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace coppice {

/// The number if `text` consists only of decimal digits (with a sign for negative values) and the value is
/// from `least` to `most`.
template <class T>
std::optional<T> whole_number(std::string_view text, T least, T most) {
  T value{};
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = problem == std::errc() && end == text.data() + text.size();
  return is_number && value >= least && value <= most ? std::optional<T>(value) : std::nullopt;
}

}  // namespace coppice
