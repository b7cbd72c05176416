// Tests of the HTTP API as a state machine: requests and messages go in, replies and orders come out.

#include "monitor/server/api.h"

#include <gtest/gtest.h>

#include "tests/unit/monitor/seen_fleet.h"

namespace coppice {
namespace {

using namespace std::string_literals;

struct ApiTest : testing::Test {
  test::SeenFleet fleet;
  int drawn = 0;
  Api api{[this] { return "drawn" + std::to_string(++drawn); }};

  ApiTest() { api.look(fleet.view, fleet.now); }

  WebAnswer ask(std::string_view method, std::string_view path, std::string_view body = {},
                std::string_view query = {}) {
    return api.answer({.method = method, .path = path, .query = query, .body = body, .client = "127.0.0.1"},
                      fleet.view);
  }
  /// The reply to a request that is answered at once.
  WebReply reply(std::string_view method, std::string_view path, std::string_view body = {},
                 std::string_view query = {}) {
    return std::get<WebReply>(ask(method, path, body, query));
  }
  WebWait later(std::string_view method, std::string_view path, std::string_view body = {}) {
    return std::get<WebWait>(ask(method, path, body));
  }
  void pass(double seconds) {
    fleet.now += seconds;
    api.look(fleet.view, fleet.now);
  }
  /// The only order since the last call.
  OrderMessage given() {
    const std::vector<OrderMessage> all = api.take_orders();
    EXPECT_EQ(all.size(), 1u);
    return all.at(0);
  }
  void say(const OrderMessage& order, OrderState state, const std::string& robot = "",
           const std::string& reason = "") {
    api.on(Message(OrderStatus{.order = order,
                               .state = state,
                               .robot = robot,
                               .reason = reason,
                               .accepted_at = fleet.now,
                               .begun_at = state == OrderState::under_way ? fleet.now : 0,
                               .ended_at = is_ended(state) ? fleet.now : 0}));
  }
  /// An order that the fleet has taken.
  OrderMessage taken(const std::string& id, OrderState state = OrderState::accepted,
                     const std::string& robot = "") {
    const OrderMessage order{.id = id, .visits = {{.position = {1, 2}}}};
    say(order, state, robot);
    return order;
  }
};

constexpr const char* to_1_2 = R"({"robot": "r2", "goal": {"x": 1, "y": 2}})";

TEST_F(ApiTest, AnOrderIsPublishedAndAnsweredWhenTheServiceSpeaks) {
  const WebWait wait =
      later("POST", "/api/orders",
            R"({"robot": "r2", "goals": [{"x": 1, "y": 2, "yaw": 3}, {"x": 4, "y": 5, "wait": 6}],
                                 "priority": -7, "deadline": 8, "by": "me"})");
  EXPECT_FALSE(wait.poll());
  const OrderMessage order = given();
  EXPECT_EQ(order, (OrderMessage{.id = "drawn1",
                                 .robots = {"r2"},
                                 .visits = {{.position = {1, 2}, .has_yaw = true, .yaw = 3},
                                            {.position = {4, 5}, .wait = 6}},
                                 .priority = -7,
                                 .deadline = 108,
                                 .by = "me"}));
  say(order, OrderState::assigned, "r2");
  const auto reply = wait.poll();
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 201u);
  EXPECT_EQ(reply->headers.at(0), std::pair("Location"s, "/api/orders/drawn1"s));
  EXPECT_NE(reply->body.find(R"("state":"assigned","robot":"r2")"), std::string::npos) << reply->body;
  EXPECT_TRUE(api.take_orders().empty());
}

TEST_F(ApiTest, NullIsAbsent) {
  later("POST", "/api/orders",
        R"({"id": null, "robot": null, "goal": {"x": 1, "y": 2, "yaw": null}, "by": null})");
  EXPECT_EQ(given(), (OrderMessage{.id = "drawn1", .visits = {{.position = {1, 2}}}}));
}

