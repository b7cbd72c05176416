// Tests of journals: what survives a process, and what a full, foreign or torn file causes.
#include "runtime/journal.h"

#include <csignal>
#include <fstream>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dds/serialized.h"
#include "tests/support.h"

namespace coppice {
namespace {

const Message status = AgentStatus{.robot = "r1", .mission = 3, .reason = "because", .driven_length = 7.5};
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
    journal.append(status);
    journal.append(tree);
  }
  {
    Journal journal(file);
    EXPECT_EQ(journal.messages(), (std::vector<Message>{status, tree}));
    journal.append(track);
    EXPECT_EQ(journal.messages(), (std::vector<Message>{status, tree, track}));
  }
  EXPECT_EQ(held_by(file), (std::vector<Message>{status, tree, track}));
  Journal(file).keep(Keep::begin_anew, tree);
  EXPECT_EQ(held_by(file), std::vector<Message>{tree});
}

TEST_F(JournalTest, AJournalCutAnywhereHoldsTheRecordsBeforeTheCut) {
  {
    Journal journal(file);
    journal.append(status);
    journal.append(tree);
  }
  const std::string whole = test::contents(file);
  std::size_t most = 0;
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    std::ofstream(file, std::ios::binary) << whole.substr(0, size);
    const auto held = held_by(file);
    EXPECT_GE(held.size(), most) << size;
    most = held.size();
    EXPECT_TRUE(held.empty() || held[0] == status) << size;
    Journal(file).append(track);
    EXPECT_EQ(held_by(file).back(), track) << size;
  }
  EXPECT_EQ(most, 2u);
}

TEST_F(JournalTest, AChangedByteEndsTheJournal) {
  {
    Journal journal(file);
    journal.append(status);
    journal.append(tree);
  }
  std::string bytes = test::contents(file);
  bytes[bytes.size() - 3] ^= 1;
  std::ofstream(file, std::ios::binary) << bytes;
  EXPECT_EQ(held_by(file), std::vector<Message>{status});
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

std::string problem_with_opening(const std::filesystem::path& path) {
  try {
    const Journal journal(path);
  } catch (const std::runtime_error& problem) {
    return problem.what();
  }
  return {};
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
  Journal(file).append(status);
  where_files_end_at(std::filesystem::file_size(file) + 20, [&] {
    Journal journal(file);
    journal.append(tree);  // it would be torn
    if (journal.complete()) _exit(1);
    journal.append(status);
  });
}

TEST_F(JournalTest, AFullDiskLeavesAnIncompleteJournal) {
  make_incomplete(file);
  Journal journal(file);
  EXPECT_FALSE(journal.complete());
  EXPECT_EQ(journal.messages(), std::vector<Message>{status});
}

TEST_F(JournalTest, AJournalThatFailsToBeginAgainIsIncomplete) {
  const std::uintmax_t first_line = [&] {
    const Journal journal(file);
    return std::filesystem::file_size(file);
  }();
  Journal(file).append(status);
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
  EXPECT_EQ(held_by(file), (std::vector<Message>{status, track}));
}

TEST_F(JournalTest, TheProcessDoesOtherWorkWhileItsJournalOpens) {
  for (int k = 0; k < 3; ++k) Journal(file).append(track);
  int turns = 0;
  const Journal journal(file, [&] { ++turns; });
  EXPECT_EQ(turns, 3);
}

TEST_F(JournalTest, AJournalIsNamedAfterItsProcessAndItsFolderIsMade) {
  EXPECT_FALSE(journal_in("", "r1").has_value());
  const auto journal = journal_in((folder.path() / "new" / "state").string(), "../r/1");
  ASSERT_TRUE(journal.has_value());
  EXPECT_EQ(journal->file().parent_path(), folder.path() / "new" / "state");
}

}  // namespace
}  // namespace coppice
