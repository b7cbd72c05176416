#include "monitor/recording/picture_book.h"

#include <algorithm>
#include <variant>

#include "coppice/files/input_error.h"

namespace coppice {

namespace {

constexpr double fine = 0.1;  // radii: the resolution of driven tracks

void add_tree(const InactiveTreesMessage& tree, PictureContent& content) {
  for (const InactiveTreesMessage::Node& node : tree.nodes) {
    if (node.parent >= 0)
      content.edges.push_back({tree.nodes[static_cast<std::size_t>(node.parent)].position, node.position});
  }
}

void add_root_trees(const SeenRobot& robot, int number, PictureContent& content) {
  for (const RootNodes::Node& node : robot.root_nodes) {
    if (node.parent < 0 || static_cast<std::size_t>(node.parent) >= robot.root_nodes.size()) continue;
    content.edges.push_back(
        {robot.root_nodes[static_cast<std::size_t>(node.parent)].position, node.position, number});
  }
}

void add_trees(const FleetView& view, PictureContent& content) {
  for (const auto& tree : view.inactive_trees()) add_tree(std::get<InactiveTreesMessage>(*tree), content);
  if (view.active_trees()) {
    for (const auto& edge : std::get<ActiveTreesMessage>(*view.active_trees()).edges)
      content.edges.push_back({edge.from, edge.to});
  }
}

}  // namespace

PictureBook::PictureBook(const Recording& recording)
    : playback_(recording, recording.begin()), next_(playback_.next()) {
  // The first mission tells when fleet time was 0.
  Playback missions(recording, recording.begin(), Topics().set(topic_number<Mission>()));
  const auto mission = missions.next();
  if (!mission)
    throw InputError("the recording holds no mission, expected at least one: there is no fleet to draw");
  clock_ = std::get<Mission>(*mission->message).clock;
  begin_ = std::max(0.0, clock_.fleet_time(recording.begin()));
  end_ = clock_.fleet_time(recording.end());
}

PictureContent PictureBook::at(double time) {
  for (; next_ && clock_.fleet_time(next_->at) <= time; next_ = playback_.next()) take(*next_);
  PictureContent content;
  if (!view_.map()) return content;
  content.map = view_.map()->map;
  add_trees(view_, content);
  for (const SeenRobot& seen : view_.robots()) {
    add_root_trees(seen, static_cast<int>(content.robots.size()), content);
    content.robots.push_back(drawn(seen, time));
  }
  return content;
}

void PictureBook::take(const Arrival& arrival) {
  view_.on(arrival.message, arrival.at);
  if (view_.run() != run_) driven_.clear();
  run_ = view_.run();
  const auto* state = std::get_if<RobotState>(arrival.message.get());
  if (state == nullptr || state->passed_on) return;
  Path& way = driven_[state->robot];
  if (way.empty() || (way.back() - state->promise.position).norm() > fine * state->radius)
    way.push_back(state->promise.position);
}

PictureContent::Robot PictureBook::drawn(const SeenRobot& seen, double time) const {
  PictureContent::Robot robot{.name = seen.name, .path = seen.path};
  if (seen.mission) {
    robot.radius = own_radius(*seen.mission);
    robot.footprint = seen.mission->footprint;
    robot.yaw = seen.mission->start_yaw;
    robot.goal_yaw = seen.mission->goal_yaw;
    robot.has_heading = seen.mission->max_angular_speed > 0;
    robot.start = seen.mission->start;
    robot.goal = seen.mission->goal;
  }
  if (!seen.state) return robot;
  if (!seen.mission) robot.radius = seen.state->radius;
  // In a later run than the first, fleet time has another origin.
  const double at = view_.fleet_time(clock_.wall_time(time)).value_or(time);
  robot.body = position_at(*seen.state, at);
  robot.yaw = yaw_at(*seen.state, at);
  if (const auto known = driven_.find(seen.name); known != driven_.end()) robot.track = known->second;
  robot.track.push_back(*robot.body);
  return robot;
}

}  // namespace coppice
