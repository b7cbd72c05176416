// Children never outlive their parent, whatever ends it, and shared memory that nobody uses is removed.

#include "coppice/process_fleet.h"

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/wait.h>

#include "coppice/shared_memory.h"
#include "tests/processes.h"
#include "tests/support.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;
using Output = ProcessFleet::Output;

std::vector<std::string> script(const std::string& text) {
  return {"/bin/sh", "-c", text};
}

/// A child that tells its process id and stays.
std::vector<std::string> stays(const std::filesystem::path& tell) {
  return script("echo $$ > '" + tell.string() + ".new'; mv '" + tell.string() + ".new' '" + tell.string() +
                "'; exec sleep 100");
}

pid_t told(const std::filesystem::path& file) {
  EXPECT_TRUE(test::within(5s, [&] { return std::filesystem::exists(file); }));
  const std::string text = test::contents(file);
  return text.empty() ? 0 : std::stoi(text);
}

ProcessFleet::Ended next_end(ProcessFleet& fleet) {
  std::optional<ProcessFleet::Ended> ended;
  EXPECT_TRUE(test::within(5s, [&] { return (ended = fleet.reap()).has_value(); }));
  return ended.value_or(ProcessFleet::Ended{});
}

TEST(ProcessFleet, TellsWhoEndedHowAndWithWhichLastWords) {
  const test::TemporaryFolder folder;
  ProcessFleet fleet(folder.path());
  EXPECT_FALSE(fleet.reap());
  fleet.start("r1", script("echo out; echo no map >&2; exit 3"), Output::log);
  const auto exited = next_end(fleet);
  EXPECT_EQ(exited.name, "r1");
  EXPECT_EQ(exited.exit_code, 3);
  EXPECT_EQ(exited.last_words, "out\nno map\n");
  fleet.start("r2", script("kill -SEGV $$"), Output::log);
  EXPECT_EQ(next_end(fleet).exit_code, 128 + SIGSEGV);
  EXPECT_FALSE(fleet.reap());
}

TEST(ProcessFleet, WhatCannotBeStartedIsAnError) {
  const test::TemporaryFolder folder;
  ProcessFleet fleet(folder.path());
  EXPECT_THROW(fleet.start("r1", {"/nowhere/robot_agent"}, Output::log), std::runtime_error);
  EXPECT_FALSE(fleet.reap());
}

TEST(ProcessFleet, EndsItsChildrenWithItself) {
  const test::TemporaryFolder folder;
  pid_t child = 0;
  {
    ProcessFleet fleet(folder.path());
    fleet.start("r1", stays(folder.path() / "pid"), Output::log);
    child = told(folder.path() / "pid");
    EXPECT_FALSE(test::has_ended(child));
  }
  EXPECT_TRUE(test::has_ended(child));
}

TEST(ProcessFleet, AsksFirstAndKillsAfterTheGrace) {
  const test::TemporaryFolder folder;
  ProcessFleet fleet(folder.path());
  const std::string ready = "; touch '" + folder.path().string() + "/ready-'$0; while :; do sleep 0.05; done";
  fleet.start("polite", {"/bin/sh", "-c", "trap 'echo asked; exit 0' TERM" + ready, "polite"}, Output::log);
  fleet.start("deaf", {"/bin/sh", "-c", "trap '' TERM" + ready, "deaf"}, Output::log);
  for (const char* name : {"ready-polite", "ready-deaf"}) {
    ASSERT_TRUE(test::within(5s, [&] { return std::filesystem::exists(folder.path() / name); }));
  }
  const auto children = test::children_of(getpid());
  const auto begin = std::chrono::steady_clock::now();
  fleet.terminate_all(500ms);
  const auto took = std::chrono::steady_clock::now() - begin;
  EXPECT_GE(took, 500ms);
  EXPECT_LT(took, 3s);
  EXPECT_EQ(test::contents(folder.path() / "polite.log"), "asked\n");
  for (const auto& child : children) {
    EXPECT_TRUE(child.name != "sh" || test::has_ended(child.pid));
  }
}

