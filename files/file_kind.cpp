#include "files/file_kind.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "coppice/files/input_error.h"

namespace coppice {

namespace {

constexpr std::size_t enough = 4096;  // bytes; enough to recognise a kind of file

using namespace std::string_view_literals;

/// Whether a line of `text` begins with `word`.
bool has_line(std::string_view text, std::string_view word) {
  for (auto at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
    if (at == 0 || text[at - 1] == '\n') return true;
  }
  return false;
}

/// Whether the text has a JSON field of this name.
bool has_field(std::string_view text, std::string_view name) {
  const std::string quoted = fmt::format("\"{}\"", name);
  for (auto at = text.find(quoted); at != std::string_view::npos; at = text.find(quoted, at + 1)) {
    const auto next = text.find_first_not_of(" \t\r\n", at + quoted.size());
    if (next != std::string_view::npos && text[next] == ':') return true;
  }
  return false;
}

/// "version 1", as Moving AI scenarios begin; the number may be fractional.
bool is_scen_version(std::string_view text) {
  constexpr std::string_view word = "version";
  if (!text.starts_with(word)) return false;
  const auto number = text.find_first_not_of(" \t", word.size());
  return number != std::string_view::npos && number > word.size() &&
         std::isdigit(static_cast<unsigned char>(text[number])) != 0;
}

/// A kind of file in words, and advice on how to use such a file.
struct Words {
  const char* kind;
  const char* advice;
};
Words words_of(FileKind kind) {
  switch (kind) {
    case FileKind::empty:
      return {"empty", ""};
    case FileKind::map:
      return {"a Moving AI map", ": coppice map FILE OUT.json makes a scenario on it"};
    case FileKind::ros_map:
      return {"a ROS map", ": coppice map FILE OUT.json makes a scenario on it"};
    case FileKind::scenario:
      return {"a scenario", ": coppice run, simulate and plan take it"};
    case FileKind::scen:
      return {"a Moving AI scenario", ": coppice run, simulate and plan take it"};
    case FileKind::recording:
      return {"a recording", ": coppice monitor FILE shows it"};
    case FileKind::report:
      return {"a report of a run", ""};
    case FileKind::trajectory:
      return {"a trajectory of a run", ""};
    case FileKind::picture:
      return {"a picture", ""};
    case FileKind::unknown:
      break;
  }
  return {"of an unknown kind", ""};
}

/// The first bytes of a file. Nothing for a pipe or a device, which cannot be read a second time.
std::optional<std::string> beginning_of(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw InputError(fmt::format("{}: is a folder, expected a file", path.string()));
  // A writer may end a pipe as soon as the pipe was opened once.
  if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored))
    return std::nullopt;
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(fmt::format("{}: cannot be read: {}", path.string(), std::strerror(errno)));
  std::array<char, enough> block{};
  in.read(block.data(), block.size());
  return std::string(block.data(), static_cast<std::size_t>(in.gcount()));
}

}  // namespace

FileKind kind_of_file(std::string_view begin) {
  if (begin.starts_with("\xEF\xBB\xBF")) begin.remove_prefix(3);
  const auto begins_with_one_of = [&](std::initializer_list<std::string_view> marks) {
    return std::ranges::any_of(marks, [&](std::string_view mark) { return begin.starts_with(mark); });
  };
  if (begin.starts_with("\x89MCAP"sv)) return FileKind::recording;
  if (begins_with_one_of({"\x89PNG"sv, "\xFF\xD8\xFF"sv, "GIF8"sv, "P2\n"sv, "P5\n"sv, "P2 "sv, "P5 "sv,
                          "<svg"sv, "<?xml"sv, "BM"sv}))
    return FileKind::picture;
  const auto text = begin.find_first_not_of(" \t\r\n");
  if (text == std::string_view::npos) return FileKind::empty;
  if (begin.starts_with("type ")) return FileKind::map;
  if (is_scen_version(begin)) return FileKind::scen;
  if (begin.starts_with("time,robot,")) return FileKind::trajectory;
  if (begin[text] == '{') {
    // Every report says its outcome. Only a scenario says where robots start.
    if (has_field(begin, "outcome") && !has_field(begin, "start")) return FileKind::report;
    if (has_field(begin, "image") && has_field(begin, "resolution")) return FileKind::ros_map;  // flow YAML
    return has_field(begin, "map") || has_field(begin, "robots") ? FileKind::scenario : FileKind::unknown;
  }
  if (has_line(begin, "image:") && has_line(begin, "resolution:")) return FileKind::ros_map;
  return FileKind::unknown;
}

void refuse_other_kinds(const std::filesystem::path& path, std::initializer_list<FileKind> fitting,
                        const std::string& expected) {
  const auto begin = beginning_of(path);
  const FileKind kind = begin ? kind_of_file(*begin) : FileKind::unknown;
  if (kind == FileKind::unknown || std::ranges::count(fitting, kind) > 0) return;
  const Words words = words_of(kind);
  throw InputError(
      fmt::format("{}: is {}, expected {}{}", path.string(), words.kind, expected, words.advice));
}

}  // namespace coppice
