// The saved state of a broker, from which a successor continues: the map, all inactive trees on it, and
// whether a broker has found the map covered by them.
#pragma once

#include <set>
#include <span>
#include <string>

#include "messages/keep.h"
#include "messages/messages.h"

namespace coppice {

class ForestRecord {
 public:
  /// Continues from saved messages.
  void recall(std::span<const Message> kept);
  Keep heard(const Message& message);
  Keep said(const Message& message) { return heard(message); }

 private:
  std::string map_id_;
  std::set<TreesId> trees_;
  bool covered_ = false;
};

}  // namespace coppice
