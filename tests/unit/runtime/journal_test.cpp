// Tests of journals: what survives a process, and what a full, foreign or torn file causes.
#include "runtime/journal.h"

#include <algorithm>
#include <csignal>
#include <fstream>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dds/serialized.h"
#include "runtime/journal_examination.h"
#include "tests/small_disk.h"
#include "tests/support.h"

namespace coppice {
namespace {

const Message agent_status =
    AgentStatus{.robot = "r1", .mission = 3, .reason = "because", .driven_length = 7.5};
const Message tree = InactiveTreesMessage{{7, 2}, "map", 5, {{{1, 2}, -1, 6}, {{3, 4}, 0, 5.5}}};
const Message track = TrackMessage{"r1", 1, 4, {{0.5, {1, 2}, {3, 4}}, {0.55, {1.15, 2.2}, {0, 0}}}};

std::vector<Message> held_by(const std::filesystem::path& file) {
  return Journal(file).messages();
}

struct InAFolder : testing::Test {
  test::TemporaryFolder folder;
  std::filesystem::path file = folder.path() / "journal";
};
using JournalTest = InAFolder;

TEST_F(JournalTest, AppendedMessagesAreHeldInOrderAndMoreCanFollow) {
  {
    Journal journal(file);
    EXPECT_TRUE(journal.messages().empty());
    journal.append(agent_status);
    journal.append(tree);
  }
  {
    Journal journal(file);
    EXPECT_EQ(journal.messages(), (std::vector<Message>{agent_status, tree}));
    journal.append(track);
    EXPECT_EQ(journal.messages(), (std::vector<Message>{agent_status, tree, track}));
  }
  EXPECT_EQ(held_by(file), (std::vector<Message>{agent_status, tree, track}));
  Journal(file).keep(Keep::begin_anew, tree);
  EXPECT_EQ(held_by(file), std::vector<Message>{tree});
}

TEST_F(JournalTest, AJournalCutAnywhereHoldsTheRecordsBeforeTheCut) {
  {
    Journal journal(file);
    journal.append(agent_status);
    journal.append(tree);
  }
  const std::string whole = test::contents(file);
  std::size_t most = 0;
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    std::ofstream(file, std::ios::binary) << whole.substr(0, size);
    const auto held = held_by(file);
    EXPECT_GE(held.size(), most) << size;
    most = held.size();
    EXPECT_TRUE(held.empty() || held[0] == agent_status) << size;
    Journal(file).append(track);
    EXPECT_EQ(held_by(file).back(), track) << size;
  }
  EXPECT_EQ(most, 2u);
}

std::string problem_with_opening(const std::filesystem::path& path) {
  try {
    const Journal journal(path);
  } catch (const std::runtime_error& problem) {
    return problem.what();
  }
  return {};
}

/// Appends three messages. Returns where each record begins, and the end.
std::vector<std::size_t> write_three(const std::filesystem::path& file, Keep how) {
  std::vector<std::size_t> places;
  Journal journal(file);
  for (const Message& message : {agent_status, tree, track}) {
    places.push_back(std::filesystem::file_size(file));
    journal.keep(how, message);
    journal.sync();
  }
  places.push_back(std::filesystem::file_size(file));
  return places;
}

void change_byte(const std::filesystem::path& file, std::size_t place) {
  std::string bytes = test::contents(file);
  bytes.at(place) ^= 1;
  std::ofstream(file, std::ios::binary) << bytes;
}

// Length, checksum, contents: whichever byte it is.
TEST_F(JournalTest, AChangedByteInTheMiddleIsRefusedWithItsPlaceAndWhatToDo) {
  const std::vector<std::size_t> places = write_three(file, Keep::append);
  const std::string whole = test::contents(file);
  for (std::size_t place = 0; place < places[2]; ++place) {
    std::ofstream(file, std::ios::binary) << whole;
    change_byte(file, place);
    const std::string problem = problem_with_opening(file);
    const std::size_t from = place < places[0] ? 0 : place < places[1] ? places[0] : places[1];
    // The number of synced bytes is a hint, for the end of the file.
    if (problem.empty() && place < places[0]) continue;
    EXPECT_NE(problem.find(file.string() + ": is damaged at byte " + std::to_string(from) + ":"),
              std::string::npos)
        << place << ": " << problem;
    EXPECT_NE(problem.find("coppice state " + folder.path().string()), std::string::npos) << problem;
    EXPECT_NE(problem.find("--discard-damaged"), std::string::npos) << problem;
    EXPECT_EQ(test::contents(file).size(), whole.size()) << "the file stays as it is";
  }
}

TEST_F(JournalTest, AChangedLastRecordIsCutOffUnlessItWasOnDiskForCertain) {
  const std::size_t last = write_three(file, Keep::append)[3] - 3;
  change_byte(file, last);
  EXPECT_EQ(held_by(file), (std::vector<Message>{agent_status, tree}));
  std::filesystem::remove(file);
  write_three(file, Keep::append_surely);
  change_byte(file, last);
  EXPECT_NE(problem_with_opening(file).find("is damaged"), std::string::npos);
}

// The system had made the file longer when the power failed, and not yet written what belongs there.
TEST_F(JournalTest, ALastRecordWhoseEndWasNeverWrittenIsCutOff) {
  const std::vector<std::size_t> places = write_three(file, Keep::append_surely);
  std::string bytes = test::contents(file);
  std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(places[2]) + 20, bytes.end(), '\0');
  std::ofstream(file, std::ios::binary) << bytes;
  EXPECT_EQ(held_by(file), (std::vector<Message>{agent_status, tree}));
}