TEST_F(ApiTest, AnOrderThatIsKnownIsNotPublishedAgain) {
  taken("mine", OrderState::under_way, "r1");
  const WebReply known = reply("POST", "/api/orders", R"({"id": "mine", "goal": {"x": 1, "y": 2}})");
  EXPECT_EQ(known.status, 200u);
  EXPECT_NE(known.body.find(R"("id":"mine")"), std::string::npos);
  EXPECT_TRUE(api.take_orders().empty());
}

TEST_F(ApiTest, ARefusalIsAProblemWithItsReasonHoweverOftenTheOrderIsSent) {
  const WebWait wait = later("POST", "/api/orders", R"({"id": "a", "goal": {"x": 1, "y": 2}})");
  say(given(), OrderState::failed, "", "(1, 2) is in an obstacle");
  const WebReply again = reply("POST", "/api/orders", R"({"id": "a", "goal": {"x": 1, "y": 2}})");
  for (const WebReply& refusal : {wait.poll().value(), again}) {
    EXPECT_EQ(refusal.status, 422u);
    EXPECT_EQ(refusal.type, "application/problem+json");
    EXPECT_EQ(
        refusal.body,
        R"({"type":"about:blank","title":"Unprocessable Entity","status":422,"detail":"(1, 2) is in an obstacle"})");
  }
}

TEST_F(ApiTest, AServiceThatSaysNothingIsWaitedForForSomeSeconds) {
  const WebWait wait = later("POST", "/api/orders", to_1_2);
  pass(Api::patience - 0.1);
  EXPECT_FALSE(wait.poll());
  pass(0.2);
  EXPECT_EQ(wait.poll().value().status, 504u);
}

TEST_F(ApiTest, AnOrderIsRepeatedUntilTheServiceAnswers) {
  const WebWait wait = later("POST", "/api/orders", to_1_2);
  const OrderMessage order = given();
  EXPECT_TRUE(api.take_orders().empty());
  pass(1.1);
  EXPECT_EQ(given(), order);
  say(order, OrderState::accepted);
  pass(1.1);
  EXPECT_TRUE(api.take_orders().empty());
  EXPECT_EQ(wait.poll().value().status, 201u);
  later("POST", "/api/stop");
  given();
  pass(Api::patience + 0.1);
  EXPECT_TRUE(api.take_orders().empty()) << "nobody waits any more";
}

TEST_F(ApiTest, AnOrderMayReplaceThoseOfItsRobot) {
  later("POST", "/api/orders", R"({"robot": "r2", "goal": {"x": 1, "y": 2}, "replace": true})");
  EXPECT_TRUE(given().replaces);
  const WebReply refusal = reply("POST", "/api/orders", R"({"goal": {"x": 1, "y": 2}, "replace": true})");
  EXPECT_EQ(refusal.status, 400u);
  EXPECT_NE(refusal.body.find("body: replace: goes with a robot that is named"), std::string::npos);
}

TEST_F(ApiTest, AResumeOfAStoppedRobotIsAConflict) {
  const WebWait wait = later("POST", "/api/resume");
  api.on(Message(OrderStatus{.order = given(),
                             .state = OrderState::failed,
                             .reason = "r1 stays stopped until it is released",
                             .accepted_at = fleet.now,
                             .begun_at = fleet.now,
                             .ended_at = fleet.now}));
  EXPECT_EQ(wait.poll().value().status, 409u);
  EXPECT_NE(wait.poll().value().body.find("r1 stays stopped"), std::string::npos);
}

TEST_F(ApiTest, RefusedOrdersPushOutNoOther) {
  taken("real", OrderState::done, "r1");
  for (std::size_t k = 0; k < OrderDesk::most_refused + 100; ++k)
    say({.id = "no" + std::to_string(k), .visits = {{.position = {1, 2}}}}, OrderState::failed, "", "a wall");
  EXPECT_EQ(reply("GET", "/api/orders/real").status, 200u);
  EXPECT_EQ(reply("GET", "/api/orders/no0").status, 404u);
  EXPECT_EQ(reply("GET", "/api/orders/no1099").status, 200u);
}

