// Tests of the clock of a process, and of what it leaves to the next one.
#include "runtime/process_clock.h"

#include <filesystem>
#include <iterator>

#include <gtest/gtest.h>

#include "tests/small_disk.h"
#include "tests/support.h"

namespace coppice {
namespace {

constexpr double one_hour = 3600;

TEST(ProcessClock, AProcessGoesOnWithTheTimeOfTheOneBeforeIt) {
  const DisciplinedClock::Reading first{1000, 1.7e9};
  const ClockMark kept{"boot", 1000, 1.7e9};
  for (const double step : {one_hour, -one_hour}) {
    const DisciplinedClock::Reading later{first.oscillator + 10, first.system + 10 + step};
    EXPECT_NEAR(clock_from(kept, "boot", later).time(), first.system + 10, 1e-6) << step;
  }
}

TEST(ProcessClock, AMarkOfAnotherBootDoesNotCount) {
  const DisciplinedClock::Reading now{50, 1.7e9};
  EXPECT_EQ(clock_from(ClockMark{"boot", 10, 5}, "another", now).time(), now.system);
  EXPECT_EQ(clock_from(ClockMark{"boot", 1000, 5}, "boot", now).time(), now.system) << "it is of the future";
  EXPECT_EQ(clock_from(std::nullopt, "boot", now).time(), now.system);
}

TEST(ProcessClock, MarksAreWrittenAndReadAlike) {
  const ClockMark mark{"4a9f-1", 123.5, 1.7e9};
  const auto read = clock_mark_in(text_of(mark));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->boot, mark.boot);
  EXPECT_EQ(read->oscillator, mark.oscillator);
  EXPECT_EQ(read->time, mark.time);
  for (const char* const damaged :
       {"", "boot", "boot 1", "boot 1 x", "boot 1 2 3", "boot nan 1", "boot 1 -5", "boot 1 1e99"})
    EXPECT_FALSE(clock_mark_in(damaged)) << damaged;
}

TEST(ProcessClock, ProcessesWithOneFolderHaveOneTime) {
  const test::TemporaryFolder folder;
  const std::string states = (folder.path() / "states").string();
  ProcessClock first(states);
  auto mark = clock_mark_in(test::contents(folder.path() / "states" / "clock"));
  ASSERT_TRUE(mark);
  mark->time -= one_hour;  // as if the system's clock had been set forward since
  folder.write("states/clock", text_of(*mark));
  ProcessClock second(states);
  EXPECT_NEAR(second.now(), first.now() - one_hour, 1);
  EXPECT_NEAR(second.by_system(second.now()), first.now(), 1);
  EXPECT_NEAR(second.from_system(second.by_system(500)), 500, 1e-6);
  EXPECT_NEAR(ProcessClock().now(), first.now(), 1) << "without a folder";
}

TEST(ProcessClock, AFullDiskKeepsTheMarkThatIsThere) {
  const test::TemporaryFolder folder;
  const test::SmallDisk disk(folder.path() / "states", "64k");
  if (!disk.is_there()) GTEST_SKIP() << test::why_no_disk;
  const std::string states = (folder.path() / "states").string();
  ProcessClock{states};
  auto mark = clock_mark_in(test::contents(folder.path() / "states" / "clock"));
  ASSERT_TRUE(mark);
  mark->oscillator += one_hour;  // counted on from there, so that it is of no use, and is to be replaced
  folder.write("states/clock", text_of(*mark));
  disk.fill();
  ProcessClock{states};
  EXPECT_EQ(test::contents(folder.path() / "states" / "clock"), text_of(*mark));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(states), {}), 2) << "the mark, and the ballast";
}

TEST(ProcessClock, ADamagedMarkIsReplaced) {
  const test::TemporaryFolder folder;
  folder.write("clock", "half a ma");
  ProcessClock clock(folder.path().string());
  EXPECT_NEAR(clock.now(), DisciplinedClock::read().system, 1);
  EXPECT_TRUE(clock_mark_in(test::contents(folder.path() / "clock")));
}

}  // namespace
}  // namespace coppice
