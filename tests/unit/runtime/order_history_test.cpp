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

TEST(OrderHistory, ALineThatWasCutOffIsEnded) {
  test::TemporaryFolder folder;
  const auto file = folder.write("orders.jsonl", "{\"id\":\"1\",\"act");
  OrderHistory history(file);
  history.said(status("2", OrderState::accepted));
  const std::string text = test::contents(file);
  EXPECT_EQ(text.find("{\"id\":\"1\",\"act\n{\"id\":\"2\""), 0u) << text;
}

TEST(OrderHistory, AFileThatCannotBeWrittenIsAnError) {
  EXPECT_THROW(OrderHistory("/nowhere/orders.jsonl"), std::runtime_error);
}

}  // namespace
}  // namespace coppice