TEST_F(ApiTest, AnEndedOrderStaysAsItIsWhateverANewFleetSaysOfIt) {
  const OrderMessage order = taken("a", OrderState::done, "r1");
  say(order, OrderState::failed, "", "it was given before this fleet began");
  EXPECT_NE(reply("GET", "/api/orders/a").body.find(R"("state":"done")"), std::string::npos);
}

TEST_F(ApiTest, ARobotThatIsPausedAndStoppedIsStopped) {
  fleet.mission("r1");
  api.look(fleet.view, fleet.now);
  api.on(Message(HaltMessage{.number = 1, .robots = {{"r1", Halt::paused_and_stopped}}}));
  EXPECT_NE(reply("GET", "/api/robots").body.find(R"("halt":"stopped")"), std::string::npos);
}

TEST_F(ApiTest, ARobotThatIsNotHeardSaysSo) {
  fleet.map();
  fleet.mission("r1");
  fleet.state("r1", {0.5, 1.5}, {1, 0});
  fleet.path("r1", {{0.5, 1.5}, {3.5, 1.5}});
  pass(12.2);
  const std::string body = reply("GET", "/api/robots").body;
  EXPECT_NE(
      body.find(
          R"("why":"it is not heard: its agent has ended, hangs, or cannot be reached","time_left":null)"),
      std::string::npos)
      << body;
}

TEST_F(ApiTest, AClockThatIsSetBackEndsTheWait) {
  const WebWait wait = later("POST", "/api/orders", to_1_2);
  pass(-3600);
  EXPECT_EQ(wait.poll().value().status, 504u);
}

TEST_F(ApiTest, WrongBodiesAreRefusedWithLineAndField) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "body:1: "},
      {"[]", "body:1: expected {"},
      {"{\n\"goal\": {\"x\": \"1\", \"y\": 2}}", "body:2: goal.x: expected a number, found a text"},
      {R"({"goal": {"x": 1, "y": 2}, "priority": 1.5})",
       "body:1: priority: expected a whole number from -2147483648 to 2147483647, found 1.5"},
      {R"({"goal": {"x": 1, "y": 2}, "priority": 2147483648})", "priority: expected a whole number"},
      {R"({"gaol": {"x": 1, "y": 2}})", "(did you mean goal?)"},
      {R"({"goals": [null]})", "goals[0]: expected {"},
      {"null", "body:1: expected {"},
      {"{}", "body: expected either goal or goals"},
      {R"({"goals": []})", "body: expected either goal or goals"},
      {R"({"goal": {"x": 1, "y": 2}, "goals": [{"x": 1, "y": 2}]})", "body: expected either goal or goals"},
      {R"({"goal": {"x": 1}})", "body: goal: expected x and y"},
      {R"({"goals": [{"x": 1, "y": 2}, {"y": 2}]})", "body: goals[1]: expected x and y"},
      {R"({"goal": {"x": 1e300, "y": 2}})", "body: goal: 1e+300 is too large"},
      {R"({"goal": {"x": 1, "y": 2, "wait": -1}})", "body: goal.wait: expected 0 to 86400 seconds, found -1"},
      {R"({"goal": {"x": 1, "y": 2}, "deadline": 0})", "body: deadline: expected a time above 0, found 0"},
      {R"({"goal": {"x": 1, "y": 2}, "id": "a/b"})", "body: id: expected 1 to 64 letters"},
      {R"({"goal": {"x": 1, "y": 2}, "id": ""})", "body: id: expected 1 to 64 letters"},
      {R"({"goal": {"x": 1, "y": 2}, "robot": ""})", "robot"},
      {R"({"goal": {"x": 1, "y": 2}, "by": "a\nb"})", "not printable"}};
  for (const auto& [body, expected] : cases) {
    const WebReply refusal = reply("POST", "/api/orders", body);
    EXPECT_EQ(refusal.status, 400u) << body;
    std::string said = refusal.body;
    EXPECT_NE(said.find(expected), std::string::npos) << body << "\nsaid: " << said;
  }
  EXPECT_TRUE(api.take_orders().empty());
}

