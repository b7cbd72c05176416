// The packages of npm that web tests need. tests/run installs them.
#pragma once

#include <filesystem>
#include <string>

#include "tests/support.h"

namespace coppice::test {

inline std::filesystem::path web_tests() {
  return std::filesystem::path(COPPICE_SOURCE_DIR) / "tests/web";
}
inline std::filesystem::path page_sources() {
  return std::filesystem::path(COPPICE_SOURCE_DIR) / "monitor/web";
}

/// What has to be installed for the package.json of a folder: packages that are not there, or whose version
/// is an older one. Empty: nothing.
inline std::string missing_packages(const std::filesystem::path& folder) {
  const Outcome found = shell("npm ls --prefix '" + folder.string() + "'");
  if (found.exit_code == 0) return {};
  return folder.string() + " needs packages that tests/run installs:\n" + found.output;
}

/// What has to be installed for tests in Debian's chromium, driven by playwright-core. Empty: nothing.
inline std::string missing_for_browser() {
  if (shell("command -v chromium").exit_code != 0) return "needs chromium, which tests/run installs";
  return missing_packages(web_tests());
}

}  // namespace coppice::test
