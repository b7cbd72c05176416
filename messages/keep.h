// Keeps the messages that the successor of a role needs.
#pragma once

#include <utility>
#include <vector>

#include "messages/messages.h"

namespace coppice {

enum class Keep : unsigned char {
  nothing,
  append,
  append_surely,  ///< as append, and it has to outlive a loss of power: somebody will be told of it
  begin_anew,     ///< keep this message, and drop all before it
};

/// A store in memory. A journal (runtime/journal.h) is the same on disk.
struct KeptInMemory {
  bool keep(Keep choice, const Message& message) {
    if (choice == Keep::begin_anew) messages.clear();
    if (choice != Keep::nothing) messages.push_back(message);
    return true;
  }
  std::vector<Message> messages{};
};

/// For a role without a successor.
struct KeepsNothing {
  void heard(const Message&) {}
  void said(const Message&) {}
};

/// Puts the messages that a chooser selects (StateKeeper in robot_agent/control/saved_state.h and the like)
/// into a store. A chooser with a `snapshot` knows what all kept messages amount to, and a long store is
/// rewritten with that. A chooser with a `slim` leaves out what no successor needs.
template <class Chooser, class Store>
class Keeper {
 public:
  /// `store`: null: keeps nothing.
  Keeper(Chooser chooser, Store* store) : chooser_(std::move(chooser)), store_(store) {}

  void heard(const Message& message) {
    if (store_ != nullptr) keep(chooser_.heard(message), message);
  }
  void said(const Message& message) {
    if (store_ != nullptr) keep(chooser_.said(message), message);
  }
  /// Call it before anybody hears of what was kept.
  void sync() {
    if constexpr (requires { store_->sync(); }) {
      if (store_ != nullptr) store_->sync();
    }
  }
  /// Null: it keeps nothing.
  Store* store() const { return store_; }
  /// Call it when there is time.
  void tidy() {
    if constexpr (rewrites) {
      if (store_ != nullptr && store_->wants_rewriting()) store_->rewrite(chooser_.snapshot());
    }
  }

 private:
  static constexpr bool rewrites = requires(Chooser chooser, Store store) {
    store.rewrite(chooser.snapshot());
  };

  void keep(Keep choice, const Message& message) {
    if (choice == Keep::nothing) return;
    bool is_kept = false;
    if constexpr (requires { chooser_.slim(message); }) {
      is_kept = store_->keep(choice, chooser_.slim(message));
    } else {
      is_kept = store_->keep(choice, message);
    }
    if constexpr (rewrites) {
      if (!is_kept) store_->rewrite(chooser_.snapshot());
    }
  }

  Chooser chooser_;
  Store* store_;
};

}  // namespace coppice
