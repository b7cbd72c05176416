#include <algorithm>
#include <ctime>
#include <iostream>
#include <set>
#include <string>
#include <string_view>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "coppice/commands.h"
#include "monitor/recording/recording.h"

namespace coppice {

namespace {

double megabytes(std::uint64_t bytes) {
  return 1e-6 * static_cast<double>(bytes);
}

/// The robots that the service and the agents name.
std::set<RobotName> robots_of(const Recording& recording) {
  Topics topics;
  topics.set(topic_number<Mission>()).set(topic_number<AgentStatus>());
  std::set<RobotName> robots;
  Playback playback(recording, recording.begin(), topics);
  while (const auto next = playback.next()) {
    if (const auto* mission = std::get_if<Mission>(next->message.get())) robots.insert(mission->robot);
    if (const auto* status = std::get_if<AgentStatus>(next->message.get())) robots.insert(status->robot);
  }
  return robots;
}

std::string chunks_of(const McapReader& file) {
  std::set<std::string_view> compressions;
  std::uint64_t packed = 0;
  std::uint64_t unpacked = 0;
  std::size_t chunks = 0;
  for (const McapReader::Piece& piece : file.pieces()) {
    packed += piece.length;
    unpacked += piece.uncompressed_size;
    chunks += piece.compression.has_value();
    compressions.insert(piece.compression == mcap::zstd ? "zstd" : "not compressed");
  }
  return fmt::format("{} chunks ({}), {:.2f} MB of {:.2f} MB", chunks, fmt::join(compressions, ", "),
                     megabytes(packed), megabytes(unpacked));
}

}  // namespace

int info_command(const std::string& file) {
  const Recording recording(file);
  const McapReader& mcap = recording.file();
  const double duration = recording.end() - recording.begin();
  const std::set<RobotName> robots = robots_of(recording);
  std::cout << fmt::format("{}: by {:?}, {:.2f} MB, {}\n", file, mcap.library(), megabytes(mcap.size()),
                           mcap.ending().empty() ? "complete" : "not complete");
  if (!mcap.ending().empty()) std::cout << mcap.ending() << '\n';
  std::cout << fmt::format("begins {:%F %T} UTC, lasts {:.1f} s\n",
                           fmt::gmtime(static_cast<std::time_t>(recording.begin())), duration);
  std::cout << chunks_of(mcap) << '\n';
  std::cout << fmt::format("{} robots: {}\n", robots.size(), fmt::join(robots, " "));
  std::cout << fmt::format("{:<24} {:>9} {:>9}\n", "channel", "messages", "per s");
  for (const auto& [id, channel] : mcap.channels()) {
    const auto counted = mcap.statistics().channel_messages.find(id);
    if (counted == mcap.statistics().channel_messages.end()) continue;
    const auto messages = static_cast<double>(counted->second);
    // A foreign name may contain control sequences for the terminal.
    const std::string name = recording.topic_of(id) ? channel.topic : fmt::format("{:?}", channel.topic);
    std::cout << fmt::format("{:<24} {:>9} {:>9.1f}\n", name, counted->second,
                             duration > 0 ? messages / duration : 0);
  }
  return 0;
}

}  // namespace coppice
