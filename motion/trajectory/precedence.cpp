#include "motion/trajectory/precedence.h"

namespace coppice {

std::vector<Path> legs_of(const Path& way) {
  std::vector<Path> legs;
  for (std::size_t k = 1; k < way.size(); ++k) {
    const Point2 out = way[k] - way[k - 1];
    const bool goes_on = !legs.empty() && out.dot(legs.back().back() - *(legs.back().end() - 2)) > 0;
    if (!goes_on) legs.push_back({way[k - 1]});
    legs.back().push_back(way[k]);
  }
  return legs;
}

}  // namespace coppice