TEST_F(ApiTest, OrdersAreListedByAcceptanceAndState) {
  taken("z");
  pass(1);
  taken("a", OrderState::under_way, "r1");
  EXPECT_EQ(reply("GET", "/api/orders").body.find(R"({"orders":[{"id":"z")"), 0u);
  EXPECT_NE(reply("GET", "/api/orders").body.find(R"({"id":"a")"), std::string::npos);
  for (const char* query : {"state=under%20way", "state=under+way", "&state=under way"}) {
    EXPECT_EQ(reply("GET", "/api/orders", "", query).body.find(R"({"orders":[{"id":"a")"), 0u) << query;
    EXPECT_EQ(reply("GET", "/api/orders", "", query).body.find(R"("id":"z")"), std::string::npos) << query;
  }
  EXPECT_EQ(reply("GET", "/api/orders", "", "state=done").body, R"({"orders":[],"problem":null})");
  EXPECT_EQ(reply("GET", "/api/orders", "", "state=lost").status, 400u);
  EXPECT_EQ(reply("GET", "/api/orders/z").status, 200u);
  EXPECT_EQ(reply("GET", "/api/orders/%7a").status, 200u);
  EXPECT_EQ(reply("GET", "/api/orders/y").status, 404u);
}

TEST_F(ApiTest, ACancelledOrderIsAnsweredWithItsOwnStatus) {
  const OrderMessage order = taken("a", OrderState::under_way, "r1");
  const WebWait wait = later("DELETE", "/api/orders/a");
  const OrderMessage cancellation = given();
  EXPECT_EQ(cancellation, (OrderMessage{.id = "drawn1", .action = Action::cancel, .cancels = "a"}));
  say(cancellation, OrderState::done);
  EXPECT_FALSE(wait.poll()) << "the status of the order itself comes later";
  say(order, OrderState::cancelled, "r1");
  EXPECT_EQ(wait.poll().value().status, 200u);
  EXPECT_NE(wait.poll().value().body.find(R"("id":"a","action":"go","state":"cancelled")"),
            std::string::npos);
}

TEST_F(ApiTest, AnEndedOrderCannotBeCancelled) {
  EXPECT_EQ(reply("DELETE", "/api/orders/a").status, 404u);
  const OrderMessage order = taken("a", OrderState::under_way, "r1");
  const WebWait wait = later("DELETE", "/api/orders/a");
  say(given(), OrderState::failed, "", "order a is done already");
  EXPECT_EQ(wait.poll().value().status, 409u);
  say(order, OrderState::done, "r1");
  EXPECT_EQ(wait.poll().value().status, 409u);
  EXPECT_EQ(reply("DELETE", "/api/orders/a").status, 409u);
}

TEST_F(ApiTest, AnOrderThatCannotBeSavedMayBeGivenLater) {
  const WebWait wait = later("POST", "/api/orders", R"({"id": "a", "goal": {"x": 1, "y": 2}})");
  const std::string reason = std::string(cannot_be_saved) + "the disk of /var/lib/hall is full";
  say(given(), OrderState::failed, "", reason);
  EXPECT_EQ(wait.poll().value().status, 503u);
  EXPECT_NE(reply("GET", "/api/orders").body.find(R"("problem":null)"), std::string::npos);
  api.on(Message(ServiceStatus{.service = 1, .run = {7}, .problem = reason}));
  EXPECT_NE(reply("GET", "/api/orders").body.find("\"problem\":\"" + reason), std::string::npos);
  api.on(Message(ServiceStatus{.service = 1, .run = {7}}));
  EXPECT_NE(reply("GET", "/api/orders").body.find(R"("problem":null)"), std::string::npos);
}

