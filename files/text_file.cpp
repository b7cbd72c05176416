#include "files/text_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <locale>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "coppice/files/input_error.h"

namespace coppice {

namespace {

// The largest map as a plain picture fits. The limit ends the reading of a device that never ends.
constexpr std::size_t largest_file = std::size_t{2} << 30;
constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";  // of UTF-8
constexpr std::size_t longest_letter = 4;                     // bytes of a character in UTF-32

bool wrote(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write) {
  std::ofstream out(file, std::ios::binary);
  out.imbue(std::locale::classic());  // the program's may group digits
  write(out);
  out.close();
  return !out.fail();
}

/// What was written survives a loss of power, where the disk can do that. A folder: what was renamed in it.
void put_on_disk(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

std::string read_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw InputError(fmt::format("{}: is a folder, expected a file", path.string()));
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(fmt::format("{}: cannot be read: {}", path.string(), std::strerror(errno)));
  std::string content;
  std::array<char, 65536> block{};
  while (in.read(block.data(), block.size()) || in.gcount() > 0) {
    content.append(block.data(), static_cast<std::size_t>(in.gcount()));
    if (content.size() > largest_file)
      throw InputError(fmt::format("{}: expected at most {} bytes", path.string(), largest_file));
  }
  if (in.bad()) throw InputError(fmt::format("{}: reading failed", path.string()));
  return content;
}

std::string read_text(const std::filesystem::path& path) {
  std::string text = read_file(path);
  if (text.starts_with(byte_order_mark)) text.erase(0, byte_order_mark.size());
  // UTF-16 and UTF-32 encode the ASCII characters of our formats with zero bytes, with and without a
  // byte-order mark.
  const bool is_wide =
      text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff") || text.find('\0') < longest_letter;
  if (is_wide)
    throw InputError(fmt::format("{}:1: is UTF-16, UTF-32 or not text, expected UTF-8", path.string()));
  return text;
}

std::string ending_of(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

std::filesystem::path written_file(const std::filesystem::path& path) {
  constexpr int most_links = 40;  // as many as the kernel follows
  std::filesystem::path file = path;
  std::error_code problem;
  for (int k = 0; k < most_links && std::filesystem::is_symlink(file, problem); ++k) {
    const std::filesystem::path target = std::filesystem::read_symlink(file, problem);
    file = target.is_absolute() ? target : file.parent_path() / target;
  }
  return file;
}

void write_file(const std::filesystem::path& path, std::string_view content) {
  write_file(path, [&](std::ostream& out) {
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
  });
}

void write_file(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write) {
  namespace fs = std::filesystem;
  std::error_code problem;
  const fs::path file = written_file(path);
  if (fs::exists(file, problem) && !fs::is_regular_file(file, problem)) {  // a device, or a pipe
    if (!wrote(path, write)) throw InputError(fmt::format("{}: cannot be written", path.string()));
    return;
  }
  const fs::path temporary = file.string() + fmt::format(".{}.tmp", ::getpid());
  if (!wrote(temporary, write)) {
    std::remove(temporary.c_str());
    throw InputError(
        fmt::format("{}: cannot be written (does the folder exist, is there room?)", path.string()));
  }
  put_on_disk(temporary);
  fs::rename(temporary, file, problem);
  put_on_disk(file.has_parent_path() ? file.parent_path() : ".");
  if (problem) {
    std::remove(temporary.c_str());
    throw InputError(fmt::format("{}: cannot be written: {}", path.string(), problem.message()));
  }
}

}  // namespace coppice
