#include "coppice/run/state_folder.h"

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "coppice/files/input_error.h"

namespace coppice {

namespace {

/// FNV-1a: the same at each start.
std::uint32_t short_hash(std::string_view text) {
  std::uint32_t hash = 0x811c9dc5u;
  for (const char c : text) hash = (hash ^ static_cast<std::uint8_t>(c)) * 0x01000193u;
  return hash;
}

std::filesystem::path variable(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr ? value : "";
}

/// The specification has relative paths ignored.
std::filesystem::path home_of_states() {
  if (const auto named = variable("XDG_STATE_HOME"); named.is_absolute()) return named;
  if (const auto home = variable("HOME"); home.is_absolute()) return home / ".local/state";
  throw InputError(
      "there is no place for the fleet's state, because HOME is not set: name a folder (--state)");
}

}  // namespace

std::filesystem::path usual_state_folder(const std::filesystem::path& site, std::optional<int> domain) {
  const std::filesystem::path file = std::filesystem::weakly_canonical(std::filesystem::absolute(site));
  const std::string on_domain = domain ? fmt::format("-domain-{}", *domain) : std::string();
  return home_of_states() / "coppice" /
         fmt::format("{}{}-{:08x}", file.stem().string(), on_domain, short_hash(file.string()));
}

FolderLock::FolderLock(const std::filesystem::path& folder) {
  const std::string file = (folder / "lock").string();
  descriptor_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) throw InputError(fmt::format("{}: cannot be written: {}", file, std::strerror(errno)));
  if (flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  close(descriptor_);
  throw InputError(
      fmt::format("{}: another fleet keeps its state there: end that one, or name another folder (--state)",
                  folder.string()));
}

FolderLock::~FolderLock() {
  close(descriptor_);
}

}  // namespace coppice
