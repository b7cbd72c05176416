// The history of a fleet's orders: a file with a line of JSON for each change of an order's status.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <unordered_set>

#include "messages/messages.h"

namespace coppice {

class OrderHistory {
 public:
  /// Appends to the file, or creates it. Throws std::runtime_error, which names the file, if it cannot be
  /// read or written.
  explicit OrderHistory(const std::filesystem::path& file);

  /// Writes the status of an order, unless the file has it already: a restarted service says again what the
  /// one before it said. What cannot be written is logged once.
  void said(const Message& message);

 private:
  std::string file_;
  std::unordered_set<std::size_t> written_;  ///< hashes of all lines
  std::ofstream out_;
  bool has_failed_ = false;
};

}  // namespace coppice
