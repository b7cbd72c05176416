// The newest state of each thing that clients of the API hear of, in the order of their changes.
//
// A client remembers the number of the last change that it was sent. So the board keeps nothing for a slow
// client: that client misses states in between, and never the newest one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

namespace coppice {

class EventBoard {
 public:
  /// `kind`: "order", "robot" or "halt"; `key`: which one; `data`: its state, in one line. A state that is
  /// the last one changes nothing.
  void post(const std::string& kind, const std::string& key, std::string data);
  /// Says no more of it.
  void remove(const std::string& kind, const std::string& key);

  /// The server-sent events (HTML standard, 9.2) of changes after number `seen`, which it moves on. It ends
  /// with the first event with which it has `enough` bytes. Empty: there are none.
  std::string after(std::uint64_t& seen, std::size_t enough) const;

 private:
  using Name = std::pair<std::string, std::string>;  ///< kind and key
  struct Event {
    Name name;
    std::string data;
  };
  std::map<std::uint64_t, Event> events_;  ///< by the number of the change
  std::map<Name, std::uint64_t> numbers_;
  std::uint64_t changes_ = 0;
};

}  // namespace coppice