/// A parent with two children that is ended by `signal`; its children and its caretaker are to be gone.
void expect_nothing_outlives(int signal) {
  const test::TemporaryFolder folder;
  const pid_t parent = fork();
  if (parent == 0) {
    ProcessFleet fleet(folder.path());
    fleet.start("r1", stays(folder.path() / "1"), Output::log);
    fleet.start("r2", stays(folder.path() / "2"), Output::log);
    while (true) pause();
  }
  told(folder.path() / "1");
  told(folder.path() / "2");
  const auto children = test::children_of(parent);
  EXPECT_EQ(children.size(), 3u) << "two children and the caretaker";
  kill(parent, signal);
  waitpid(parent, nullptr, 0);
  for (const auto& child : children) {
    EXPECT_TRUE(test::within(3s, [&] { return test::has_ended(child.pid); })) << child.name;
  }
}

TEST(ProcessFleet, NothingOutlivesAParentThatIsKilled) {
  expect_nothing_outlives(SIGKILL);
}
TEST(ProcessFleet, NothingOutlivesAParentThatHangsUp) {
  expect_nothing_outlives(SIGHUP);
}

/// A segment as Fast DDS leaves it: the memory, its lock file if there is one, and a port's mutex.
class Segment {
 public:
  Segment(std::string name, bool with_lock) : name_(std::move(name)) {
    std::ofstream(folder_ / name_) << std::string(4096, 'x');
    std::ofstream(folder_ / ("sem." + name_ + "_mutex")) << "x";
    if (with_lock) std::ofstream(lock_file()) << "";
  }
  ~Segment() {
    for (const auto& file : files()) std::filesystem::remove(file);
  }
  Segment(const Segment&) = delete;
  Segment& operator=(const Segment&) = delete;
  std::filesystem::path memory() const { return folder_ / name_; }
  std::filesystem::path lock_file() const { return folder_ / (name_ + "_el"); }
  std::size_t remaining() const {
    std::size_t count = 0;
    for (const auto& file : files()) count += std::filesystem::exists(file);
    return count;
  }

 private:
  std::vector<std::filesystem::path> files() const {
    return {memory(), lock_file(), folder_ / ("sem." + name_ + "_mutex")};
  }
  std::filesystem::path folder_ = "/dev/shm";
  std::string name_;
};

std::string unused_name(const std::string& what) {
  return "fastrtps_" + what + std::to_string(getpid());
}

TEST(SharedMemory, WhatNobodyUsesIsRemoved) {
  const Segment with_lock(unused_name("testa"), true);
  const Segment without_lock(unused_name("testb"), false);  // a port that its receiver left
  ASSERT_EQ(with_lock.remaining(), 3u);
  ASSERT_EQ(without_lock.remaining(), 2u);
  remove_stale_shared_memory();
  EXPECT_EQ(with_lock.remaining(), 0u);
  EXPECT_EQ(without_lock.remaining(), 0u);
}

TEST(SharedMemory, WhatSomebodyLocksStays) {
  const Segment segment(unused_name("testc"), true);
  const int lock = open(segment.lock_file().c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_EQ(flock(lock, LOCK_EX | LOCK_NB), 0);
  EXPECT_GE(remove_stale_shared_memory(), 1u);
  EXPECT_EQ(segment.remaining(), 3u);
  close(lock);
}

TEST(ProcessFleet, ClearsUpWhatIsUnlockedALittleAfterTheLastProcess) {
  const test::TemporaryFolder folder;
  auto fleet = std::make_unique<ProcessFleet>(
      folder.path());  // first, so that its caretaker does not inherit the lock
  const Segment segment(unused_name("teste"), true);
  const int lock = open(segment.lock_file().c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_EQ(flock(lock, LOCK_EX | LOCK_NB), 0);
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    close(lock);
  });
  fleet.reset();
  later.join();
  EXPECT_EQ(segment.remaining(), 0u);
}

TEST(SharedMemory, WhatSomebodyMapsStays) {
  const Segment segment(unused_name("testd"), true);
  const int file = open(segment.memory().c_str(), O_RDONLY | O_CLOEXEC);
  void* memory = mmap(nullptr, 4096, PROT_READ, MAP_SHARED, file, 0);
  close(file);
  ASSERT_NE(memory, MAP_FAILED);
  remove_stale_shared_memory();
  EXPECT_EQ(segment.remaining(), 3u);
  munmap(memory, 4096);
}

TEST(SharedMemory, FilesOfOthersStay) {
  const std::filesystem::path other = "/dev/shm/coppice_test_" + std::to_string(getpid()) + "_el";
  std::ofstream(other) << "x";
  remove_stale_shared_memory();
  EXPECT_TRUE(std::filesystem::remove(other));
}

}  // namespace
}  // namespace coppice
