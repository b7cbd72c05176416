// Numbers the names of robots in the order in which they come, and finds the number of a name.
//
// Each received message looks up a name, in each of many agents of one process. So the table is flat and
// small (open addressing with linear probing), and short names are their own keys. std::unordered_map would
// read four cache lines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "messages/messages.h"

namespace coppice {

class NameIndex {
 public:
  std::optional<std::size_t> find(const RobotName& name) const {
    if (slots_.empty()) return std::nullopt;
    const Slot& slot = slots_[slot_of(name, key_of(name))];
    return slot.number == none ? std::nullopt : std::optional<std::size_t>(slot.number);
  }

  /// The number of the name, and whether it is a new one.
  std::pair<std::size_t, bool> insert(const RobotName& name) {
    if (2 * (names_.size() + 1) > slots_.size()) grow();
    const std::uint64_t key = key_of(name);
    Slot& slot = slots_[slot_of(name, key)];
    if (slot.number != none) return {slot.number, false};
    slot = {key, static_cast<std::uint32_t>(names_.size())};
    names_.push_back(name);
    return {slot.number, true};
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t number = none;
  };

  static bool is_short(const RobotName& name) { return name.size() <= 7; }
  /// The letters of a short name after a 1; of a long one its hash, which does not begin like that.
  static std::uint64_t key_of(const RobotName& name) {
    if (!is_short(name)) return std::hash<RobotName>{}(name) | std::uint64_t{1} << 63;
    std::uint64_t key = 1;
    for (const char letter : name) key = key << 8 | static_cast<unsigned char>(letter);
    return key;
  }
  /// Where the name is, or may be put.
  std::size_t slot_of(const RobotName& name, std::uint64_t key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = (key * 0x9e3779b97f4a7c15U >> 32) & mask;
    while (slots_[at].number != none &&
           (slots_[at].key != key || (!is_short(name) && names_[slots_[at].number] != name)))
      at = (at + 1) & mask;
    return at;
  }
  void grow() {
    slots_.assign(slots_.empty() ? 16 : 2 * slots_.size(), Slot{});
    for (std::uint32_t k = 0; k < names_.size(); ++k) {
      const std::uint64_t key = key_of(names_[k]);
      slots_[slot_of(names_[k], key)] = {key, k};
    }
  }

  std::vector<RobotName> names_;
  std::vector<Slot> slots_;  ///< a power of two of them, at most half of them full
};

}  // namespace coppice
