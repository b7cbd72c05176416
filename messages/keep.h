// Keeps the messages that the successor of a role needs.
#pragma once

#include <utility>
#include <vector>

#include "messages/messages.h"

namespace coppice {

enum class Keep : unsigned char {
  nothing,
  append,
  begin_anew,  ///< keep this message, and drop all before it
};

/// A store in memory. A journal (runtime/journal.h) is the same on disk.
struct KeptInMemory {
  void keep(Keep choice, const Message& message) {
    if (choice == Keep::begin_anew) messages.clear();
    if (choice != Keep::nothing) messages.push_back(message);
  }
  std::vector<Message> messages{};
};

/// For a role without a successor.
struct KeepsNothing {
  void heard(const Message&) {}
  void said(const Message&) {}
};

/// Puts the messages that a chooser selects (StateKeeper in robot_agent/saved_state.h and the like) into a
/// store.
template <class Chooser, class Store>
class Keeper {
 public:
  /// `store`: null: keeps nothing.
  Keeper(Chooser chooser, Store* store) : chooser_(std::move(chooser)), store_(store) {}

  void heard(const Message& message) {
    if (store_ != nullptr) store_->keep(chooser_.heard(message), message);
  }
  void said(const Message& message) {
    if (store_ != nullptr) store_->keep(chooser_.said(message), message);
  }

 private:
  Chooser chooser_;
  Store* store_;
};

}  // namespace coppice
