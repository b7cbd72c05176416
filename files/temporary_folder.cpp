#include "files/temporary_folder.h"

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "coppice/files/input_error.h"

namespace coppice {

namespace {

[[noreturn]] void fail(const std::filesystem::path& folder, int problem) {
  throw InputError(fmt::format("{}: cannot hold temporary files: {} (set TMPDIR to another folder)",
                               folder.string(), std::generic_category().message(problem)));
}

}  // namespace

std::filesystem::path place_for_temporary_files() {
  const char* const named = std::getenv("TMPDIR");
  const std::filesystem::path folder = named != nullptr && *named != '\0' ? named : "/tmp";
  if (::access(folder.c_str(), F_OK) != 0) fail(folder, errno);
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored)) fail(folder, ENOTDIR);
  if (::access(folder.c_str(), W_OK | X_OK) != 0) fail(folder, errno);
  return std::filesystem::absolute(folder);
}

TemporaryFolder::TemporaryFolder() {
  const std::filesystem::path place = place_for_temporary_files();
  std::string name = (place / "coppice-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) fail(place, errno);
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace coppice
