// A table of results, as CSV and JSON for programs and as Markdown for people.
#pragma once

#include <string>
#include <vector>

namespace coppice {

struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;  ///< each as long as the header
};

std::string as_csv(const Table& table);
std::string as_markdown(const Table& table);
/// An array with one object per row. Numbers stay numbers.
std::string as_json(const Table& table);

}  // namespace coppice
