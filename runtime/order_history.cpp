#include "runtime/order_history.h"

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <functional>
#include <span>
#include <system_error>
#include <utility>

#include <spdlog/spdlog.h>

#include "messages/order_json.h"

namespace coppice {

namespace {

std::size_t hash_of(const std::string& line) {
  return std::hash<std::string>()(line);
}

std::filesystem::path aside(const std::filesystem::path& file) {
  return file.string() + ".1";
}

/// Of its whole lines. The process may have been killed in the middle of the last one.
std::unordered_set<std::size_t> lines_of(const std::filesystem::path& file) {
  std::unordered_set<std::size_t> lines;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (!in.eof()) lines.insert(hash_of(line));
  }
  return lines;
}

}  // namespace

OrderHistory::OrderHistory(std::filesystem::path file, std::size_t longest)
    : path_(std::move(file)),
      longest_(longest),
      file_(path_),
      end_(file_.size()),
      written_(lines_of(path_)),
      before_(lines_of(aside(path_))) {
  const bool is_cut = end_ > 0 && file_.read(end_ - 1, 1) != std::vector<std::uint8_t>{'\n'};
  if (is_cut) write("");
}

bool OrderHistory::write(const std::string& line) {
  const std::string whole = line + '\n';
  if (file_.write(end_, {reinterpret_cast<const std::uint8_t*>(whole.data()), whole.size()})) {
    end_ += whole.size();
    return true;
  }
  const int error = errno;
  file_.cut(end_);
  errno = error;
  return false;
}

void OrderHistory::said(const Message& message) {
  const auto* const status = std::get_if<OrderStatus>(&message);
  // What cannot be saved is no order yet: its sender gives it again.
  if (status == nullptr || (is_refused(*status) && status->reason.starts_with(cannot_be_saved))) return;
  const std::string line = json_of(*status);
  const std::size_t hash = hash_of(line);
  if (written_.contains(hash) || before_.contains(hash)) return;
  if (write(line)) {
    written_.insert(hash);
    if (std::exchange(has_gap_, false)) spdlog::info("{}: the history of orders goes on", path_.string());
    if (end_ >= longest_) set_aside();
  } else if (!std::exchange(has_gap_, true)) {
    spdlog::error("{}: cannot be written: {}: the history of orders has a gap from here on", path_.string(),
                  std::strerror(errno));
  }
}

/// If that fails, the file goes on, and this is tried again.
void OrderHistory::set_aside() {
  std::error_code problem;
  std::filesystem::rename(path_, aside(path_), problem);
  if (problem) return;
  try {
    file_ = DiskFile(path_);
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
    std::filesystem::rename(aside(path_), path_, problem);
    return;
  }
  end_ = 0;
  before_ = std::exchange(written_, {});
}

}  // namespace coppice
