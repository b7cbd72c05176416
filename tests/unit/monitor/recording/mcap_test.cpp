// Tests of MCAP files that are whole, cut at any byte, damaged at any byte, or hostile.

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/files/input_error.h"
#include "monitor/recording/mcap_reader.h"
#include "monitor/recording/mcap_writer.h"
#include "tests/support.h"

namespace coppice {
namespace {

using Compression = McapWriter::Compression;

struct Said {
  std::uint16_t channel;
  std::uint32_t sequence;
  mcap::Time at;
  std::string data;
  bool operator==(const Said&) const = default;
};

constexpr mcap::Time never = std::numeric_limits<mcap::Time>::max();

/// Two channels and three chunks, of which two overlap in time.
std::vector<std::vector<Said>> chunks() {
  return {{{1, 0, 100, "a"}, {1, 1, 200, std::string(50, 'b')}, {2, 0, 250, ""}},
          {{2, 1, 150, "c"}, {2, 2, 300, std::string(50, 'd')}},
          {{1, 2, 400, "e"}, {2, 3, 400, "f"}}};
}

std::string file_of(const std::vector<std::vector<Said>>& all, Compression compression) {
  McapWriter writer("test", compression);
  EXPECT_EQ(writer.add_channel("/one", "protobuf", "package.One", "schema of one"), 1);
  EXPECT_EQ(writer.add_channel("/two", "protobuf", "package.Two", ""), 2);
  std::string file = writer.take();
  for (const auto& messages : all) {
    McapChunk chunk;
    for (const Said& said : messages) chunk.add(said.channel, said.sequence, said.at, said.data);
    writer.write(chunk);
    file += writer.take();
  }
  writer.finish();
  return file + writer.take();
}

std::vector<Said> in_order(const std::vector<std::vector<Said>>& all) {
  std::vector<Said> messages;
  for (const auto& chunk : all) messages.insert(messages.end(), chunk.begin(), chunk.end());
  std::ranges::stable_sort(messages, {}, &Said::at);
  return messages;
}

std::vector<Said> read(const McapReader& reader, mcap::Time from = 0, mcap::Time until = never,
                       const std::set<std::uint16_t>& channels = {1, 2}) {
  std::vector<Said> messages;
  McapMessages all(reader, from, until, channels);
  while (const mcap::Message* m = all.next())
    messages.push_back({m->channel, m->sequence, m->log_time, std::string(m->data)});
  return messages;
}

class Mcap : public testing::TestWithParam<Compression> {
 protected:
  std::string write(const std::string& content) const { return folder_.write("a.mcap", content).string(); }
  test::TemporaryFolder folder_;
};

TEST_P(Mcap, AWrittenFileIsReadBack) {
  const McapReader reader(write(file_of(chunks(), GetParam())));
  EXPECT_EQ(reader.ending(), "");
  EXPECT_EQ(reader.library(), "test");
  EXPECT_EQ(reader.channels().at(1).topic, "/one");
  EXPECT_EQ(reader.schemas().at(1).name, "package.One");
  EXPECT_EQ(reader.schemas().at(1).data, "schema of one");
  EXPECT_EQ(reader.statistics().messages, 7u);
  EXPECT_EQ(reader.statistics().start, 100u);
  EXPECT_EQ(reader.statistics().end, 400u);
  EXPECT_EQ(reader.statistics().channel_messages.at(2), 4u);
  EXPECT_EQ(reader.pieces().size(), 3u);
  EXPECT_EQ(read(reader), in_order(chunks()));
}

TEST_P(Mcap, TimesAndChannelsCanBeSelected) {
  const McapReader reader(write(file_of(chunks(), GetParam())));
  std::vector<Said> some = in_order(chunks());
  std::erase_if(some, [](const Said& said) { return said.at < 150 || said.at >= 400; });
  EXPECT_EQ(read(reader, 150, 400), some);
  std::erase_if(some, [](const Said& said) { return said.channel != 2; });
  EXPECT_EQ(read(reader, 150, 400, {2}), some);
  EXPECT_TRUE(read(reader, 401).empty());
}

TEST_P(Mcap, AnEmptyFileIsWhole) {
  const McapReader reader(write(file_of({}, GetParam())));
  EXPECT_EQ(reader.ending(), "");
  EXPECT_TRUE(read(reader).empty());
}

/// The end of each chunk of the file, and what the file holds up to there.
std::vector<std::pair<std::size_t, std::vector<Said>>> whole_chunks(Compression compression) {
  std::vector<std::pair<std::size_t, std::vector<Said>>> all;
  const std::string whole = file_of(chunks(), compression);
  const McapReader reader(test::TemporaryFolder().write("whole.mcap", whole).string());
  for (std::size_t k = 0; k < reader.pieces().size(); ++k) {
    auto some = chunks();
    some.resize(k + 1);
    all.emplace_back(reader.pieces()[k].offset + reader.pieces()[k].length, in_order(some));
  }
  return all;
}

TEST_P(Mcap, AFileCutAtAnyByteIsReadUpToTheCut) {
  const std::string whole = file_of(chunks(), GetParam());
  const auto ends = whole_chunks(GetParam());
  const std::size_t header = mcap::magic.size() + mcap::record_head + 4 + 4 + 4;  // "test"
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::string file = write(whole.substr(0, size));
    if (size < header) {
      EXPECT_THROW(McapReader{file}, InputError) << size;
      continue;
    }
    const McapReader reader(file);
    EXPECT_NE(reader.ending(), "") << size;
    std::vector<Said> expected;
    for (const auto& [end, messages] : ends) {
      if (end <= size) expected = messages;
    }
    const std::vector<Said> found = read(reader);
    EXPECT_EQ(reader.statistics().messages, found.size()) << size;
    if (GetParam() == Compression::zstd) {
      EXPECT_EQ(found, expected) << size;
    } else {  // and the whole messages of the chunk that is cut
      EXPECT_GE(found.size(), expected.size()) << size;
      for (const Said& said : expected) EXPECT_TRUE(std::ranges::count(found, said)) << size;
    }
  }
}

TEST(McapCut, WholeMessagesOfACutUncompressedChunkAreRead) {
  const test::TemporaryFolder folder;
  const std::string whole = file_of(chunks(), Compression::none);
  const std::size_t cut = whole.find(std::string(50, 'd')) + 10;
  const McapReader reader(folder.write("a.mcap", whole.substr(0, cut)).string());
  const std::vector<Said> found = read(reader);
  ASSERT_EQ(found.size(), 4u) << "all of the first chunk, and the first message of the second";
  EXPECT_EQ(found[1], (Said{2, 1, 150, "c"}));
}

TEST_P(Mcap, DamageIsDetectedAtAnyByte) {
  const std::string whole = file_of(chunks(), GetParam());
  const std::vector<Said> all = in_order(chunks());
  std::size_t seen = 0;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    const std::string file = write(damaged);
    try {
      const McapReader reader(file);
      const std::vector<Said> found = read(reader);
      // Damage in redundant parts and in texts may go unseen. No message is ever changed.
      for (const Said& said : found) EXPECT_TRUE(std::ranges::count(all, said)) << "byte " << at;
      seen += !reader.ending().empty();
    } catch (const InputError& problem) {
      ++seen;
      EXPECT_NE(std::string(problem.what()).find(file), std::string::npos) << problem.what();
    }
  }
  EXPECT_GT(seen, whole.size() / 2);
}