TEST_F(JournalTest, DamagedRecordsAreRemovedAndTheOthersStay) {
  const std::vector<std::size_t> places = write_three(file, Keep::append_surely);
  change_byte(file, places[1] + 30);
  const std::string damaged = test::contents(file);
  const JournalExamination found = examine_journal(file);
  ASSERT_EQ(found.damages.size(), 1u);
  EXPECT_EQ(found.damages[0].from, places[1]);
  EXPECT_EQ(found.damages[0].until, places[2]);
  EXPECT_EQ(found.records, 2u);
  EXPECT_EQ(test::contents(discard_damaged(file)), damaged);
  EXPECT_TRUE(examine_journal(file).damages.empty());
  EXPECT_EQ(held_by(file), (std::vector<Message>{agent_status, track}));
  change_byte(file, 3);
  EXPECT_NE(discard_damaged(file), file.string() + ".damaged") << "the first copy stays";
  EXPECT_EQ(held_by(file), (std::vector<Message>{agent_status, track}));
}

TEST_F(JournalTest, AJournalInUseIsNotRepaired) {
  write_three(file, Keep::append);
  const Journal journal(file);
  EXPECT_TRUE(examine_journal(file).in_use);
  EXPECT_THROW(discard_damaged(file), std::runtime_error);
}

TEST_F(JournalTest, BytesThatFitNoTypeAreNoMessage) {
  const std::vector<std::uint8_t> whole = serialized(BrokerStatus{.broker = 1});
  ASSERT_TRUE(deserialized(whole).has_value());
  std::vector<std::uint8_t> bytes = whole;
  bytes[1 + 4 + 8] = 7;  // the boolean behind the kind, the encapsulation and the broker's id
  EXPECT_FALSE(deserialized(bytes).has_value());
  bytes = whole;
  bytes[0] = 200;
  EXPECT_FALSE(deserialized(bytes).has_value());
  EXPECT_FALSE(deserialized({}).has_value());
}

TEST_F(JournalTest, ForeignFilesFoldersAndFilesInUseAreRefusedByName) {
  folder.write("notes", "of something else that nobody must lose");
  EXPECT_NE(problem_with_opening(folder.path() / "notes").find("notes: is not a journal"), std::string::npos);
  EXPECT_EQ(test::contents(folder.path() / "notes"), "of something else that nobody must lose");
  EXPECT_NE(problem_with_opening(folder.path()).find("cannot be opened"), std::string::npos);
  EXPECT_NE(problem_with_opening(folder.path() / "none" / "x").find("cannot be opened"), std::string::npos);
  EXPECT_NE(problem_with_opening("/dev/full").find("/dev/full: cannot be written"), std::string::npos);
  const Journal journal(file);
  EXPECT_NE(problem_with_opening(file).find("in use"), std::string::npos);
}

