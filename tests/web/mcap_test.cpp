// Test that other programs can read a recording: the reference reader of MCAP, run by node, and Protobuf with
// only the schemas in the file.
//
// CTest: RESOURCE_LOCK lane_2

#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "monitor/recording/recording.h"
#include "tests/support.h"
#include "tests/web/packages.h"

namespace coppice {
namespace {

using test::Outcome;
using test::shell;

/// What `node` prints for a recording and its run's trajectory.
Outcome reference_reader(const std::string& recording, const std::string& trajectory) {
  return shell(fmt::format("node '{}' '{}' '{}'", (test::web_tests() / "read_recording.mjs").string(),
                           recording, trajectory));
}

TEST(RecordedMcap, TheReferenceReaderReadsTheRecording) {
  ASSERT_EQ(test::missing_packages(test::web_tests()), "");
  const test::TemporaryFolder folder;
  const std::string recording = (folder.path() / "run.mcap").string();
  const std::string trajectory = (folder.path() / "run.csv").string();
  const Outcome run = shell(fmt::format(
      "'{}' run '{}' --robots 4 --time-scale 4 --quiet --record '{}' "
      "--trajectory '{}'",
      test::program("coppice"), (test::scenarios() / "rooms-8.json").string(), recording, trajectory));
  ASSERT_EQ(run.exit_code, 0) << run.output;

  const Outcome found = reference_reader(recording, trajectory);
  EXPECT_EQ(found.exit_code, 0) << found.output;
  const Recording ours(recording);
  for (TopicNumber topic = 0; topic < topic_count; ++topic) {
    if (ours.count(topic) == 0) continue;
    const std::string line = fmt::format("{} {}\n", channel_name(topic), ours.count(topic));
    EXPECT_NE(found.output.find(line), std::string::npos) << line << found.output;
  }

  // The reader must complain about a damaged file.
  std::string damaged = test::contents(recording);
  const McapReader::Piece& piece = ours.file().pieces().front();
  damaged[piece.offset + piece.length - 4] ^= 1;
  EXPECT_NE(reference_reader(folder.write("damaged.mcap", damaged).string(), trajectory).exit_code, 0);
}

}  // namespace
}  // namespace coppice
