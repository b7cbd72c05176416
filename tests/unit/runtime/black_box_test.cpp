// Tests of the file in which an agent leaves the end of its track.
#include "runtime/black_box.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/support.h"

namespace coppice {
namespace {

TrackMessage end_at(double time) {
  return {"r 1", 1, 7, {{time, {2, 3}, {0, 0}}}};
}

TEST(BlackBox, TheLastEndIsReadOnceItsAgentIsGone) {
  const test::TemporaryFolder folder;
  const std::string boxes = (folder.path() / "boxes").string();
  EXPECT_FALSE(rest_of_track(boxes, "r 1"));
  {
    BlackBox box(boxes, "r 1");
    for (int k = 1; k <= 431; ++k) box.keep(end_at(k));
    EXPECT_FALSE(rest_of_track(boxes, "r 1"));  // the agent lives
  }
  EXPECT_EQ(rest_of_track(boxes, "r 1"), end_at(431));
  EXPECT_FALSE(rest_of_track(boxes, "r 2"));
}

TEST(BlackBox, AnEndThatWasWrittenInPartLeavesTheOneBefore) {
  const test::TemporaryFolder folder;
  const std::string boxes = folder.path().string();
  {
    BlackBox box(boxes, "a");
    box.keep(end_at(1));
    box.keep(end_at(2));
  }
  const auto file = folder.path() / "track-of-a.journal";
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 3);
  EXPECT_EQ(rest_of_track(boxes, "a"), end_at(1));
}

TEST(BlackBox, TheFileStaysSmall) {
  const test::TemporaryFolder folder;
  BlackBox box(folder.path().string(), "a");
  for (int k = 0; k < 10'000; ++k) box.keep(end_at(k));
  EXPECT_LT(std::filesystem::file_size(folder.path() / "track-of-a.journal"), 50'000u);
}

}  // namespace
}  // namespace coppice
