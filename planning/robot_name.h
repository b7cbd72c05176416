// Rules for the name of a robot, which appears in files, topics and logs.
#pragma once

#include <algorithm>
#include <string_view>

namespace coppice {

inline constexpr std::size_t longest_robot_name = 64;

inline constexpr std::string_view robot_name_rule =
    "1 to 64 printable characters without spaces, slashes, commas and double quotes, the first of them not a "
    "hyphen";

inline bool is_robot_name(std::string_view name) {
  const auto allowed = [](char c) { return c > ' ' && c < 127 && c != '/' && c != ',' && c != '"'; };
  // A name that begins like an option could not be given to commands.
  return !name.empty() && name.front() != '-' && name.size() <= longest_robot_name &&
         std::ranges::all_of(name, allowed);
}

}  // namespace coppice
