// Part of class Run: the states that the robot sends to its peers.
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "robot_agent/control/run.h"

namespace coppice {

namespace {

constexpr std::uint32_t heartbeats_between_relays = Timing::heartbeats_between_relays;
constexpr double recorded_after_the_end = Timing::recorded_after_the_end;
constexpr double share_of_overload = 0.25;  // of the last decisions that came late

}  // namespace

/// Tells the peers. A robot that goes on standing as it has said does so at heartbeats only.
void Run::speak(double now, bool heartbeat, std::vector<Outgoing>& out) {
  // A robot that turns on the spot says so: the process after this one must know its yaw.
  counter_.note({body_.stands() && !body_.turns_on_the_spot(), phase(), round_.id(), stage(),
                 reserver_.waits_for(), reserver_.number(), reserver_.reservations_version(),
                 fleet_.shakes_hands() && !overloaded()});
  if (counter_.rests() && !heartbeat) return;
  const RoundId* const news = counter_.has_news_of_round() ? &round_.id() : nullptr;
  auto [agents, echoes, misses] =
      fleet_.address(counter_.tick_to_say(), news, reserver_.waits_for(), overloaded(), now);
  RobotState said = state(now, std::move(echoes));
  said.misses = std::move(misses);
  said.knows = reserver_.knows(agents);
  const int copies = counter_.copies(said.copies);
  const std::vector<RobotName> again =
      copies > 1 ? fleet_.who_hears_copies(agents) : std::vector<RobotName>();
  for (; said.copy + 1 < copies; ++said.copy) out.emplace_back(said, again);
  if (said.is_new) return out.push_back(Outgoing(std::move(said)));  // to all
  out.emplace_back(std::move(said), std::move(agents));
}

void Run::relay_states(double now, std::vector<Outgoing>& out) {
  auto [last_words, hearers] = fleet_.last_words(now);
  for (RobotState& last : last_words) out.emplace_back(std::move(last), hearers);
  if (counter_.heartbeats() % heartbeats_between_relays != 0) return;
  const auto [states, those_back] = fleet_.news_for_those_back(now);
  if (those_back.empty()) return;
  // No peer confirms that it has heard these. So they are sent as often as makes one of them arrive.
  for (const RobotState& last : states)
    for (int copy = 0; copy < fleet_.copies(); ++copy) out.emplace_back(Message(last), those_back);
}

RobotState Run::state(double now, std::vector<Echo> echoes) const {
  const bool asks_for_news = now < asks_for_news_until_ && !fleet_.out_of_touch();
  return {.robot = process_.name,
          .sequence = counter_.tick(),
          .promise = body_.promise(),
          .radius = body_.radius(),
          .max_speed = body_.limits().max_speed,
          .max_acceleration = body_.limits().max_acceleration,
          .phase = phase(),
          .round = round_.id(),
          .stage = stage(),
          .reservation = reserver_.number(),
          .reservation_progress = reserver_.progress(),
          .waits_for = reserver_.waits_for(),
          .copies = copies(),
          .is_new = connectivity_.joining() || asks_for_news,
          .wants_echo = !fleet_.echoed(now),
          .may_be_unknown = fleet_.may_be_unknown(),
          .echoes = std::move(echoes),
          .run = mission_.clock.run(),
          .max_angular_speed = body_.limits().max_angular_speed,
          .max_angular_acceleration = body_.limits().max_angular_acceleration};
}

/// How often to send each state. A robot that has stood since its mission began has decided nothing that its
/// failure could hide. In a small fleet it sends several copies all the same: where much is lost, the others
/// would take themselves to be cut off. A robot whose processor is too busy for its decisions sends
/// everything once: more would not reach peers that are too busy to listen.
std::uint8_t Run::copies() const {
  const bool has_set_off = status_.driven_length > 0 || !body_.stands();
  const bool needs_copies = has_set_off || fleet_.known() <= witnesses + 1;
  return static_cast<std::uint8_t>(needs_copies && !connectivity_.joining() && !overloaded() ? fleet_.copies()
                                                                                             : 1);
}

bool Run::overloaded() const {
  return timing_.late > share_of_overload;
}

/// A robot that is bound to stand need not decide again before it has something to say.
int Run::periods_to_next_control() const {
  if (timing_.first) return 0;
  const bool rests = counter_.rests() && !round_.plans() && body_.bound_to_stand(heartbeat_interval) &&
                     !body_.turns_on_the_spot();
  return rests ? counter_.periods_to_heartbeat() : 1;
}

/// Ends some time after the run, when those who report on it have heard the last of it: agents may live for
/// months.
bool Run::records(double now) const {
  if (!fleet_.run_is_over()) return true;
  const auto* const stopped = std::get_if<Stopped>(&task_);
  return stopped == nullptr || now < stopped->at + recorded_after_the_end * fleet_.second();
}

}  // namespace coppice
