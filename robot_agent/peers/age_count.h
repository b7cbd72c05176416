// A histogram of how old states are when they are used. An age at a share is at most a tenth too large.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace coppice {

class AgeCount {
 public:
  /// Counts an age in seconds. A negative age, which errors of clocks can cause, counts as 0.
  void add(double age) {
    const auto times = static_cast<float>(std::max(age, least) / least);
    ++bins_[std::min<std::size_t>(bins_.size() - 1, (std::bit_cast<std::uint32_t>(times) >> shift) - first)];
    ++count_;
    most_ = std::max(most_, age);
  }

  /// An age that this share of all ages does not exceed; 0 if none was counted.
  double at_share(double share) const {
    const double rank = share * static_cast<double>(count_);
    std::uint64_t below = 0;
    for (std::size_t k = 0; k < bins_.size(); ++k) {
      below += bins_[k];
      if (below > 0 && static_cast<double>(below) >= rank)
        return std::min(most_,
                        least * std::bit_cast<float>(static_cast<std::uint32_t>(k + 1 + first) << shift));
    }
    return 0;
  }
  double most() const { return most_; }

 private:
  static constexpr double least = 1e-4;  // seconds
  // The exponent of a float and the first bits of its fraction number a bin. So a bin is at most 6 % wide.
  static constexpr std::uint32_t bins_a_doubling = 16;
  static constexpr int shift = 23 - 4;
  static constexpr std::uint32_t first = std::bit_cast<std::uint32_t>(1.0F) >> shift;

  std::array<std::uint64_t, std::size_t{24} * bins_a_doubling> bins_{};  ///< up to half an hour
  std::uint64_t count_ = 0;
  double most_ = 0;
};

}  // namespace coppice
