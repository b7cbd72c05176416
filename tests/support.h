// Helpers of several tests: a temporary folder, a command's output, and paths of the build.
#pragma once

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include <sys/wait.h>

#include "files/temporary_folder.h"

namespace coppice::test {

/// A temporary folder into which files can be written.
class TemporaryFolder {
 public:
  const std::filesystem::path& path() const { return folder_.path(); }
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::ofstream(path() / name, std::ios::binary) << content;
    return path() / name;
  }

 private:
  coppice::TemporaryFolder folder_;
};

inline std::string contents(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct Outcome {
  int exit_code = 0;
  std::string output;  ///< standard output and error
};

/// Runs a shell command to its end.
inline Outcome shell(const std::string& command) {
  Outcome outcome;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("no shell");
  std::array<char, 4096> buffer{};
  while (const std::size_t n = fread(buffer.data(), 1, buffer.size(), pipe))
    outcome.output.append(buffer.data(), n);
  const int status = pclose(pipe);
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return outcome;
}

inline std::string program(const std::string& name) {
  return COPPICE_BIN_DIR "/" + name;
}
/// Whether to run tests that take minutes and show the same as shorter tests at full size.
inline bool wants_long_tests() {
  return std::getenv("COPPICE_LONG_TESTS") != nullptr;
}
inline constexpr const char* why_not_long = "takes long: set COPPICE_LONG_TESTS";

inline std::filesystem::path scenarios() {
  return std::filesystem::path(COPPICE_SOURCE_DIR) / "scenarios";
}

}  // namespace coppice::test
