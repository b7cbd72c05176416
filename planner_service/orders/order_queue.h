// The orders that have not ended, in the order in which they are served: the most urgent first, and of
// equally urgent ones the earliest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <ranges>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace coppice {

/// Adding and removing take logarithmic time: a restarted service recalls thousands of orders.
class OrderQueue {
 public:
  /// An order that it has keeps its turn.
  void add(const std::string& id, std::int32_t priority) {
    const auto [entry, is_new] = turns_.try_emplace(id, Turn{-std::int64_t{priority}, arrivals_});
    if (is_new) ids_.emplace(entry->second, id);
    arrivals_ += is_new;
  }
  void remove(const std::string& id) {
    const auto entry = turns_.find(id);
    if (entry == turns_.end()) return;
    ids_.erase(entry->second);
    turns_.erase(entry);
  }
  std::size_t size() const { return ids_.size(); }
  auto ids() const { return std::views::values(ids_); }
  /// For a loop that adds or removes orders.
  std::vector<std::string> copy() const { return {ids().begin(), ids().end()}; }

 private:
  using Turn = std::pair<std::int64_t, std::uint64_t>;  ///< how little urgent, and when it came

  std::map<Turn, std::string> ids_{};
  std::unordered_map<std::string, Turn> turns_{};
  std::uint64_t arrivals_ = 0;
};

}  // namespace coppice
