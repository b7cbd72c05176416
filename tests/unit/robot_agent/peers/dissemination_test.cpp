// Tests of how often each peer is sent a state, and of what silence means at a distance.
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "messages/validation.h"
#include "robot_agent/peers/fleet.h"
#include "robot_agent/peers/send_interval.h"
#include "tests/unit/robot_agent/states.h"

namespace coppice {
namespace {

TEST(Dissemination, TheSendIntervalGrowsWithTheDistance) {
  EXPECT_EQ(send_interval(-1, 40), 1);
  EXPECT_EQ(send_interval(16, 40), 1);
  EXPECT_EQ(send_interval(1e6, 40), longest_interval);
  int last = 1;
  for (double gap = 0; gap < 300; gap += 0.5) {
    const int interval = send_interval(gap, 40);
    EXPECT_GE(interval, last);
    EXPECT_TRUE(std::has_single_bit(static_cast<unsigned>(interval)));
    last = interval;
  }
}

TEST(Dissemination, TheNextStateComesBeforeTwoDistantRobotsCanMeet) {
  for (double gap = 20; gap < 300; gap += 0.5)
    EXPECT_LT(send_interval(gap, 40) * period, 0.65 * gap / 40) << gap;
}

TEST(Dissemination, APeerIsDueOnceInEachSendInterval) {
  for (const char* robot : {"a", "r17", "a robot with a long name"}) {
    for (int interval = 1; interval <= longest_interval; interval *= 2) {
      int ticks = 0;
      for (std::uint32_t tick = 1000; tick < 1000u + longest_interval; ++tick)
        ticks += is_tick_of(phase_of(robot), tick, interval);
      EXPECT_EQ(ticks, longest_interval / interval);
    }
  }
}

TEST(Dissemination, TheNextTickIsTheFirstDueTickAfterTheGivenOne) {
  const std::uint32_t phase = phase_of("r17");
  for (int interval = 1; interval <= longest_interval; interval *= 2) {
    for (std::uint32_t tick = 1000; tick < 1000u + longest_interval; ++tick) {
      std::uint32_t next = tick + 1;
      while (!is_tick_of(phase, next, interval)) ++next;
      EXPECT_EQ(next_tick_of(phase, tick, interval), next);
    }
  }
}

struct How {
  bool passed_on = false;
  bool wants_echo = false;
  std::vector<RobotName> misses{};
};

/// Robot "a" stands at the left end of a row of robots that are 100 m apart.
class Row {
 public:
  explicit Row(int others)
      : field_(OccupancyMap{.width = 10000, .height = 20, .blocked = std::vector<std::uint8_t>(200000, 0)}) {
    fleet_.hear(mission("a", 0), 0);
    for (int k = 1; k <= others; ++k) fleet_.hear(mission(name(k), k), 0);
  }

  static RobotName name(int k) { return fmt::format("r{}", k); }
  static Point2 place(int k) { return {10 + 100.0 * k, 10}; }

  void hear(int k, double stamp, double arrived, std::vector<Echo> echoes = {}, How how = {}) {
    hear_at(k, k, stamp, arrived, std::move(echoes), std::move(how));
  }
  /// The robot with the number k is where that with the number `at` began.
  void hear_at(int k, int at, double stamp, double arrived, std::vector<Echo> echoes, How how = {}) {
    RobotState state = state_of(name(k), stamp, place(at));
    state.passed_on = how.passed_on;
    state.wants_echo = how.wants_echo;
    state.misses = how.misses;
    state.echoes = std::move(echoes);
    fleet_.hear(std::make_shared<const RobotState>(state), arrived);
  }
  void judge(double now) { fleet_.detect_failures(now, place(0), {}, field_); }
  Fleet& fleet() { return fleet_; }
  bool failed(int k) const { return fleet_.find(name(k))->failed; }

 private:
  static Mission mission(const RobotName& robot, int k) {
    return {.robot = robot,
            .start = place(k),
            .goal = place(k),
            .radius = 5,
            .max_speed = 20,
            .max_acceleration = 40,
            .clock = {}};
  }

