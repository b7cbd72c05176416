// Targets for maps, pictures, scenarios, recordings and journals.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>

#include "coppice/files/input_error.h"
#include "coppice/files/map_file.h"
#include "coppice/files/scenario_file.h"
#include "monitor/recording/mcap_writer.h"
#include "monitor/recording/recording.h"
#include "runtime/journal.h"
#include "runtime/journal_examination.h"
#include "tests/fuzz/targets.h"

namespace coppice::fuzz {

namespace {

/// Files of this process under fixed names, which are removed at its end.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "coppice-fuzz-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::filesystem::path write(const char* name, Bytes content) const {
    std::ofstream(path_ / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(content.data()), static_cast<std::streamsize>(content.size()));
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

Bytes bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}
Input input(std::string_view text) {
  return {bytes(text).begin(), bytes(text).end()};
}

const Folder& folder() {
  static const Folder only;
  return only;
}

/// Bad input may cause an InputError of one line and nothing else.
template <class Fn>
void expect_input_error_at_most(Fn&& read) {
  try {
    read();
  } catch (const InputError& error) {
    if (std::string_view(error.what()).empty()) std::abort();
  }
}

void check(const OccupancyMap& map) {
  const auto cells = static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height);
  if (map.width < 1 || map.height < 1 || map.blocked.size() != cells || !(map.resolution > 0)) std::abort();
}

constexpr std::string_view small_map =
    "type octile\nheight 4\nwidth 6\nmap\n......\n.@@...\n.T.S..\n......\n";

void moving_ai_map(Bytes data) {
  expect_input_error_at_most([&] { check(read_map(folder().write("a.map", data))); });
}
std::vector<Input> moving_ai_map_seeds() {
  return {input(small_map), input("type octile\r\nheight 1\r\nwidth 1\r\nmap\r\n.\r\n")};
}

/// The YAML, a zero byte, and the picture, which may be named a.pgm or a.png.
void ros_map(Bytes data) {
  const auto cut = std::ranges::find(data, 0);
  const auto yaml = static_cast<std::size_t>(cut - data.begin());
  const auto picture = data.subspan(std::min(data.size(), yaml + 1));
  folder().write("a.pgm", picture);
  folder().write("a.png", picture);
  expect_input_error_at_most([&] { check(read_map(folder().write("a.yaml", data.first(yaml)))); });
}
std::vector<Input> ros_map_seeds() {
  const std::string fields = "resolution: 0.05\norigin: [-1.5, 2, 0.0]\n";
  const std::string thresholds = "negate: 1\noccupied_thresh: 0.65\nfree_thresh: 0.196\nmode: scale\n";
  // One grey pixel, as libpng writes it.
  const std::string png(
      "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08\0\0\0\0:~\x9bU\0\0\0\nIDATx\x9c"
      "c\xf8\x0f\0\x01\x01\x01\0\x1b\xb6\xeeV\0\0\0\0IEND\xae"
      "B`\x82",
      67);
  return {input("image: a.pgm\n" + fields + '\0' + "P5\n# by hand\n3 2\n255\n\x01\xfe\xff\x10\x20\x30"),
          input("image: a.pgm\n" + fields + thresholds + '\0' + "P2 2 2 9\n0 9\n1 2\n"),
          input("image: a.pgm\n" + fields + '\0' + "P5 1 1 65535\n\x01\xfe"),
          input("image: a.png\n" + fields + "mode: raw\n" + '\0' + png)};
}

void scenario(const char* name, Bytes data) {
  folder().write("m.map", bytes(small_map));
  expect_input_error_at_most([&] {
    const Scenario read = read_scenario(folder().write(name, data), {});
    check(read.map);
    if (read.robots.empty()) std::abort();
  });
}
void scenario_json(Bytes data) {
  scenario("s.json", data);
}
std::vector<Input> scenario_json_seeds() {
  return {
      input(R"({"map": "m.map", "radius": 0.4, "max_speed": 2, "max_acceleration": 3, "goal_tolerance": 0.5,
 "seed": 7, "robots": [{"name": "r1", "start": {"x": 0.5, "y": 0.5}, "goal": {"x": 5.5, "y": 3.5}},
 {"name": "r2", "radius": 0.3, "max_speed": 1, "start": {"x": 5.5, "y": 0.5}, "goal": {"x": 0.5, "y": 3.5}}]})"),
      input(R"({"map": "m.map", "robots": []})")};
}
void scenario_scen(Bytes data) {
  scenario("s.scen", data);
}
std::vector<Input> scenario_scen_seeds() {
  return {input("version 1\n0\tm.map\t6\t4\t0\t0\t5\t3\t6.8\n1\tm.map\t6\t4\t5\t0\t0\t3\t6.8\n")};
}

