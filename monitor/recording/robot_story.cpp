#include "monitor/recording/robot_story.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <variant>

#include "coppice/files/input_error.h"

namespace coppice {

namespace {

// Seconds: shorter acts are parts of those around them. A robot that may go on needs a moment to set off.
constexpr double brief = 0.25;
constexpr double brief_if_blocked = 0.5;
constexpr WallTime between_counts = 0.25;  // seconds between two looks for robots that fell silent

/// A short act of this kind tells nothing: a robot that speeds up or brakes is slow for a moment.
bool may_be_left_out(Act act) {
  return act < Act::halted;
}
bool is_brief(const Episode& e) {
  const double shortest = e.doing.act == Act::blocked ? brief_if_blocked : brief;
  return may_be_left_out(e.doing.act) && e.until - e.from < shortest - 1e-6;
}

bool goes_on(const Episode& e, const Doing& doing, std::uint32_t mission) {
  if (e.doing.act != doing.act || e.mission != mission) return false;
  return doing.act == Act::blocked || e.doing.other == doing.other;
}

void name(const RobotName& other, std::vector<RobotName>& others) {
  if (!other.empty() && std::ranges::count(others, other) == 0) others.push_back(other);
}

/// The second one follows the first one.
void append(const Episode& next, Episode& e) {
  e.until = next.until;
  e.end = next.end;
  e.driven += next.driven;
  if (next.doing.act != e.doing.act) return;
  for (const RobotName& other : next.others) name(other, e.others);
  if (!next.doing.words.empty()) e.doing.words = next.doing.words;
}

/// The brief first one becomes the beginning of the second one.
Episode prepended(const Episode& first, Episode e) {
  e.from = first.from;
  e.begin = first.begin;
  e.driven += first.driven;
  return e;
}

/// Without acts that are too brief to tell anything.
Story smoothed(const Story& raw) {
  Story story;
  for (const Episode& e : raw) {
    Episode* const last = story.empty() ? nullptr : &story.back();
    const bool is_of_mission = last != nullptr && last->mission == e.mission && last->until == e.from;
    if (is_of_mission && (is_brief(e) || goes_on(*last, e.doing, e.mission))) {
      append(e, *last);
    } else if (is_of_mission && is_brief(*last)) {
      *last = prepended(*last, e);
    } else {
      story.push_back(e);
    }
  }
  return story;
}

Reserving reserving(const SaidReservation* said) {
  if (said == nullptr) return Reserving::nothing;
  if (said->has_trajectory()) return Reserving::trajectory;
  if (said->is_wish()) return Reserving::wish;
  return said->is_given_up ? Reserving::given_up : Reserving::nothing;
}

/// Writes the stories of all robots. A state machine: messages go in, in the order of time.
class StoryWriter {
 public:
  explicit StoryWriter(const WaitLog& waits) : waits_(&waits) {}

  void on(const Arrival& arrival) {
    moment_.on(arrival);
    if (arrival.at >= counted_at_ + between_counts) note_silence(arrival.at);
    const auto* const state = std::get_if<RobotState>(arrival.message.get());
    if (state == nullptr || state->passed_on) return;
    const SeenRobot* const robot = moment_.robot(state->robot);
    if (robot != nullptr && robot->state && *robot->state == *state) take(*robot, arrival.at);
  }

  Stories finish(WallTime begin, WallTime end) {
    note_silence(end);
    Stories stories{.begin = std::max(0.0, first_.fleet_time(begin)),
                    .end = moment_.time_at(end).value_or(0)};
    for (const auto& [robot, writing] : writings_) stories.robots[robot] = smoothed(writing.story);
    return stories;
  }

  void begin_at(const FleetClock& first) { first_ = first; }
  void know(const RobotName& robot) { writings_.try_emplace(robot); }

 private:
  struct Writing {
    Story story{};
    double last = 0;  ///< stamp of the last state
    RunId run{};
  };

  void take(const SeenRobot& robot, WallTime at);
  void note_silence(WallTime at);
  Episode begun(const SeenRobot& robot, Doing doing, double time) const;
  void add_gate(const RobotState& state, Episode& e) const;
  void go_on(const SeenRobot& robot, Episode& e) const;

