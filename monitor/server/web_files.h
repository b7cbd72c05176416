// The page's files, built into the program (monitor/web/dist).
#pragma once

#include <span>
#include <string_view>

namespace coppice {

struct WebFile {
  std::string_view path;  ///< from the root, as "/index.html"
  std::string_view bytes;
};

std::span<const WebFile> web_files();

}  // namespace coppice