TEST_F(ApiTest, HaltsAreOrdersForRobotsOrForAll) {
  const WebWait all = later("POST", "/api/stop");
  EXPECT_EQ(given(), (OrderMessage{.id = "drawn1", .action = Action::stop}));
  const WebWait one = later("POST", "/api/resume", R"({"robots": ["r1", "r3"], "by": "me"})");
  const OrderMessage order = given();
  EXPECT_EQ(order,
            (OrderMessage{.id = "drawn2", .action = Action::resume, .robots = {"r1", "r3"}, .by = "me"}));
  say(order, OrderState::failed, "", "r3 is no robot of this fleet");
  EXPECT_EQ(one.poll().value().status, 422u);
  say({.id = "drawn1", .action = Action::stop}, OrderState::accepted);
  EXPECT_EQ(all.poll().value().status, 200u);
  EXPECT_EQ(reply("POST", "/api/pause", R"({"robot": "r1"})").status, 400u);
  EXPECT_EQ(reply("POST", "/api/release", R"({"robots": [""]})").status, 400u);
}

/// A client that misspells a parameter must not get the answer to another question.
TEST_F(ApiTest, UnknownParametersOfAQueryAreNamed) {
  taken("a");
  const std::vector<std::array<std::string, 4>> cases{
      {"GET", "/api/orders", "stat=done", "unknown parameter stat in the query: expected state"},
      {"GET", "/api/orders", "state=done&limit=3", "unknown parameter limit in the query: expected state"},
      {"GET", "/api/orders", "state=done&state=failed", "state: expected once in the query"},
      {"GET", "/api/orders", "%73tat=done", "unknown parameter stat in the query"},
      {"GET", "/api/orders/a", "full", "unknown parameter full in the query: expected none"},
      {"DELETE", "/api/orders/a", "reason=x", "unknown parameter reason in the query: expected by, why"},
      {"POST", "/api/orders", "dry=1", "unknown parameter dry in the query: expected none"},
      {"GET", "/api/robots", "name=r1", "unknown parameter name in the query: expected none"},
      {"GET", "/api/alarms", "a=1", "unknown parameter a in the query: expected none"},
      {"GET", "/api/events", "since=1", "unknown parameter since in the query: expected none"},
      {"POST", "/api/stop", "robots=r1", "unknown parameter robots in the query: expected none"},
      {"POST", "/api/pause", "=r1", "unknown parameter  in the query: expected none"}};
  for (const auto& [method, path, query, expected] : cases) {
    const WebReply refusal = reply(method, path, method == "POST" ? to_1_2 : "", query);
    EXPECT_EQ(refusal.status, 400u) << path << "?" << query;
    EXPECT_NE(refusal.body.find(expected), std::string::npos) << refusal.body;
  }
  EXPECT_TRUE(api.take_orders().empty()) << "nothing was done";
}

TEST_F(ApiTest, ACancellationSaysWhoAndWhy) {
  taken("a", OrderState::under_way, "r1");
  std::get<WebWait>(ask("DELETE", "/api/orders/a", "", "by=anna&why=replaced+by+b"));
  EXPECT_EQ(
      given(),
      (OrderMessage{
          .id = "drawn1", .action = Action::cancel, .cancels = "a", .by = "anna", .why = "replaced by b"}));
  EXPECT_EQ(reply("DELETE", "/api/orders/a", "", "why=" + std::string(129, 'x')).status, 400u);
  EXPECT_EQ(reply("DELETE", "/api/orders/a", "", "by=" + std::string(65, 'x')).status, 400u);
  EXPECT_EQ(reply("DELETE", "/api/orders/a", "", "by=a%0ab").status, 400u);
  EXPECT_TRUE(api.take_orders().empty());
}

