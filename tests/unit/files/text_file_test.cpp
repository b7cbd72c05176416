// Tests of writing where a file exists already.
#include "files/text_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "files/output_check.h"
#include "tests/support.h"

namespace coppice {
namespace {

namespace fs = std::filesystem;

struct TextFile : testing::Test {
  test::TemporaryFolder folder;
  const fs::path path = folder.path() / "out.txt";
};

TEST_F(TextFile, AFileReplacesAnExistingOne) {
  write_file(path, "a longer text");
  write_file(path, "a text");
  EXPECT_EQ(read_file(path), "a text");
}

// As /dev/null, which must not be replaced by a file.
TEST_F(TextFile, APipeStaysAPipe) {
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  const int reader = open(path.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  EXPECT_EQ(output_file()(path.string()), "");
  write_file(path, "a text");
  char got[16] = {};
  EXPECT_EQ(read(reader, got, sizeof got), 6);
  close(reader);
  EXPECT_STREQ(got, "a text");
  EXPECT_TRUE(fs::is_fifo(path));
}

TEST_F(TextFile, ALinkStaysALink) {
  const fs::path target = folder.path() / "target.txt";
  write_file(target, "before");
  fs::create_symlink("target.txt", path);
  write_file(path, "after");
  EXPECT_TRUE(fs::is_symlink(path));
  EXPECT_EQ(read_file(target), "after");
}

TEST_F(TextFile, ADanglingLinkGetsItsTarget) {
  fs::create_symlink("target.txt", path);
  write_file(path, "a text");
  EXPECT_TRUE(fs::is_symlink(path));
  EXPECT_EQ(read_file(folder.path() / "target.txt"), "a text");
}

}  // namespace
}  // namespace coppice
