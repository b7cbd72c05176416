// Tests of the file that tells what became of orders.
#include "runtime/order_history.h"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/support.h"

namespace coppice {
namespace {

OrderStatus status(const char* id, OrderState state) {
  OrderStatus status{
      .order = {.id = id, .robots = {"a"}, .visits = {{{1, 2.5}, true, 0.5, 3}}, .by = "\"me\""}};
  status.state = state;
  status.accepted_at = 12;
  return status;
}

TEST(OrderHistory, EachChangeIsALineOfJsonOnce) {
  test::TemporaryFolder folder;
  const auto file = folder.path() / "orders.jsonl";
  {
    OrderHistory history(file);
    history.said(status("1", OrderState::accepted));
    history.said(status("1", OrderState::done));
    history.said(status("1", OrderState::done));
    history.said(Mission{});
  }
  OrderHistory again(file);
  again.said(status("1", OrderState::accepted));
  again.said(status("2", OrderState::accepted));
  const auto line = [](const char* id, const char* state) {
    return std::string(R"({"id":")") + id + R"(","action":"go","state":")" + state +
           R"(","robot":null,"for":["a"],"goals":[{"x":1.0,"y":2.5,"yaw":0.5,"wait":3.0}],"visited":0,)"
           R"("cancels":null,"reason":null,"priority":0,"by":"\"me\"","deadline":null,"accepted_at":12.0,)"
           R"("begun_at":null,"ended_at":null})"
           "\n";
  };
  EXPECT_EQ(test::contents(file), line("1", "accepted") + line("1", "done") + line("2", "accepted"));
}

TEST(OrderHistory, AnOrderThatCannotBeSavedIsNoOrderYet) {
  test::TemporaryFolder folder;
  const auto file = folder.path() / "orders.jsonl";
  OrderHistory history(file);
  OrderStatus refused = status("1", OrderState::failed);
  refused.ended_at = refused.accepted_at;
  refused.reason = cannot_be_saved;
  history.said(refused);
  EXPECT_EQ(test::contents(file), "");
  refused.reason = "there is a wall";
  history.said(refused);
  EXPECT_NE(test::contents(file), "");
}

TEST(OrderHistory, ALineThatWasCutOffIsEnded) {
  test::TemporaryFolder folder;
  const auto file = folder.write("orders.jsonl", "{\"id\":\"1\",\"act");
  OrderHistory history(file);
  history.said(status("2", OrderState::accepted));
  const std::string text = test::contents(file);
  EXPECT_EQ(text.find("{\"id\":\"1\",\"act\n{\"id\":\"2\""), 0u) << text;
}

TEST(OrderHistory, ALongFileIsSetAsideAndNothingIsWrittenTwice) {
  test::TemporaryFolder folder;
  const auto file = folder.path() / "orders.jsonl";
  constexpr std::size_t longest = 3000;
  for (int k = 0; k < 40; ++k) {
    OrderHistory history(file, longest);  // the service was restarted
    if (k > 0) history.said(status(std::to_string(k - 1).c_str(), OrderState::done));
    history.said(status(std::to_string(k).c_str(), OrderState::done));
  }
  EXPECT_LT(std::filesystem::file_size(file), longest + 500);
  EXPECT_LT(std::filesystem::file_size(file.string() + ".1"), longest + 500);
  const std::string text = test::contents(file.string() + ".1") + test::contents(file);
  const auto first = text.find("{\"id\":\"39\"");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(text.find("{\"id\":\"39\"", first + 1), std::string::npos);
  EXPECT_NE(text.find("{\"id\":\"38\""), std::string::npos);
}

TEST(OrderHistory, AFileThatCannotBeWrittenIsAnError) {
  EXPECT_THROW(OrderHistory("/nowhere/orders.jsonl"), std::runtime_error);
}

}  // namespace
}  // namespace coppice