  ClearanceField field_;
  Fleet fleet_{"a"};
};

TEST(Dissemination, WitnessesHearEveryStateAndOtherPeersHearSome) {
  Row row(40);
  std::map<RobotName, int> heard;
  const int ticks = 10 * longest_interval;
  for (int tick = 0; tick < ticks; ++tick) {
    const double now = tick * period;
    for (int k = 1; k <= 40; ++k) row.hear(k, now, now + 0.001, {{"a", now - period, now - period + 0.001}});
    row.judge(now);
    const auto to = row.fleet().address(static_cast<std::uint32_t>(tick), nullptr, {}, false, now);
    for (const RobotName& robot : to.agents) ++heard[robot];
  }
  for (int k = 1; k <= 6; ++k) EXPECT_EQ(heard[Row::name(k)], ticks) << k;
  int all = 0;
  for (int k = 1; k <= 40; ++k) {
    EXPECT_GE(heard[Row::name(k)], ticks / longest_interval) << k;
    all += heard[Row::name(k)];
  }
  EXPECT_LT(all, 9 * ticks);
}

// The fleet has more peers than one state has echoes for.
TEST(Dissemination, PeersThatDoNotKnowTheClockGetEchoesInTurn) {
  constexpr int peers = 100;
  Row row(peers);
  for (int k = 1; k <= peers; ++k) row.hear(k, 0, 0.001);
  row.judge(0);
  std::map<RobotName, int> echoes;
  for (std::uint32_t tick = 1; tick <= 4; ++tick) {
    const auto to = row.fleet().address(tick, nullptr, {}, false, tick * period);
    EXPECT_LE(to.echoes.size(), most_echoes);
    for (const Echo& echo : to.echoes) echoes[echo.robot] += std::ranges::count(to.agents, echo.robot) > 0;
  }
  for (int k = 1; k <= peers; ++k) EXPECT_GE(echoes[Row::name(k)], 1) << k;
  EXPECT_TRUE(row.fleet().shakes_hands());
}

TEST(Dissemination, APeerThatIsToBeAnsweredIsToldAtOnce) {
  Row row(40);
  std::uint32_t tick = 0;
  const auto tell = [&] {
    const double now = ++tick * period;
    for (int k = 1; k <= 40; ++k) row.hear(k, now, now + 0.001, {{"a", now - period, now - period + 0.001}});
    row.judge(now);
    return row.fleet().address(tick, nullptr, {}, false, now).agents;
  };
  int rare = 0;
  for (int k = 0; k < 2 * longest_interval; ++k) tell();
  for (int k = 0; k < 20; ++k) {
    rare += static_cast<int>(std::ranges::count(tell(), Row::name(40)));
    row.fleet().answer(Row::name(40));
    EXPECT_EQ(std::ranges::count(tell(), Row::name(40)), 1);
  }
  EXPECT_LT(rare, 5);
  EXPECT_FALSE(row.fleet().shakes_hands());
}

TEST(Dissemination, CopiesGoToWitnessesAndToSynchronisedPeers) {
  Row row(40);
  std::vector<RobotName> all;
  for (int k = 1; k <= 40; ++k) all.push_back(Row::name(k));
  for (int tick = 0; tick < 10 * longest_interval; ++tick) {
    const double now = tick * period;
    for (int k = 1; k <= 40; ++k)
      row.hear(k, now, now + 0.001,
               k <= 20 ? std::vector<Echo>{{"a", now - period, now - period + 0.001}} : std::vector<Echo>{});
    row.judge(now);
    row.fleet().address(static_cast<std::uint32_t>(tick), nullptr, {}, false, now);
    const auto again = row.fleet().who_hears_copies(all);
    for (int k = 1; k <= 6; ++k) EXPECT_EQ(std::ranges::count(again, Row::name(k)), 1) << k;
    for (int k = 21; k <= 40; ++k) EXPECT_EQ(std::ranges::count(again, Row::name(k)), 0) << k;
  }
  EXPECT_EQ(row.fleet().who_hears_copies(all).size(), 20u);
}

TEST(Dissemination, APeerWithoutAnEchoGetsOneWithTheNextState) {
  Row row(60);
  double now = 0;
  std::uint32_t tick = 0;
  const auto echoed_in_turn = [&](bool asks) {
    now = ++tick * period;
    for (int k = 1; k <= 60; ++k)
      row.hear(k, now, now + 0.001, {{"a", now - period, now - period + 0.001}},
               {.wants_echo = asks && k == 2});
    row.judge(now);
    const auto echoes = row.fleet().address(tick, nullptr, {}, false, now).echoes;
    return std::ranges::count(echoes, Row::name(2), &Echo::robot) == 1;
  };
  for (int k = 0; k < 400; ++k) echoed_in_turn(false);  // the clocks are synchronised
  int unasked = 0;
  for (int k = 0; k < 40; ++k) unasked += echoed_in_turn(false);
  EXPECT_LT(unasked, 10);
  for (int k = 0; k < 40; ++k) EXPECT_TRUE(echoed_in_turn(true));
}

TEST(Dissemination, APeerThatMissesAHeardRobotIsToldSoonAndRarely) {
  Row row(60);
  double now = 0;
  std::uint32_t tick = 0;
  const auto tells = [&](const std::vector<RobotName>& missed) {
    now = ++tick * period;
    for (int k = 1; k <= 50; ++k)
      row.hear(k, now, now + 0.001, {{"a", now - period, now - period + 0.001}},
               {.misses = k == 30 ? missed : std::vector<RobotName>()});
    row.judge(now);
    const auto to = row.fleet().address(tick, nullptr, {}, false, now);
    const auto is_told = [&](const RobotName& robot) {
      return std::ranges::find(to.echoes, robot, &Echo::robot) != to.echoes.end();
    };
    return std::ranges::count(to.agents, Row::name(30)) == 1 && !missed.empty() &&
           std::ranges::all_of(missed, is_told);
  };
  for (int k = 0; k < 1000; ++k) tells({});
  int told = 0;
  for (int k = 0; k < 40; ++k) told += tells({"r40", "r41"});
  EXPECT_GE(told, 4);
  EXPECT_LE(told, 6);
  // Nothing is told of robots that are not heard here either.
  for (int k = 0; k < 128; ++k) EXPECT_FALSE(tells({"r55", "r99"}));
}

// A standing robot sends at every fourth tick, and hears the peer more often than that.
// Where all are busy, all seem silent, and all ask. Nobody may then spend what is left on answers.
TEST(Dissemination, ABusyRobotAnswersAFewPeersInATickAndAllInTurn) {
  constexpr std::uint32_t peers = 40;
  Row row(peers);
  std::uint32_t tick = 0;
  const auto tell = [&](bool busy) {
    const double now = ++tick * period;
    for (int k = 1; k <= static_cast<int>(peers); ++k)
      row.hear(k, now, now + 0.001, {{"a", now - period, now - period + 0.001}});
    row.judge(now);
    return row.fleet().address(tick, nullptr, {}, busy, now);
  };
  for (int k = 0; k < 2 * longest_interval; ++k) tell(false);
  for (int k = 1; k <= static_cast<int>(peers); ++k) row.fleet().answer(Row::name(k));
  std::set<RobotName> answered;
  for (std::uint32_t k = 0; k < peers / Timing::answers_if_busy; ++k) {
    const auto to = tell(true);
    EXPECT_LE(to.agents.size(), witnesses + Timing::answers_if_busy + 6) << "6 are due anyway, at most";
    for (const Echo& echo : to.echoes) answered.insert(echo.robot);
  }
  EXPECT_EQ(answered.size(), peers);
}

/// Two peers at nearly the same distance come and go by turns.
TEST(Dissemination, WitnessesDoNotChangeWithSmallDistances) {
  Row row(40);
  std::uint32_t tick = 0;
  std::set<RobotName> always;
  for (; tick < 2 * longest_interval; ++tick) {
    const double now = tick * period;
    for (int k = 1; k <= 40; ++k) row.hear(k, now, now + 0.001, {{"a", now - period, now - period + 0.001}});
    row.judge(now);
    row.fleet().address(tick, nullptr, {}, false, now);
  }
  int sixth = 0;
  constexpr int ticks = 2 * longest_interval;
  for (int k = 0; k < ticks; ++k, ++tick) {
    const double now = tick * period;
    const bool seventh_is_closer = k / Timing::ticks_per_choice % 2 == 1;
    for (int peer = 1; peer <= 40; ++peer) {
      const int at = seventh_is_closer && peer == 6 ? 7 : seventh_is_closer && peer == 7 ? 6 : peer;
      row.hear_at(peer, at, now, now + 0.001, {{"a", now - period, now - period + 0.001}});
    }
    row.judge(now);
    const auto to = row.fleet().address(tick, nullptr, {}, false, now);
    sixth += static_cast<int>(std::ranges::count(to.agents, Row::name(6)));
  }
  EXPECT_EQ(sixth, ticks);
}

TEST(Dissemination, AnAnswerIsSentWithTheNextState) {
  Row row(60);
  int told = 0;
  for (std::uint32_t tick = 1; tick < 2000; ++tick) {
    const double now = tick * period;
    const bool asks = tick % 4 == 1;
    for (int k = 1; k <= 50; ++k)
      row.hear(k, now, now + 0.001, {{"a", now - period, now - period + 0.001}},
               {.misses = k != 30 ? std::vector<RobotName>() : std::vector<RobotName>{asks ? "r40" : "r55"}});
    row.judge(now);
    if (tick % 4 != 0) continue;
    const auto to = row.fleet().address(tick, nullptr, {}, false, now);
    const bool answers = std::ranges::count(to.agents, Row::name(30)) == 1 &&
                         std::ranges::find(to.echoes, "r40", &Echo::robot) != to.echoes.end();
    told += tick > 1000 && answers;
  }
  EXPECT_GT(told, 1000 / 12 - 5);
}

/// What a robot relays in so many heartbeats, while all others are silent.
struct Relayed {
  std::map<RobotName, int> told;    ///< hearers
  std::map<RobotName, int> spread;  ///< robots whose states were relayed
  std::size_t most = 0;             ///< samples at one heartbeat
};
Relayed relays_of(Row& row, int heartbeats) {
  Relayed relayed;
  for (int heartbeat = 0; heartbeat < heartbeats; ++heartbeat) {
    const auto [states, hearers] = row.fleet().last_words(Timing::relay_from + 1);
    for (const RobotName& robot : hearers) ++relayed.told[robot];
    for (const RobotState& state : states) {
      EXPECT_TRUE(state.passed_on);
      ++relayed.spread[state.robot];
    }
    relayed.most = std::max(relayed.most, states.size() * hearers.size());
  }
  return relayed;
}

// Where all processes are late, all seem silent. Each robot relayed the states of all others to a quarter of
// all others. 200 processes on two cores did little else, and stayed late.
TEST(Dissemination, ARobotRelaysFewStatesToFewPeersAtATimeAndAllInTurn) {
  Row row(96);
  for (int k = 1; k <= 96; ++k) row.hear_at(k, 0, 0, 0.001, {});
  const Relayed relayed = relays_of(row, 12);
  EXPECT_LE(relayed.most, Timing::relayed_at_once * Timing::relayed_at_once);
  for (int k = 1; k <= 96; ++k) {
    EXPECT_EQ(relayed.told.at(Row::name(k)), 2) << k;
    EXPECT_EQ(relayed.spread.at(Row::name(k)), 2) << k;
  }
}

TEST(Dissemination, AllPeersOfASmallFleetHearARelayAtEachHeartbeat) {
  Row row(7);
  for (int k = 1; k <= 7; ++k) row.hear_at(k, 0, 0, 0.001, {});
  const Relayed relayed = relays_of(row, 3);
  for (int k = 1; k <= 7; ++k) EXPECT_EQ(relayed.told.at(Row::name(k)), 3) << k;
}

TEST(Dissemination, NoPeerIsAskedBeforeTheRobotHasAMission) {
  Fleet fleet("a");
  for (const char* robot : {"b", "c"}) {
    RobotState state = state_of(robot, 0, {10, 10});
    state.misses = {"b", "c"};
    EXPECT_TRUE(fleet.hear(std::make_shared<const RobotState>(state), 0.001));
  }
  EXPECT_TRUE(fleet.address(0, nullptr, {}, false, 0).agents.empty());
}

TEST(Dissemination, TheRobotAsksForAllMissingPeers) {
  Row row(5);
  for (std::uint32_t tick = 0; tick < 200; ++tick) {
    const double now = tick * period;
    for (int k = 1; k <= 3; ++k) row.hear(k, now, now + 0.001);
    row.judge(now);
    std::vector<RobotName> missed = row.fleet().address(tick, nullptr, {}, false, now).misses;
    std::ranges::sort(missed);
    if (now < 0.9) {
      EXPECT_TRUE(missed.empty()) << now;
    }
    if (now > 1.1) {
      EXPECT_EQ(missed, (std::vector<RobotName>{"r4", "r5"})) << now;
    }
  }
}

// Send intervals are powers of two. A peer that hears every n-th state still hears of all missing robots.
TEST(Dissemination, TheRobotAsksForManyMissingPeersInTurn) {
  for (const int robots : {21, 25, 35}) {
    Row row(robots);
    std::map<RobotName, int> asked_for;
    for (std::uint32_t tick = 0; tick < 200 * longest_interval; ++tick) {
      const double now = tick * period;
      for (int k = 1; k <= 3; ++k) row.hear(k, now, now + 0.001);
      row.judge(now);
      const auto missed = row.fleet().address(tick, nullptr, {}, false, now).misses;
      EXPECT_LE(missed.size(), most_missed);
      if (now > 30 && is_tick_of(0, tick, longest_interval)) {
        EXPECT_TRUE(row.failed(10));
        for (const RobotName& robot : missed) ++asked_for[robot];
      }
    }
    for (int k = 4; k <= robots; ++k) EXPECT_GT(asked_for[Row::name(k)], 50) << robots << ": " << k;
  }
}

// The route over other robots is longer than the direct one.
TEST(Dissemination, APeerThatOthersHearRarelyIsNotDeclaredFailed) {
  const double heartbeat = longest_interval * period;
  for (const int silent : {8, 1}) {
    Row row(8);
    for (double now = 0; now < 300; now += period) {
      for (int k = 1; k <= 8; ++k) {
        if (k == silent) continue;
        const bool tells = k == (silent == 8 ? 1 : 8) && std::fmod(now, heartbeat) < period;
        row.hear(k, now, now + 0.001,
                 tells ? std::vector<Echo>{{Row::name(silent), now - 0.1, now}} : std::vector<Echo>{});
      }
      row.judge(now);
      EXPECT_FALSE(row.failed(silent)) << now;
      if (now > 10) {
        EXPECT_TRUE(row.fleet().cut_off()) << now;
      }
    }
    EXPECT_EQ(row.fleet().heard_by_others_only(), Row::name(silent));
  }
}

TEST(Dissemination, ADistantPeerMayStaySilentForLong) {
  Row row(3);
  const double heartbeat = longest_interval * period;
  for (double now = 0; now < 100; now += period) {
    row.hear(1, now, now + 0.001, {{"a", now - period, now - period + 0.001}});
    if (std::fmod(now, heartbeat) < period && now < 60) {
      row.hear(2, now, now + 0.001);
      row.hear(3, now, now + 0.001);
    }
    row.judge(now);
    if (now < 60) {
      EXPECT_FALSE(row.fleet().cut_off()) << now;
      EXPECT_FALSE(row.failed(2)) << now;
    }
  }
  EXPECT_FALSE(row.failed(3));
}

TEST(Dissemination, APeerThatItsNeighboursNoLongerHearIsDeclaredFailedFarAway) {
  Row row(3);
  double now = 0;
  const auto go_on_until = [&](double end, bool passed_on) {
    for (; now < end; now += period) {
      for (const int k : {1, 2}) row.hear(k, now, now + 0.001, {{"a", now - period, now - period + 0.001}});
      row.hear(3, 10, now + 0.002, {}, {.passed_on = passed_on});  // the network may deliver it twice
      row.judge(now);
    }
  };
  go_on_until(10, false);
  row.hear(3, 10, 10.001);
  go_on_until(14, false);
  EXPECT_FALSE(row.failed(3));
  go_on_until(15, true);  // a pause of its process, or a few lost samples
  EXPECT_FALSE(row.failed(3));
  go_on_until(20, false);
  EXPECT_FALSE(row.failed(3));
  go_on_until(23, true);
  EXPECT_TRUE(row.failed(3));
}

}  // namespace
}  // namespace coppice