  const WaitLog* waits_;
  FleetClock first_{};
  FleetMoment moment_;
  std::map<RobotName, Writing> writings_;
  WallTime counted_at_ = 0;
};

void StoryWriter::take(const SeenRobot& robot, WallTime at) {
  const RobotState& state = *robot.state;
  Writing& writing = writings_[robot.name];
  const auto time = moment_.time_of(state.promise.stamp);
  if (!time || (writing.run == state.run && state.promise.stamp <= writing.last && !writing.story.empty()))
    return;
  const bool is_of_this_run = writing.run == state.run;
  writing.last = state.promise.stamp;
  writing.run = state.run;
  Doing doing = doing_of(moment_, robot, waits_->around(robot.name, at));
  Story& story = writing.story;
  if (!story.empty() && is_of_this_run) {
    Episode& e = story.back();
    e.driven += (state.promise.position - e.end).norm();
    e.end = state.promise.position;
    e.until = *time;
  }
  const std::uint32_t mission = robot.mission ? robot.mission->number : 0;
  if (story.empty() || !is_of_this_run || !goes_on(story.back(), doing, mission)) {
    story.push_back(begun(robot, std::move(doing), *time));
  } else {
    name(doing.other, story.back().others);
    if (!doing.words.empty()) story.back().doing.words = std::move(doing.words);
  }
  go_on(robot, story.back());
}

Episode StoryWriter::begun(const SeenRobot& robot, Doing doing, double time) const {
  const RobotState& state = *robot.state;
  const SaidReservation* const said = moment_.reservation(robot.name);
  Episode e{.doing = std::move(doing),
            .from = time,
            .until = time,
            .begin = state.promise.position,
            .end = state.promise.position,
            .radius = state.radius,
            .reserving = reserving(said)};
  name(e.doing.other, e.others);
  if (robot.mission) {
    e.mission = robot.mission->number;
    e.goal = robot.mission->goal;
  }
  if (state.stage == Stage::executing && said != nullptr) e.plan = said->message.plan.leader;
  if (e.doing.act == Act::gate) add_gate(state, e);
  return e;
}

void StoryWriter::add_gate(const RobotState& state, Episode& e) const {
  e.gate = gate_ahead(moment_, state, e.doing.other);
  const SeenRobot* const first = moment_.robot(e.doing.other);
  if (first != nullptr && first->state) e.behind = first->state->waits_for;
}

/// What may be told only later.
void StoryWriter::go_on(const SeenRobot& robot, Episode& e) const {
  const OrderMessage* const order =
      e.doing.act == Act::halted ? moment_.halt_of(robot.name) : moment_.order_of(robot);
  if (order == nullptr) return;
  e.order = order->id;
  e.by = order->by;
}

void StoryWriter::note_silence(WallTime at) {
  counted_at_ = at;
  for (const SeenRobot& robot : moment_.view().robots()) {
    const auto writing = writings_.find(robot.name);
    if (writing == writings_.end() || writing->second.story.empty() || !is_lost(robot, at)) continue;
    Story& story = writing->second.story;
    if (story.back().doing.act != Act::silent)
      story.push_back(begun(robot, {.act = Act::silent}, story.back().until));
    story.back().until = std::max(story.back().until, moment_.time_at(at).value_or(0));
    if (!story.back().failed_since) story.back().failed_since = moment_.failed_since(robot.name);
  }
}

}  // namespace

Topics topics_of_stories() {
  return Topics()
      .set()
      .reset(topic_number<TrackMessage>())
      .reset(topic_number<RootNodes>())
      .reset(topic_number<InactiveTreesMessage>())
      .reset(topic_number<ActiveTreesMessage>());
}

Stories stories_of(const Recording& recording) {
  const Topics told = Topics().set(topic_number<Mission>()).set(topic_number<AgentStatus>());
  WaitLog waits;
  StoryWriter writer(waits);
  bool has_mission = false;
  Playback first(recording, recording.begin(), told);
  while (const auto next = first.next()) {
    if (const auto* status = std::get_if<AgentStatus>(next->message.get())) {
      waits.on(*status, next->at);
      writer.know(status->robot);
    } else if (const auto* mission = std::get_if<Mission>(next->message.get())) {
      if (!std::exchange(has_mission, true)) writer.begin_at(mission->clock);
      writer.know(mission->robot);
    }
  }
  if (!has_mission)
    throw InputError("the recording holds no mission, expected at least one: there is no fleet in it");
  Playback playback(recording, recording.begin(), topics_of_stories());
  while (const auto next = playback.next()) writer.on(*next);
  return writer.finish(recording.begin(), recording.end());
}

const Episode* episode_at(const Story& story, double time) {
  const auto later = std::ranges::find_if(story, [&](const Episode& e) { return e.from > time; });
  return later == story.begin() ? nullptr : &*std::prev(later);
}

}  // namespace coppice
