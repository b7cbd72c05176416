// Manual pages (man 7 groff_man) of a program, from the texts of its --help.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace coppice {

struct ManualPage {
  std::string name;  ///< as in `man coppice-run`
  std::string text;
};

/// One page for the program, and one for each of its commands. Section 1.
std::vector<ManualPage> manual_pages(const CLI::App& program);

}  // namespace coppice
