#include "bench/table.h"

#include <algorithm>
#include <regex>

#include <fmt/format.h>

namespace coppice {

namespace {

/// A cell with a comma or a quote stands in quotes (RFC 4180).
std::string csv_cell(const std::string& cell) {
  if (cell.find_first_of(",\"\n") == std::string::npos) return cell;
  std::string quoted = "\"";
  for (const char c : cell) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::vector<std::string> quoted;
  for (const std::string& cell : cells) quoted.push_back(csv_cell(cell));
  return fmt::format("{}\n", fmt::join(quoted, ","));
}

}  // namespace

std::string as_csv(const Table& table) {
  std::string text = csv_line(table.header);
  for (const auto& row : table.rows) text += csv_line(row);
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
