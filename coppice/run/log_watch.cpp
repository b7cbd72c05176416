#include "coppice/run/log_watch.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>

namespace coppice {

namespace {

constexpr std::array<std::string_view, 3> levels{"warning", "error", "critical"};
constexpr WallTime window = 10;           // seconds
constexpr int most_of_one = 3;            // lines of one process in a window
constexpr int most_of_all = 20;           // lines of all processes in a window
constexpr std::size_t most_read = 65536;  // bytes of a log per call; the rest is read later
constexpr std::size_t longest_line = 4096;
constexpr std::string_view agent_prefix = "robot-";

/// A robot's process is shown by the robot's name.
std::string_view shown(std::string_view process) {
  return process.starts_with(agent_prefix) ? process.substr(agent_prefix.size()) : process;
}

/// "DATE TIME LEVEL NAME: MESSAGE"
std::optional<std::string> warning_in_text(std::string_view line) {
  for (int k = 0; k < 2; ++k) {
    const std::size_t gap = line.find(' ');
    if (gap == std::string_view::npos) return std::nullopt;
    line.remove_prefix(gap + 1);
  }
  const std::string_view level = line.substr(0, line.find(' '));
  const std::size_t colon = line.find(": ");
  if (std::ranges::find(levels, level) == levels.end() || colon == std::string_view::npos)
    return std::nullopt;
  return fmt::format("{}: {}", level, line.substr(colon + 2));
}

}  // namespace

std::optional<std::string> warning_in(std::string_view line) {
  if (!line.starts_with('{')) return warning_in_text(line);
  const bool warns = std::ranges::any_of(levels, [&](std::string_view level) {
    return line.find(fmt::format(R"("level":"{}")", level)) != std::string_view::npos;
  });
  return warns ? std::optional<std::string>(line) : std::nullopt;
}

LogWatch::LogWatch(std::filesystem::path folder, const std::vector<std::string>& names, bool kept)
    : folder_(std::move(folder)), kept_(kept) {
  for (const std::string& name : names) logs_.emplace(name, Log());
}

std::vector<std::string> LogWatch::news(WallTime now) {
  std::vector<std::string> lines;
  if (now - window_begins_ >= window || now < window_begins_) begin_window(now, lines);
  for (auto& [name, log] : logs_) read(name, log, lines);
  return lines;
}

std::vector<std::string> LogWatch::last_news(WallTime now) {
  std::vector<std::string> lines = news(now);
  for (auto& [name, log] : logs_) {
    while (read(name, log, lines)) continue;
  }
  tell_held_back(lines);
  held_back_ = 0;
  return lines;
}

void LogWatch::tell_held_back(std::vector<std::string>& lines) const {
  if (held_back_ > 0)
    lines.push_back(kept_ ? fmt::format("{} more warnings are in {}", held_back_, folder_.string())
                          : fmt::format("{} more warnings (--logs DIR keeps them)", held_back_));
}

void LogWatch::begin_window(WallTime now, std::vector<std::string>& lines) {
  tell_held_back(lines);
  window_begins_ = now;
  passed_ = held_back_ = 0;
  for (auto& [name, log] : logs_) log.passed = 0;
}

/// Returns whether there was anything new in the log.
bool LogWatch::read(const std::string& name, Log& log, std::vector<std::string>& lines) {
  const std::filesystem::path file = folder_ / (name + ".log");
  std::error_code none;
  const std::uintmax_t size = std::filesystem::file_size(file, none);
  if (!none && size < log.read) log = {};  // the log began anew
  if (none || size <= log.read) return false;
  std::string text(std::min<std::uintmax_t>(size - log.read, most_read), '\0');
  std::ifstream in(file, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(log.read));
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  log.read += text.size();
  log.rest += text;
  for (std::size_t end = log.rest.find('\n'); end != std::string::npos; end = log.rest.find('\n')) {
    if (const auto warning = warning_in(std::string_view(log.rest).substr(0, end))) {
      const bool passes = log.passed < most_of_one && passed_ < most_of_all;
      ++(passes ? passed_ : held_back_);
      log.passed += passes;
      if (passes) lines.push_back(fmt::format("{}: {}", shown(name), *warning));
    }
    log.rest.erase(0, end + 1);
  }
  if (log.rest.size() > longest_line) log.rest.clear();
  return !text.empty();
}

}  // namespace coppice