/// Plays from the beginning and from the middle: the messages must be in order.
void recording(Bytes data) {
  const std::string file = folder().write("a.mcap", data).string();
  expect_input_error_at_most([&] {
    const Recording recording(file);
    for (const WallTime from : {recording.begin(), (recording.begin() + recording.end()) / 2}) {
      Playback playback(recording, from);
      WallTime latest = 0;
      while (const auto next = playback.next()) {
        if (next->at < latest) std::abort();
        latest = next->at;
      }
    }
  });
}
/// Without the descriptions of the messages, which are much longer than the messages.
std::vector<Input> recording_seeds() {
  std::vector<Input> seeds;
  for (const auto compression : {McapWriter::Compression::none, McapWriter::Compression::zstd}) {
    McapWriter writer("fuzz", compression);
    const std::array<Message, 4> messages{BrokerStatus{7, true, 1, 1, 2, 3, 4, "m", 5}, Claim{7, 2, "a"},
                                          Assignment{"a", 7, 2}, PathMessage{"a", 1, {{4, 8}, {12, 8}}}};
    for (const Message& message : messages)
      writer.add_channel(channel_name(message.index()), mcap::protobuf, schema_name(message.index()), "");
    for (std::uint32_t k = 0; k < 3; ++k) {
      McapChunk chunk;
      for (std::uint16_t m = 0; m < messages.size(); ++m)
        chunk.add(static_cast<std::uint16_t>(m + 1), k, 1000 * k + m, recorded(messages[m]));
      writer.write(chunk);
    }
    writer.finish();
    seeds.push_back(input(writer.take()));
    const Input& whole = seeds.back();
    seeds.emplace_back(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(whole.size() / 2));
  }
  return seeds;
}

/// An empty journal with its first line only.
std::filesystem::path new_journal() {
  const std::filesystem::path file = folder().write("a.journal", {});
  const Journal begins(file);
  return file;
}

/// Behind the first line, the sound records count, once damaged ones are discarded. They are the same
/// whenever the journal is opened, and more can be added.
void journal(Bytes data) {
  const std::filesystem::path file = new_journal();
  std::ofstream(file, std::ios::binary | std::ios::app)
      .write(reinterpret_cast<const char*>(data.data()), static_cast<std::streamsize>(data.size()));
  std::size_t count = 0;
  try {
    const Journal refused_if_damaged(file);
  } catch (const std::runtime_error&) {
    std::filesystem::remove(discard_damaged(file));
  }
  {
    Journal journal(file);
    count = journal.messages().size();
    journal.append(Claim{7, 2, "a"});
  }
  if (Journal(file).messages().size() != count + 1) std::abort();
}
std::vector<Input> journal_seeds() {
  const std::filesystem::path file = new_journal();
  const auto first_line = std::filesystem::file_size(file);
  {
    Journal journal(file);
    journal.append(Claim{7, 2, "a"});
    journal.append(PathMessage{"a", 1, {{4, 8}, {12, 8}}});
  }
  std::ifstream stored(file, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(stored), {});
  const Input whole = input(std::string_view(bytes).substr(first_line));
  return {whole, {whole.begin(), whole.end() - 5}};
}

constexpr std::array all{Target{"moving_ai_map", moving_ai_map, moving_ai_map_seeds},
                         Target{"ros_map", ros_map, ros_map_seeds},
                         Target{"recording", recording, recording_seeds},
                         Target{"journal", journal, journal_seeds},
                         Target{"scenario_json", scenario_json, scenario_json_seeds},
                         Target{"scenario_scen", scenario_scen, scenario_scen_seeds}};

}  // namespace

std::span<const Target> file_targets() {
  return all;
}

const Target* find_target(std::string_view name) {
  for (const auto& targets : all_targets()) {
    for (const Target& target : targets) {
      if (target.name == name) return &target;
    }
  }
  return nullptr;
}

}  // namespace coppice::fuzz