/// Runs `fn` in a process of its own whose files cannot grow beyond `limit` bytes.
template <class Fn>
void where_files_end_at(std::size_t bytes, Fn&& fn) {
  const pid_t child = fork();
  if (child == 0) {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &limit);
    fn();
    _exit(0);
  }
  int result = 0;
  waitpid(child, &result, 0);
  EXPECT_TRUE(WIFEXITED(result) && WEXITSTATUS(result) == 0);
}

/// Makes a journal that holds the status and had no room for the tree.
void make_incomplete(const std::filesystem::path& file) {
  Journal(file).append(agent_status);
  where_files_end_at(std::filesystem::file_size(file) + 20, [&] {
    Journal journal(file);
    journal.append(tree);  // it would be torn
    if (journal.complete()) _exit(1);
    journal.append(agent_status);
  });
}

TEST_F(JournalTest, AFullDiskLeavesAnIncompleteJournal) {
  make_incomplete(file);
  Journal journal(file);
  EXPECT_FALSE(journal.complete());
  EXPECT_EQ(journal.messages(), std::vector<Message>{agent_status});
}

TEST_F(JournalTest, AJournalThatFailsToBeginAgainIsIncomplete) {
  const std::uintmax_t first_line = [&] {
    const Journal journal(file);
    return std::filesystem::file_size(file);
  }();
  Journal(file).append(agent_status);
  where_files_end_at(first_line - 1, [&] { Journal(file).keep(Keep::begin_anew, tree); });
  Journal journal(file);
  EXPECT_FALSE(journal.complete());
  EXPECT_TRUE(journal.empty());
}

TEST_F(JournalTest, AnIncompleteJournalIsCompleteOnceItBeginsAgain) {
  make_incomplete(file);
  Journal(file).keep(Keep::begin_anew, tree);
  EXPECT_TRUE(Journal(file).complete());
  EXPECT_EQ(held_by(file), std::vector<Message>{tree});
}

TEST_F(JournalTest, AJournalGoesOnAfterItsGapsAreAccepted) {
  make_incomplete(file);
  {
    Journal journal(file);
    journal.accept_gaps();
    EXPECT_TRUE(journal.complete());
    journal.append(track);
  }
  EXPECT_TRUE(Journal(file).complete());
  EXPECT_EQ(held_by(file), (std::vector<Message>{agent_status, track}));
}

TEST_F(JournalTest, TheProcessDoesOtherWorkWhileItsJournalOpens) {
  for (int k = 0; k < 3; ++k) Journal(file).append(track);
  int turns = 0;
  const Journal journal(file, no_room, [&] { ++turns; });
  EXPECT_EQ(turns, 3);
}

constexpr std::size_t room = 4096;

TEST_F(JournalTest, ALongJournalIsRewrittenInOneStep) {
  Journal journal(file, room);
  int appended = 0;
  for (; !journal.wants_rewriting(); ++appended) EXPECT_TRUE(journal.append(agent_status));
  EXPECT_GT(appended, 10);
  EXPECT_TRUE(journal.rewrite(std::vector<Message>{tree}, "a note"));
  EXPECT_FALSE(journal.wants_rewriting());
  EXPECT_TRUE(journal.append(track));
  std::string note;
  std::vector<Message> held;
  journal.for_each([&](const Message& message) { held.push_back(message); },
                   [&](const std::string& text) { note = text; });
  EXPECT_EQ(held, (std::vector<Message>{tree, track}));
  EXPECT_EQ(note, "a note");
  EXPECT_NE(problem_with_opening(file).find("in use"), std::string::npos) << "the new file is locked, too";
}

TEST_F(JournalTest, AJournalThatIsRewrittenAgainAndAgainDoesNotGrow) {
  Journal journal(file, room);
  for (int k = 0; k < 3000; ++k) {
    journal.append(agent_status);
    if (journal.wants_rewriting()) journal.rewrite(std::vector<Message>{tree, agent_status});
  }
  EXPECT_LT(std::filesystem::file_size(file), 2 * room);
  EXPECT_LT(std::filesystem::file_size(file.string() + ".next"), 2 * room);
  EXPECT_EQ(journal.messages().front(), tree);
}

