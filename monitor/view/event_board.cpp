#include "monitor/view/event_board.h"

#include <fmt/format.h>

namespace coppice {

void EventBoard::post(const std::string& kind, const std::string& key, std::string data) {
  const Name name{kind, key};
  if (const auto known = numbers_.find(name); known != numbers_.end()) {
    if (events_.at(known->second).data == data) return;
    events_.erase(known->second);
  }
  numbers_[name] = ++changes_;
  events_[changes_] = {name, std::move(data)};
}

void EventBoard::remove(const std::string& kind, const std::string& key) {
  const auto known = numbers_.find({kind, key});
  if (known == numbers_.end()) return;
  events_.erase(known->second);
  numbers_.erase(known);
}

std::string EventBoard::after(std::uint64_t& seen, std::size_t enough) const {
  std::string text;
  for (auto next = events_.upper_bound(seen); next != events_.end() && text.size() < enough; ++next) {
    text += fmt::format("event: {}\ndata: {}\n\n", next->second.name.first, next->second.data);
    seen = next->first;
  }
  return text;
}

}  // namespace coppice
