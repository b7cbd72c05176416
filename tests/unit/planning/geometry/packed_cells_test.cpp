// Tests of map cells that are packed into bits.
#include "planning/geometry/packed_cells.h"

#include <string>

#include <gtest/gtest.h>

namespace coppice {
namespace {

using Cells = std::vector<std::uint8_t>;

TEST(PackedCells, PackingBeginsWithTheLowestBit) {
  const Cells cells{1, 0, 0, 7, 0, 0, 0, 0, 0, 1};
  EXPECT_EQ(packed_cells<Cells>(cells), (Cells{0b1001, 0b10}));
  EXPECT_EQ(packed_cells<std::string>(cells), "\x09\x02");
}

TEST(PackedCells, UnpackedCellsAreZerosAndOnes) {
  const Cells cells{0, 1, 0, 0, 0, 0, 0, 1, 9};
  const Cells back{0, 1, 0, 0, 0, 0, 0, 1, 1};
  EXPECT_EQ(unpacked_cells(packed_cells<std::string>(cells), cells.size()), back);
  EXPECT_EQ(unpacked_cells(packed_cells<Cells>(cells), 3), (Cells{0, 1, 0}));
}

TEST(PackedCells, UnpackingYieldsNoMoreCellsThanBits) {
  EXPECT_EQ(unpacked_cells(std::string("\xff"), 20).size(), 8U);
  EXPECT_TRUE(unpacked_cells(std::string(), 20).empty());
}

}  // namespace
}  // namespace coppice