// Killed at any moment, it leaves the old file or the new one, and no third.
TEST_F(JournalTest, AKillWhileItIsRewrittenLeavesTheOldOrTheNewFile) {
  const std::vector<Message> one(20, agent_status);
  const std::vector<Message> other(30, track);
  for (int k = 0; k < 40; ++k) {
    const pid_t child = fork();
    if (child == 0) {
      Journal journal(file, room);
      while (true) {
        journal.rewrite(one);
        journal.rewrite(other);
      }
    }
    usleep(static_cast<useconds_t>(20'000 + 2'371 * k));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const std::vector<Message> held = held_by(file);
    EXPECT_TRUE(held == one || held == other || held.empty()) << k << ": " << held.size();
  }
  EXPECT_FALSE(held_by(file).empty());
}

TEST_F(JournalTest, AFullDiskDoesNotKeepARewrittenJournalFromGoingOn) {
  const test::SmallDisk disk(folder.path() / "disk", "1M");
  if (!disk.is_there()) GTEST_SKIP() << test::why_no_disk;
  const auto on_disk = folder.path() / "disk" / "a.journal";
  {
    Journal journal(on_disk, room);
    disk.fill();
    for (int k = 0; k < 2000; ++k) {
      ASSERT_TRUE(journal.append(agent_status)) << k;
      if (!journal.wants_rewriting()) continue;
      ASSERT_TRUE(journal.rewrite(std::vector<Message>{tree, agent_status})) << k;
    }
    EXPECT_TRUE(journal.complete());
  }
  Journal again(on_disk, room);  // after a kill, with the disk still full
  EXPECT_TRUE(again.complete());
  EXPECT_EQ(again.messages().front(), tree);
  for (int k = 0; k < 200; ++k) {
    ASSERT_TRUE(again.append(agent_status)) << k;
    if (!again.wants_rewriting()) continue;
    ASSERT_TRUE(again.rewrite(std::vector<Message>{tree})) << k;
  }
}

// What a journal has reserved stays its own when it is rewritten with more than there is room to reserve for.
TEST_F(JournalTest, ARewrittenJournalKeepsTheRoomThatItHas) {
  const test::SmallDisk disk(folder.path() / "disk", "1M");
  if (!disk.is_there()) GTEST_SKIP() << test::why_no_disk;
  Journal journal(folder.path() / "disk" / "a.journal", room);
  disk.fill();
  std::vector<Message> all;
  while (!journal.wants_rewriting()) {
    ASSERT_TRUE(journal.append(agent_status));
    all.push_back(agent_status);
  }
  ASSERT_TRUE(journal.rewrite(all));
  disk.fill();  // another process takes what is free
  for (int k = 0; k < 10; ++k) EXPECT_TRUE(journal.append(agent_status)) << k;
}

TEST_F(JournalTest, RoomThatComesBackIsUsedWithoutARestart) {
  const test::SmallDisk disk(folder.path() / "disk", "1M");
  if (!disk.is_there()) GTEST_SKIP() << test::why_no_disk;
  const auto on_disk = folder.path() / "disk" / "a.journal";
  Journal journal(on_disk, room);
  disk.fill();
  while (journal.append(tree)) {
  }
  EXPECT_FALSE(journal.complete());
  EXPECT_TRUE(journal.wants_rewriting());
  const std::vector<Message> many(std::size_t{500}, agent_status);
  EXPECT_FALSE(journal.rewrite(many)) << "there is no room for so many";
  EXPECT_EQ(journal.messages().front(), tree) << "what was there stays";
  disk.make_room();
  EXPECT_TRUE(journal.rewrite(many));
  EXPECT_TRUE(journal.complete());
  EXPECT_TRUE(journal.append(track));
  EXPECT_EQ(journal.messages().size(), 501u);
}

TEST_F(JournalTest, AJournalIsNamedAfterItsProcessAndItsFolderIsMade) {
  EXPECT_FALSE(journal_in("", "r1").has_value());
  const auto journal = journal_in((folder.path() / "new" / "state").string(), "../r/1");
  ASSERT_TRUE(journal.has_value());
  EXPECT_EQ(journal->file().parent_path(), folder.path() / "new" / "state");
}

}  // namespace
}  // namespace coppice
