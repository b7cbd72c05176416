// How old states are when they are used: counts by age, from which shares follow to within a tenth.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace coppice {

class AgeCount {
 public:
  /// Seconds. One that clocks make negative counts as new.
  void add(double age) {
    const double bin = std::log2(std::max(age, least) / least) * bins_a_doubling;
    ++bins_[std::min(bins_.size() - 1, static_cast<std::size_t>(bin))];
    ++count_;
    most_ = std::max(most_, age);
  }

  /// An age that this share of all does not exceed; 0 if there is none.
  double at_share(double share) const {
    const double rank = share * static_cast<double>(count_);
    std::uint64_t below = 0;
    for (std::size_t k = 0; k < bins_.size(); ++k) {
      below += bins_[k];
      if (below > 0 && static_cast<double>(below) >= rank)
        return std::min(most_, least * std::exp2(static_cast<double>(k + 1) / bins_a_doubling));
    }
    return 0;
  }
  double most() const { return most_; }

 private:
  static constexpr double least = 1e-4;         // seconds
  static constexpr double bins_a_doubling = 8;  // 9 % each

  std::array<std::uint64_t, 192> bins_{};  ///< up to half an hour
  std::uint64_t count_ = 0;
  double most_ = 0;
};

}  // namespace coppice