TEST_F(ApiTest, AlarmsAreToldAndASilentRobotIsNoneThatArrived) {
  fleet.mission("r1");
  fleet.state("r1", {3.5, 1.5});
  fleet.status("r1", Phase::arrived);
  AlarmBoard board;
  const auto look = [&] {
    board.look(fleet.view, fleet.now);
    api.look(fleet.view, fleet.now, board);
  };
  look();
  EXPECT_EQ(reply("GET", "/api/alarms").body, R"({"alarms":[]})");
  EXPECT_NE(reply("GET", "/api/robots").body.find(R"("silent_since":null)"), std::string::npos);
  const auto stream = std::get<WebStream>(ask("GET", "/api/events"));
  EXPECT_NE(stream.next().find("event: alarms\ndata: {\"alarms\":[]}"), std::string::npos);
  fleet.now += 4;
  look();
  const std::string alarms =
      R"({"alarms":[{"kind":"robot_silent","robot":"r1","since":100.0,"text":"r1 is not heard: its agent has ended, hangs, or cannot be reached"}]})";
  EXPECT_EQ(reply("GET", "/api/alarms").body, alarms);
  EXPECT_NE(stream.next().find("event: alarms\ndata: " + alarms), std::string::npos);
  const std::string robots = reply("GET", "/api/robots").body;
  EXPECT_NE(
      robots.find(
          R"("why":"it is not heard: its agent has ended, hangs, or cannot be reached","time_left":null,"silent_since":100.0)"),
      std::string::npos)
      << robots;
  for (int k = 0; k < 10; ++k) {
    fleet.now += 1;
    look();
    EXPECT_EQ(stream.next(), "") << "a robot that stays silent is no news";
  }
}

TEST_F(ApiTest, OtherMethodsAndPathsAreRefused) {
  const std::vector<std::array<std::string, 3>> cases{{"PUT", "/api/orders", "GET, POST"},
                                                      {"POST", "/api/orders/a", "GET, DELETE"},
                                                      {"POST", "/api/robots", "GET"},
                                                      {"HEAD", "/api/events", "GET"},
                                                      {"GET", "/api/stop", "POST"}};
  for (const auto& [method, path, allowed] : cases) {
    const WebReply refusal = reply(method, path);
    EXPECT_EQ(refusal.status, 405u) << path;
    EXPECT_EQ(refusal.headers.at(0), std::pair("Allow"s, allowed)) << path;
  }
  for (const char* path : {"/api", "/api/", "/api/go", "/api/cancel", "/api/stops"})
    EXPECT_EQ(reply("POST", path).status, 404u) << path;
  EXPECT_NE(reply("GET", "/api/\xff\"\n").body.find(R"(the API has no /api/?\"\n)"), std::string::npos);
  EXPECT_NE(reply("GET", "/api/orders/%c3%bc").body.find("there is no order \u00fc"), std::string::npos);
}

TEST_F(ApiTest, RobotsHaveTheirOrderAndHalt) {
  fleet.map();
  fleet.mission("r1");
  fleet.mission("r2");
  fleet.state("r1", {0.5, 1.5}, {1, 0});
  fleet.path("r1", {{0.5, 1.5}, {3.5, 1.5}});
  api.look(fleet.view, fleet.now);
  taken("a", OrderState::under_way, "r1");
  api.on(Message(HaltMessage{.number = 1, .everybody = Halt::stopped, .robots = {{"r1", Halt::none}}}));
  const std::string body = reply("GET", "/api/robots").body;
  EXPECT_EQ(
      body.find(
          R"({"robots":[{"name":"r1","phase":"driving","x":0.5,"y":1.5,"yaw":null,"order":"a","halt":"none","why":null,"time_left":)"),
      0u)
      << body;
  EXPECT_NE(
      body.find(
          R"({"name":"r2","phase":"waiting","x":null,"y":null,"yaw":null,"order":null,"halt":"stopped")"),
      std::string::npos)
      << body;
}

