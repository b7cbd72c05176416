// What of the messages that a role hears and says is kept for whoever takes its place.
#pragma once

#include <utility>
#include <vector>

#include "messages/messages.h"

namespace coppice {

enum class Keep : unsigned char {
  nothing,
  append,
  begin_anew,  ///< this one, and nothing that was kept before
};

/// On disk it is a journal (journal.h).
struct KeptInMemory {
  void keep(Keep choice, const Message& message) {
    if (choice == Keep::begin_anew) messages.clear();
    if (choice != Keep::nothing) messages.push_back(message);
  }
  std::vector<Message> messages{};
};

/// Of a role that nobody will take the place of.
struct KeepsNothing {
  void heard(const Message&) {}
  void said(const Message&) {}
};

/// Puts what a role's chooser (robot_agent/saved_state.h and the like) finds worth keeping into a store.
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
