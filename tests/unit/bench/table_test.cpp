// Tests of tables of results as text.
#include "bench/table.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

TEST(Table, ACellWithACommaStaysOneCellOfTheCsv) {
  const Table table{{"map", "planner", "s"}, {{"a", "one, two", "1"}, {"", "\"b\"", "2"}}};
  EXPECT_EQ(as_csv(table), "map,planner,s\na,\"one, two\",1\n,\"\"\"b\"\"\",2\n");
}

}  // namespace
}  // namespace coppice
