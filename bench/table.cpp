#include "bench/table.h"

#include <algorithm>
#include <regex>

#include <fmt/format.h>

namespace coppice {

std::string as_csv(const Table& table) {
  std::string text = fmt::format("{}\n", fmt::join(table.header, ","));
  for (const auto& row : table.rows) text += fmt::format("{}\n", fmt::join(row, ","));
  return text;
}

std::string as_markdown(const Table& table) {
  std::vector<std::size_t> width;
  for (std::size_t c = 0; c < table.header.size(); ++c) {
    width.push_back(table.header[c].size());
    for (const auto& row : table.rows) width[c] = std::max(width[c], row[c].size());
  }
  const auto line = [&](const std::vector<std::string>& cells) {
    std::string text = "|";
    for (std::size_t c = 0; c < cells.size(); ++c) text += fmt::format(" {:<{}} |", cells[c], width[c]);
    return text + "\n";
  };
  std::string text = line(table.header);
  text += "|";
  for (const std::size_t w : width) text += std::string(w + 2, '-') + "|";
  text += "\n";
  for (const auto& row : table.rows) text += line(row);
  return text;
}

std::string as_json(const Table& table) {
  static const std::regex number("-?[0-9]+([.][0-9]+)?");
  std::string text = "[";
  for (const auto& row : table.rows) {
    text += text.size() == 1 ? "\n {" : ",\n {";
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string quote = std::regex_match(row[c], number) ? "" : "\"";
      text += fmt::format("{}\"{}\": {}{}{}", c == 0 ? "" : ", ", table.header[c], quote, row[c], quote);
    }
    text += "}";
  }
  return text + "\n]\n";
}

}  // namespace coppice