TEST_P(Mcap, ADamagedChunkIsNamed) {
  std::string damaged = file_of(chunks(), GetParam());
  const McapReader sound(write(damaged));
  const McapReader::Piece& second = sound.pieces()[1];
  damaged[second.offset + second.length - 3] ^= 1;
  const McapReader reader(write(damaged));
  EXPECT_EQ(read(reader, 350).size(), 2u) << "others are read";
  try {
    read(reader);
    FAIL() << "the damage was not seen";
  } catch (const InputError& problem) {
    EXPECT_NE(std::string(problem.what()).find("byte " + std::to_string(second.offset)), std::string::npos)
        << problem.what();
  }
}

/// Each eight bytes of the file in turn hold an immense length.
TEST_P(Mcap, NoFalseLengthMakesTheReaderAllocateMuchMemory) {
  const std::string whole = file_of(chunks(), GetParam());
  for (const std::uint64_t lie : {~std::uint64_t{0}, std::uint64_t{1} << 62, std::uint64_t{1} << 40}) {
    for (std::size_t at = mcap::magic.size(); at + 8 <= whole.size(); ++at) {
      std::string hostile = whole;
      mcap::Bytes number;
      mcap::append_u64(number, lie);
      hostile.replace(at, 8, number);
      const std::string file = write(hostile);
      try {
        read(McapReader(file));
      } catch (const InputError&) {
        continue;
      }
    }
  }
}

TEST(McapHostile, AChunkThatClaimsTooMuchIsRefused) {
  const test::TemporaryFolder folder;
  McapWriter writer("test");
  std::string file = writer.take();
  mcap::Bytes chunk;
  for (const std::uint64_t number : {std::uint64_t{0}, std::uint64_t{0}, largest_chunk + 1})
    mcap::append_u64(chunk, number);
  mcap::append_u32(chunk, 0);
  mcap::append_string(chunk, "zstd");
  mcap::append_u64(chunk, 0);
  mcap::append_record(file, mcap::Opcode::chunk, chunk);
  const McapReader reader(folder.write("a.mcap", file).string());
  EXPECT_NE(reader.ending().find("expected at most"), std::string::npos) << reader.ending();
}

TEST(McapHostile, OtherFilesAreRefused) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(McapReader(folder.write("text", "time,robot,x,y\n").string()), InputError);
  EXPECT_THROW(McapReader((folder.path() / "none").string()), InputError);
  EXPECT_THROW(McapReader(folder.path().string()), InputError);
}

/// A file of another writer, without chunks and summary.
TEST(ForeignMcap, MessagesOutsideOfChunksAreReadInOrder) {
  const test::TemporaryFolder folder;
  McapWriter writer("test");
  writer.add_channel("/one", "protobuf", "One", "");
  std::string file = writer.take();
  for (const mcap::Time at : {300, 100, 200}) {
    mcap::Bytes message;
    mcap::append_u16(message, 1);
    mcap::append_u32(message, 0);
    mcap::append_u64(message, at);
    mcap::append_u64(message, at);
    mcap::append_record(file, mcap::Opcode::message, message + "x");
  }
  mcap::append_record(file, mcap::Opcode::data_end, mcap::Bytes(4, '\0'));
  mcap::append_record(file, mcap::Opcode::footer, mcap::Bytes(20, '\0'));
  const McapReader reader(folder.write("a.mcap", file + std::string(mcap::magic)).string());
  EXPECT_EQ(reader.ending(), "");
  const std::vector<Said> found = read(reader);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].at, 100u);
  EXPECT_EQ(found[2].at, 300u);
}

INSTANTIATE_TEST_SUITE_P(Compressions, Mcap, testing::Values(Compression::none, Compression::zstd),
                         [](const auto& tested) {
                           return tested.param == Compression::none ? "None" : "Zstd";
                         });

}  // namespace
}  // namespace coppice
