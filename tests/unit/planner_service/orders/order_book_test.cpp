// Tests of the order book, order by order.
#include "planner_service/orders/order_book.h"

#include <ctime>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/planner_service/roles.h"

namespace coppice {
namespace {

OrderMessage go(const char* id, std::vector<RobotName> robots, int priority = 0) {
  return {.id = id, .robots = std::move(robots), .visits = {{{1, 2}}}, .priority = priority};
}
OrderMessage action(const char* id, Action what, std::vector<RobotName> robots = {}) {
  return {.id = id, .action = what, .robots = std::move(robots)};
}

/// A book of two robots. Both stand, and their agents answer.
struct Orders {
  OrderBook book{{"a", "b"}};
  std::vector<RobotAtWork> robots{{.mission = 1, .arrived_at = 0}, {.mission = 1, .arrived_at = 0}};
  double now = 0;

  void give(const OrderMessage& order) { book.receive(order, "", ++now); }
  void follow() { book.follow(robots, now, now); }
  /// Sends out all robots whose orders are due.
  std::vector<std::string> set_out() {
    std::vector<std::string> ids;
    for (const DueOrder& due : book.due(robots)) {
      ids.push_back(due.id);
      book.begin(due.id, ++robots[due.robot].mission, now);
      robots[due.robot].arrived_at.reset();
    }
    return ids;
  }
  OrderStatus status(const std::string& id) {
    for (const OrderStatus& status : of<OrderStatus>(book.take_news())) said[status.order.id] = status;
    return said.at(id);
  }
  std::map<std::string, OrderStatus> said{};
};

using Ids = std::vector<std::string>;

TEST(OrderBook, ARobotDoesItsOrdersInTurn) {
  Orders orders;
  orders.give(go("1", {"a"}));
  orders.give(go("2", {"a"}));
  orders.give(go("3", {"a"}, 5));
  orders.follow();
  EXPECT_EQ(orders.set_out(), Ids{"3"}) << "it has the highest priority";
  EXPECT_EQ(orders.status("3").state, OrderState::under_way);
  orders.follow();
  EXPECT_EQ(orders.set_out(), Ids{});
  EXPECT_EQ(orders.status("1").reason, "a has other orders before");
  orders.robots[0].arrived_at = orders.now;
  orders.follow();
  EXPECT_EQ(orders.status("3").state, OrderState::done);
  EXPECT_EQ(orders.set_out(), Ids{"1"});
}

TEST(OrderBook, AnOrderThatComesTwiceIsDoneOnce) {
  Orders orders;
  orders.give(go("1", {"a"}));
  orders.follow();
  orders.set_out();
  orders.give(go("1", {"b"}));
  orders.follow();
  EXPECT_EQ(orders.set_out(), Ids{});
  orders.robots[0].arrived_at = orders.now;
  orders.follow();
  orders.give(go("1", {"a"}));
  orders.follow();
  EXPECT_EQ(orders.set_out(), Ids{});
  EXPECT_EQ(orders.status("1").state, OrderState::done);
}

TEST(OrderBook, ARobotStandsAtEachPlaceAsLongAsTheOrderSays) {
  Orders orders;
  OrderMessage order = go("1", {"a"});
  order.visits = {{.position = {1, 2}, .wait = 3}, {{4, 5}}};
  orders.give(order);
  orders.follow();
  orders.set_out();
  orders.robots[0].arrived_at = 10;
  orders.now = 12.9;
  orders.follow();
  EXPECT_EQ(orders.status("1").visited, 0u);
  orders.now = 13;
  orders.follow();
  EXPECT_EQ(orders.status("1").visited, 1u);
  EXPECT_EQ(orders.book.due(orders.robots).at(0).visit.position, Point2(4, 5));
  orders.set_out();
  orders.robots[0].arrived_at = 20;
  orders.now = 20;
  orders.follow();
  EXPECT_EQ(orders.status("1").state, OrderState::done);
}

TEST(OrderBook, ACancelledOrderFreesItsRobotAndStopsIt) {
  Orders orders;
  orders.give(go("1", {"a"}));
  orders.follow();
  orders.set_out();
  OrderMessage cancel = action("2", Action::cancel);
  cancel.cancels = "1";
  orders.give(cancel);
  EXPECT_EQ(orders.status("1").state, OrderState::cancelled);
  EXPECT_EQ(orders.status("1").reason, "cancelled by somebody who gave no name");
  EXPECT_EQ(orders.status("2").state, OrderState::done);
  EXPECT_EQ(orders.book.take_robots_to_stop(), std::vector<std::size_t>{0});
  EXPECT_EQ(orders.book.order_of(0), nullptr);
  cancel.id = "3";
  orders.give(cancel);
  EXPECT_EQ(orders.status("3").state, OrderState::failed);
  EXPECT_EQ(orders.status("3").reason, "order 1 is cancelled already");
}

TEST(OrderBook, ACancelledOrderSaysWhoCancelledItAndWhy) {
  Orders orders;
  orders.give(go("1", {"a"}));
  orders.give(go("2", {"a"}));
  OrderMessage cancel = action("3", Action::cancel);
  cancel.cancels = "1";
  cancel.by = "anna";
  orders.give(cancel);
  EXPECT_EQ(orders.status("1").reason, "cancelled by anna");
  cancel.id = "4";
  cancel.cancels = "2";
  cancel.why = "replaced by order 5";
  orders.give(cancel);
  EXPECT_EQ(orders.status("2").reason, "cancelled by anna: replaced by order 5");
}

TEST(OrderBook, AnOrderThatCannotBeDoneFailsWithItsReason) {
  Orders orders;
  orders.give(go("1", {"c"}));
  EXPECT_EQ(orders.status("1").reason, "c is no robot of this fleet");
  orders.book.receive(go("2", {"a"}), "there is a wall", 1);
  EXPECT_EQ(orders.status("2").reason, "there is a wall");
  orders.give(go("3", {"a"}));
  orders.follow();
  orders.set_out();
  orders.robots[0].no_way = "no path: walls are all around";
  orders.follow();
  EXPECT_EQ(orders.status("3").reason, "no path: walls are all around");
  orders.give(go("4", {"b"}));
  orders.robots[1].out_of_service = true;
  orders.follow();
  EXPECT_EQ(orders.status("4").state, OrderState::failed);
}

TEST(OrderBook, AHaltHoldsOrdersBackUntilItEnds) {
  Orders orders;
  orders.give(action("1", Action::stop));
  const auto halts = of<HaltMessage>(orders.book.take_news());
  ASSERT_EQ(halts.size(), 1u);
  EXPECT_EQ(halts[0].everybody, Halt::stopped);
  orders.follow();
  orders.robots[0].halted = orders.robots[1].halted = true;
  orders.follow();
  EXPECT_EQ(orders.status("1").state, OrderState::done) << "all robots have confirmed that they stand";

  orders.give(go("2", {"a"}));
  orders.follow();
  orders.follow();
  EXPECT_EQ(orders.set_out(), Ids{});
  EXPECT_EQ(orders.status("2").reason, "a is stopped by the operator");
  orders.give(action("3", Action::resume));
  orders.follow();
  EXPECT_EQ(orders.set_out(), Ids{}) << "a stop is ended by a release only";
  orders.give(action("4", Action::release, {"b"}));
  EXPECT_EQ(orders.book.halt_of(0), Halt::stopped);
  EXPECT_EQ(orders.book.halt_of(1), Halt::none);
  orders.give(action("5", Action::release));
  EXPECT_EQ(orders.set_out(), Ids{"2"});
}

TEST(OrderBook, APauseIsOfTheRobotsThatItNames) {
  Orders orders;
  orders.give(action("1", Action::pause, {"b"}));
  const auto halts = of<HaltMessage>(orders.book.take_news()).at(0);
  EXPECT_EQ(halt_of(halts, "a"), Halt::none);
  EXPECT_EQ(halt_of(halts, "b"), Halt::paused);
  orders.give(action("2", Action::stop));
  orders.give(action("3", Action::resume));
  EXPECT_EQ(orders.book.halt_of(1), Halt::stopped) << "the stop is stricter";
  orders.give(action("4", Action::release));
  EXPECT_EQ(orders.book.halt_of(1), Halt::none);
}

TEST(OrderBook, EachHoldIsEndedByItsOwnActionAlone) {
  Orders orders;
  orders.give(action("1", Action::pause, {"b"}));
  orders.give(action("2", Action::stop));
  orders.robots[0].halted = orders.robots[1].halted = true;
  orders.follow();
  orders.give(action("3", Action::release));
  EXPECT_EQ(orders.book.halt_of(0), Halt::none);
  EXPECT_EQ(orders.book.halt_of(1), Halt::paused);
  orders.robots[0].halted = false;
  orders.follow();
  EXPECT_EQ(orders.status("3").state, OrderState::done);
  EXPECT_EQ(orders.status("3").reason, "b stays paused until it is resumed");
  orders.give(action("4", Action::stop, {"b"}));
  orders.give(action("5", Action::pause));
  orders.give(action("6", Action::resume, {"a"}));
  EXPECT_EQ(orders.book.halt_of(0), Halt::none);
  EXPECT_EQ(orders.book.halt_of(1), Halt::paused_and_stopped);
  orders.give(action("7", Action::release, {"b"}));
  EXPECT_EQ(orders.book.halt_of(1), Halt::paused);
  orders.give(action("8", Action::resume));
  EXPECT_EQ(orders.book.halt_of(1), Halt::none);
}

TEST(OrderBook, AResumeOfAStoppedRobotSaysThatItStaysStopped) {
  Orders orders;
  orders.give(action("1", Action::stop, {"a"}));
  orders.give(action("2", Action::pause, {"b"}));
  orders.give(action("3", Action::resume));
  EXPECT_EQ(orders.status("3").state, OrderState::failed);
  EXPECT_EQ(orders.status("3").reason, "a stays stopped until it is released");
  EXPECT_FALSE(is_refused(orders.status("3"))) << "b goes on";
  EXPECT_EQ(orders.book.halt_of(0), Halt::stopped);
  EXPECT_EQ(orders.book.halt_of(1), Halt::none);
}

TEST(OrderBook, AHaltIsDoneWithoutRobotsThatAreNotHeardAndNamesThem) {
  Orders orders;
  orders.robots[0].halted = true;
  orders.robots[1].lost = true;
  orders.give(action("1", Action::stop));
  orders.follow();
  EXPECT_EQ(orders.status("1").state, OrderState::done);
  EXPECT_EQ(orders.status("1").reason, "b is not heard, and learns of this when it is back");
}

TEST(OrderBook, RobotsThatAreAwayKeepTheirHalts) {
  Orders orders;
  orders.book.recall(HaltMessage{.number = 7, .robots = {{"away", Halt::stopped}, {"a", Halt::paused}}});
  orders.give(action("1", Action::resume, {"a"}));
  EXPECT_EQ(halt_of(orders.book.halts(), "away"), Halt::stopped);
  EXPECT_EQ(halt_of(orders.book.halts(), "a"), Halt::none);
  orders.give(action("2", Action::release));
  EXPECT_EQ(halt_of(orders.book.halts(), "away"), Halt::none);
}

TEST(OrderBook, ACancelledOrderSaysWhoCancelledOrReplacedIt) {
  Orders orders;
  orders.give(go("1", {"a"}));
  orders.give(go("2", {"a"}));
  orders.give(go("3", {"b"}));
  orders.follow();
  orders.set_out();
  OrderMessage cancel = action("4", Action::cancel);
  cancel.cancels = "3";
  cancel.by = "ann";
  orders.give(cancel);
  EXPECT_EQ(orders.status("3").reason, "cancelled by ann");
  EXPECT_EQ(orders.book.take_robots_to_stop(), std::vector<std::size_t>{1});
  OrderMessage other = go("5", {"a"});
  other.by = "bob";
  other.replaces = true;
  orders.give(other);
  for (const char* id : {"1", "2"}) {
    EXPECT_EQ(orders.status(id).state, OrderState::cancelled) << id;
    EXPECT_EQ(orders.status(id).reason, "replaced by order 5 by bob");
  }
  orders.follow();
  EXPECT_EQ(orders.set_out(), Ids{"5"});
}

TEST(OrderBook, ARefusedOrderReplacesNothing) {
  Orders orders;
  orders.give(go("1", {"a"}));
  OrderMessage other = go("2", {"a"});
  other.replaces = true;
  orders.book.receive(other, "there is a wall", 2);
  EXPECT_EQ(orders.status("1").state, OrderState::accepted);
}

TEST(OrderBook, ARefusedOrderMayBeGivenAgain) {
  Orders orders;
  for (const char* id : {"same", "corrected"})
    orders.book.receive(go(id, {"a"}), std::string(cannot_be_saved), 2);
  orders.give(go("same", {"a"}));
  orders.book.receive(go("corrected", {"b"}), "there is a wall", 3);
  EXPECT_EQ(orders.status("same").state, OrderState::accepted);
  EXPECT_TRUE(orders.book.has_taken("same"));
  EXPECT_EQ(orders.status("corrected").reason, "there is a wall");
  EXPECT_FALSE(orders.book.has_taken("corrected"));
}

TEST(OrderBook, AHaltCannotBeCancelled) {
  Orders orders;
  orders.give(action("1", Action::stop));
  OrderMessage cancel = action("2", Action::cancel);
  cancel.cancels = "1";
  orders.give(cancel);
  EXPECT_EQ(orders.status("2").state, OrderState::failed);
  EXPECT_EQ(orders.book.halt_of(0), Halt::stopped);
}

TEST(OrderBook, RefusedOrdersPushOutNoOtherAndAreAnsweredAgain) {
  Orders orders;
  orders.give(go("real", {"a"}));
  orders.status("real");
  for (int k = 0; k < 3000; ++k) {
    orders.book.receive(go(("no" + std::to_string(k)).c_str(), {"a"}), "there is a wall", 2);
    if (k % 100 == 0) orders.book.take_news();
  }
  orders.book.take_news();
  EXPECT_TRUE(orders.book.knows("real"));
  EXPECT_TRUE(orders.book.knows("no2999"));
  EXPECT_FALSE(orders.book.knows("no1")) << "memory is bounded";
  orders.book.receive(go("no2999", {"a"}), "there is a wall", 3);
  orders.give(go("real", {"a"}));
  const auto answers = of<OrderStatus>(orders.book.take_news());
  ASSERT_EQ(answers.size(), 2u);
  EXPECT_EQ(answers[0].reason, "there is a wall");
  EXPECT_EQ(answers[1].order.id, "real");
  EXPECT_TRUE(orders.book.ended().empty()) << "nothing of this outlives the fleet";
}

TEST(OrderBook, AnOrderThatEndedLongAgoIsAnsweredToo) {
  Orders orders;
  for (int k = 0; k < 1500; ++k) {
    OrderMessage cancel = action(("c" + std::to_string(k)).c_str(), Action::cancel);
    cancel.cancels = std::to_string(k);
    orders.give(go(cancel.cancels.c_str(), {"a"}));
    orders.give(cancel);
  }
  orders.book.take_news();
  orders.give(go("0", {"a"}));
  EXPECT_EQ(orders.status("0").state, OrderState::cancelled);
  EXPECT_EQ(orders.book.ended().size(), 3000u);
}

TEST(OrderBook, AnOrderOfARobotThatIsNotHeardSaysSo) {
  Orders orders;
  orders.give(go("1", {"a"}));
  orders.give(go("2", {}));
  orders.follow();
  orders.set_out();
  orders.robots[0].took_up = true;
  orders.robots[0].silent = orders.robots[0].is_out_of_reach = orders.robots[0].lost = true;
  orders.follow();
  EXPECT_EQ(orders.status("1").state, OrderState::under_way);
  EXPECT_EQ(orders.status("1").reason, "a is not heard: its agent has ended, hangs, or cannot be reached");
  EXPECT_EQ(orders.book.free_robots(orders.robots), std::vector<std::size_t>{1});
  EXPECT_TRUE(orders.book.withdraw(orders.robots).empty()) << "it names a";
  orders.robots[0].silent = orders.robots[0].is_out_of_reach = orders.robots[0].lost = false;
  orders.follow();
  EXPECT_EQ(orders.status("1").reason, "");
}

TEST(OrderBook, AnOrderForAnyRobotThatWasNeverTakenUpIsWithdrawn) {
  Orders orders;
  orders.give(go("1", {}));
  orders.follow();
  orders.book.assign("1", 0);
  orders.set_out();
  orders.robots[0].silent = true;
  EXPECT_TRUE(orders.book.withdraw(orders.robots).empty()) << "it may be heard in a moment";
  orders.robots[0].is_out_of_reach = true;
  const auto withdrawn = orders.book.withdraw(orders.robots);
  ASSERT_EQ(withdrawn.size(), 1u);
  EXPECT_EQ(withdrawn[0].robot, 0u);
  EXPECT_EQ(orders.status("1").state, OrderState::accepted);
  EXPECT_EQ(orders.status("1").robot, "");
  ASSERT_EQ(orders.book.open_orders().size(), 1u);
  orders.book.assign("1", 1);
  EXPECT_EQ(orders.set_out(), Ids{"1"});
  orders.robots[1].took_up = orders.robots[1].is_out_of_reach = true;
  EXPECT_TRUE(orders.book.withdraw(orders.robots).empty()) << "b knows of it";
}

TEST(OrderBook, EndedOrdersOfRobotsThatAreGoneAreRecalled) {
  OrderStatus done{.order = go("1", {"gone"}), .state = OrderState::done, .robot = "gone", .ended_at = 3};
  Orders orders;
  orders.book.recall(done);
  orders.book.recall(done);
  orders.give(go("1", {"a"}));
  orders.follow();
  EXPECT_EQ(orders.status("1").state, OrderState::done);
}

// A queue of open orders is limited; ended ones are kept for ever.
TEST(OrderBook, RecallingTakesLittleTimeForEachOrder) {
  constexpr int orders_of_months = 50'000;
  OrderBook book({"a", "b"});
  const std::clock_t begin = std::clock();
  for (int k = 0; k < orders_of_months; ++k) {
    const std::string id = std::to_string(k);
    book.recall(OrderStatus{.order = go(id.c_str(), {"a"}, k % 3), .accepted_at = 1});
  }
  book.publish_again();
  const std::vector<OrderStatus> told = of<OrderStatus>(book.take_news());
  ASSERT_EQ(told.size(), std::size_t{orders_of_months});
  EXPECT_EQ(told[0].order.id, "2") << "the most urgent one that came first";
  EXPECT_EQ(told[1].order.id, "5");
  for (OrderStatus status : told) {
    status.state = OrderState::done;
    status.ended_at = 2;
    book.recall(status);
  }
  EXPECT_EQ(book.ended().size(), std::size_t{orders_of_months});
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 10)
      << "for minutes, if each looked at all others";
}

TEST(OrderBook, OrdersForAnyRobotGoToRobotsThatHaveNone) {
  Orders orders;
  orders.give(go("1", {"a"}));
  orders.give(go("2", {}));
  orders.give(go("3", {}, 1));
  orders.follow();
  ASSERT_EQ(orders.book.open_orders().size(), 2u);
  EXPECT_EQ(orders.book.open_orders()[0]->id, "3");
  EXPECT_EQ(orders.book.free_robots(orders.robots), std::vector<std::size_t>{1});
  orders.book.assign("3", 1);
  EXPECT_TRUE(orders.book.free_robots(orders.robots).empty());
  EXPECT_EQ(orders.set_out(), (Ids{"1", "3"}));
}

/// Each status that was said is recalled. The newest one counts, whatever was said before.
TEST(OrderBook, ARecalledBookGoesOnWhereItWas) {
  Orders before;
  before.give(go("1", {"a"}));
  before.give(go("2", {}));
  before.give(go("3", {"a"}));
  before.follow();
  before.book.assign("2", 1);
  std::vector<Message> said = before.book.take_news();
  before.set_out();
  for (Message& news : before.book.take_news()) said.push_back(std::move(news));
  before.robots[1].arrived_at = 3;
  before.now = 4;
  before.follow();
  for (Message& news : before.book.take_news()) said.push_back(std::move(news));

  Orders after;
  for (const OrderStatus& status : of<OrderStatus>(said)) after.book.recall(status);
  after.robots = before.robots;
  after.follow();
  EXPECT_EQ(after.set_out(), Ids{}) << "a is under way";
  ASSERT_NE(after.book.order_of(0), nullptr);
  EXPECT_EQ(after.book.order_of(0)->order.id, "1");
  EXPECT_EQ(after.book.order_of(1), nullptr);
  after.book.publish_again();
  EXPECT_EQ(after.status("2").state, OrderState::done);
  after.robots[0].arrived_at = 5;
  after.now = 6;
  after.follow();
  EXPECT_EQ(after.set_out(), Ids{"3"});
}

TEST(OrderBook, ARobotThatNeverSetOutIsSentAgainAfterARestart) {
  Orders before;
  before.give(go("1", {"a"}));
  before.follow();
  before.book.begin("1", 2, 1);  // the service was killed before it saved the mission
  Orders after;
  for (const OrderStatus& status : of<OrderStatus>(before.book.take_news())) after.book.recall(status);
  after.follow();
  EXPECT_EQ(after.set_out(), Ids{"1"});
}

}  // namespace
}  // namespace coppice
