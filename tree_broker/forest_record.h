// What a broker keeps, so that another one can take its place: the map, every inactive tree on it, and that
// somebody has found the map covered by them.
#pragma once

#include <set>
#include <span>
#include <string>

#include "messages/keep.h"
#include "messages/messages.h"

namespace coppice {

class ForestRecord {
 public:
  /// Goes on after what was kept before.
  void recall(std::span<const Message> kept);
  Keep heard(const Message& message);
  Keep said(const Message& message) { return heard(message); }

 private:
  std::string map_id_;
  std::set<TreeId> trees_;
  bool covered_ = false;
};

}  // namespace coppice
