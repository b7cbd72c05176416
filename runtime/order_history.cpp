#include "runtime/order_history.h"

#include <functional>
#include <stdexcept>

#include <spdlog/spdlog.h>

#include "messages/order_json.h"

namespace coppice {

namespace {

std::size_t hash_of(const std::string& line) {
  return std::hash<std::string>()(line);
}

}  // namespace

OrderHistory::OrderHistory(const std::filesystem::path& file) : file_(file.string()) {
  bool is_cut = false;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    is_cut = in.eof();  // the process was killed in the middle of this line
    if (!is_cut) written_.insert(hash_of(line));
  }
  out_.open(file, std::ios::app);
  if (is_cut) out_ << '\n';
  if (!out_.flush()) throw std::runtime_error(file_ + ": cannot be written");
}

void OrderHistory::said(const Message& message) {
  const auto* const status = std::get_if<OrderStatus>(&message);
  if (status == nullptr) return;
  const std::string line = json_of(*status);
  if (!written_.insert(hash_of(line)).second) return;
  out_ << line << std::endl;
  if (out_ || has_failed_) return;
  has_failed_ = true;
  spdlog::error("{}: cannot be written: the history of orders has a gap from here on", file_);
}

}  // namespace coppice
