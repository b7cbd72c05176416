// The history of a fleet's orders: a file with a line of JSON for each change of an order's status. A long
// file is set aside under the name FILE.1, in place of the one before, and another one begins.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <unordered_set>

#include "messages/messages.h"
#include "runtime/disk_file.h"

namespace coppice {

/// Bytes of a file of the history: some five thousand changes.
inline constexpr std::size_t longest_history = 2 << 20;

class OrderHistory {
 public:
  /// Appends to the file, or creates it. Throws std::runtime_error, which names the file, if it cannot be
  /// opened.
  explicit OrderHistory(std::filesystem::path file, std::size_t longest = longest_history);

  /// Writes the status of an order, unless the files have it already: a restarted service says again what the
  /// one before it said. What a full disk has no room for is left out; that is logged, and so is its end.
  void said(const Message& message);

 private:
  bool write(const std::string& line);
  void set_aside();

  std::filesystem::path path_;
  std::size_t longest_;
  DiskFile file_;
  std::size_t end_ = 0;
  std::unordered_set<std::size_t> written_;  ///< hashes of the lines of this file
  std::unordered_set<std::size_t> before_;   ///< of the one before
  bool has_gap_ = false;                     ///< the last line was not written
};

}  // namespace coppice