TEST_F(ApiTest, EventsTellWhatIsAndThenWhatChanges) {
  fleet.mission("r1");
  fleet.state("r1", {0.5, 1.5});
  pass(1);
  const OrderMessage order = taken("a");
  const WebStream stream = std::get<WebStream>(ask("GET", "/api/events"));
  const std::string first = stream.next();
  for (const char* event : {"event: robot\ndata: {\"name\":\"r1\"", "event: order\ndata: {\"id\":\"a\"",
                            "event: halt\ndata: {\"everybody\":\"none\",\"robots\":[]}\n\n"})
    EXPECT_NE(first.find(event), std::string::npos) << first;
  EXPECT_EQ(stream.next(), "");
  say(order, OrderState::assigned, "r1");
  say(order, OrderState::assigned, "r1");
  const std::string change = stream.next();
  EXPECT_TRUE(
      change.starts_with("event: order\ndata: {\"id\":\"a\",\"action\":\"go\",\"state\":\"assigned\""))
      << change;
  EXPECT_EQ(change.find("event", 1), std::string::npos) << change;
  api.on(Message(HaltMessage{.number = 1, .robots = {{"r1", Halt::paused}}}));
  EXPECT_EQ(
      stream.next(),
      "event: halt\ndata: {\"everybody\":\"none\",\"robots\":[{\"name\":\"r1\",\"halt\":\"paused\"}]}\n\n");
  pass(1);
  EXPECT_NE(stream.next().find("\"order\":\"a\",\"halt\":\"paused\""), std::string::npos);
  const WebStream another = std::get<WebStream>(ask("GET", "/api/events"));
  EXPECT_NE(another.next().find("\"id\":\"a\""), std::string::npos) << "each client hears everything";
}

TEST_F(ApiTest, AStreamWithoutEventsIsKeptOpen) {
  const WebStream stream = std::get<WebStream>(ask("GET", "/api/events"));
  EXPECT_NE(stream.next(), "");
  pass(14);
  EXPECT_EQ(stream.next(), "");
  pass(1);
  EXPECT_TRUE(stream.next().starts_with(":"));
  EXPECT_EQ(stream.next(), "");
}

TEST_F(ApiTest, OrdersOfAServiceThatHasGoneAreForgotten) {
  const auto service = [&](WallTime since, WallTime run) {
    api.on(Message(ServiceStatus{.service = 1, .since = since, .run = {run}}));
  };
  service(90, 95);
  taken("old", OrderState::under_way, "r1");
  taken("ended", OrderState::done, "r1");
  pass(10);
  service(105, 95);
  EXPECT_EQ(reply("GET", "/api/orders/old").status, 200u) << "a service goes on with the run";
  service(105, 0);
  taken("new");
  service(105, 112);
  EXPECT_EQ(reply("GET", "/api/orders/old").status, 404u);
  EXPECT_EQ(reply("GET", "/api/orders/ended").status, 200u);
  EXPECT_EQ(reply("GET", "/api/orders/new").status, 200u);
  const std::string events = std::get<WebStream>(ask("GET", "/api/events")).next();
  EXPECT_EQ(events.find(R"("id":"old")"), std::string::npos) << events;
}

TEST_F(ApiTest, OldOrdersAreForgotten) {
  for (std::size_t k = 0; k <= OrderDesk::most_ended; ++k)
    taken("a" + std::to_string(k), OrderState::done, "r1");
  EXPECT_EQ(reply("GET", "/api/orders/a0").status, 404u);
  EXPECT_EQ(reply("GET", "/api/orders/a1").status, 200u);
  const WebStream stream = std::get<WebStream>(ask("GET", "/api/events"));
  std::string all;
  for (std::string next = stream.next(); !next.empty(); next = stream.next()) {
    EXPECT_LT(next.size(), std::size_t{300 << 10}) << "a client gets events in pieces";
    all += next;
  }
  EXPECT_EQ(all.find("\"id\":\"a0\""), std::string::npos);
  EXPECT_NE(all.find("\"id\":\"a1000\""), std::string::npos);
}

}  // namespace
}  // namespace coppice
