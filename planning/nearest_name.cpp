#include "planning/nearest_name.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace coppice {

namespace {

/// The optimal string alignment distance: that of Damerau and Levenshtein, with no letter changed twice.
std::size_t changes_between(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> least(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        least[i][j] = i + j;
        continue;
      }
      const std::size_t other = a[i - 1] == b[j - 1] ? 0 : 1;
      least[i][j] = std::min({least[i - 1][j] + 1, least[i][j - 1] + 1, least[i - 1][j - 1] + other});
      const bool are_swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (are_swapped) least[i][j] = std::min(least[i][j], least[i - 2][j - 2] + 1);
    }
  }
  return least[a.size()][b.size()];
}

constexpr std::size_t longest_name = 64;  // longer texts are not misspelt names

}  // namespace

std::string nearest_name(std::string_view misspelt, std::span<const std::string> names) {
  if (misspelt.size() < 2 || misspelt.size() > longest_name) return {};
  std::string nearest;
  std::size_t fewest = std::max<std::size_t>(1, misspelt.size() / 3) + 1;
  for (const std::string& name : names) {
    const std::size_t changes = changes_between(misspelt, name);
    if (changes >= fewest) continue;
    fewest = changes;
    nearest = name;
  }
  const auto begins_so = [&](const std::string& name) { return name.starts_with(misspelt); };
  if (nearest.empty() && std::ranges::count_if(names, begins_so) == 1)
    return *std::ranges::find_if(names, begins_so);
  return nearest;
}

}  // namespace coppice
