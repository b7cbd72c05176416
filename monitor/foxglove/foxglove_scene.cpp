#include "monitor/foxglove/foxglove_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <google/protobuf/util/time_util.h>

#include "messages/silence.h"

namespace coppice::foxglove_scene {

namespace {

namespace fox = ::foxglove;

// Heights above the map, metres.
constexpr double trees_height = 0.05;
constexpr double paths_height = 0.1;
constexpr double arrow_seconds = 0.5;  // seconds: an arrow shows the motion in this time
constexpr double standing = 0.01;      // m/s: a slower robot has no heading

struct Rgb {
  double r, g, b;
};
constexpr Rgb tree_colour{0.55, 0.60, 0.66};
constexpr Rgb start_colour{0.30, 0.62, 0.42};
constexpr Rgb goal_colour{0.83, 0.47, 0.20};
constexpr Rgb silent_colour{0.45, 0.45, 0.45};

Rgb colour_of(Phase phase) {
  switch (phase) {
    case Phase::waiting:
      return {0.62, 0.62, 0.62};
    case Phase::planning:
      return {0.85, 0.65, 0.13};
    case Phase::driving:
      return {0.15, 0.45, 0.85};
    case Phase::arrived:
      return {0.20, 0.65, 0.32};
    case Phase::no_path:
    case Phase::gave_up:
      return {0.80, 0.20, 0.18};
    case Phase::halted:
      return {0.75, 0.35, 0.60};
    case Phase::stopped:
      return {0.40, 0.35, 0.55};
  }
  return silent_colour;
}

const char* text_of(const AgentStatus& status) {
  constexpr std::array texts{"waits",       "plans",       "drives",       "has arrived",
                             "has no path", "has stopped", "has given up", "is halted"};
  // If a run ends with an arrival, "stopped" may be the only status that is received: only the last status of
  // a robot is kept.
  if (status.phase == Phase::stopped && status.arrival_time > 0) return "has stopped at its goal";
  return texts.at(static_cast<std::size_t>(status.phase));
}

void set(fox::Color& out, const Rgb& colour, double opacity = 1) {
  out.set_r(colour.r);
  out.set_g(colour.g);
  out.set_b(colour.b);
  out.set_a(opacity);
}

template <class V>
void set(V& out, const Point2& p, double z) {
  out.set_x(p.x());
  out.set_y(p.y());
  out.set_z(z);
}

/// A rotation about z, from x towards y.
void set_turn(fox::Quaternion& out, double angle) {
  out.set_x(0);
  out.set_y(0);
  out.set_z(std::sin(angle / 2));
  out.set_w(std::cos(angle / 2));
}

void set(fox::Pose& out, const Point2& place, double z, double angle = 0) {
  set(*out.mutable_position(), place, z);
  set_turn(*out.mutable_orientation(), angle);
}

google::protobuf::Timestamp stamp(WallTime now) {
  return google::protobuf::util::TimeUtil::NanosecondsToTimestamp(std::llround(now * 1e6) * 1000);
}

fox::SceneEntity& add_entity(fox::SceneUpdate& scene, const std::string& id, WallTime now) {
  fox::SceneEntity& entity = *scene.add_entities();
  *entity.mutable_timestamp() = stamp(now);
  entity.set_frame_id(frame_id);
  entity.set_id(id);
  return entity;
}

void add_deletion(fox::SceneUpdate& scene, const std::string& id, WallTime now) {
  fox::SceneEntityDeletion& deletion = *scene.add_deletions();
  *deletion.mutable_timestamp() = stamp(now);
  deletion.set_type(fox::SceneEntityDeletion::MATCHING_ID);
  deletion.set_id(id);
}

fox::LinePrimitive& add_lines(fox::SceneEntity& entity, fox::LinePrimitive::Type type, const Rgb& colour,
                              double opacity, double pixels, Projection projection) {
  fox::LinePrimitive& line = *entity.add_lines();
  line.set_type(type);
  set(*line.mutable_pose(), projection(projection.origin), 0);
  line.set_thickness(pixels);
  line.set_scale_invariant(true);
  set(*line.mutable_color(), colour, opacity);
  return line;
}

void add_point(fox::LinePrimitive& line, const Point2& point, double height, Projection projection) {
  set(*line.add_points(), projection(point - projection.origin), height);
}

std::string part_id(const RobotName& robot, std::uint32_t part) {
  return fmt::format("{}/{}", robot, part);
}

struct Motion {
  Point2 place;
  Point2 velocity;
  double heading;  ///< of a holonomic robot: where it drives, and 0 while it stands
};

/// The motion in Foxglove's frame.
Motion motion_of(const RobotState& state, double time, Projection projection) {
  const Point2 velocity =
      projection(time < state.promise.decision_time ? state.promise.velocity : state.promise.next_velocity);
  const bool moves = velocity.norm() > standing;
  const double yaw = (projection.y_down ? -1 : 1) * yaw_at(state, time);
  const double heading = state.max_angular_speed > 0 ? yaw
                         : moves                     ? std::atan2(velocity.y(), velocity.x())
                                                     : 0;
  return {projection(position_at(state, time)), velocity, heading};
}

void draw_footprint(fox::SceneEntity& entity, const Mission& mission, const Motion& motion, const Rgb& colour,
                    bool y_down) {
  fox::LinePrimitive& line = *entity.add_lines();
  line.set_type(fox::LinePrimitive::LINE_LOOP);
  set(*line.mutable_pose(), motion.place, own_radius(mission), motion.heading);
  line.set_thickness(2);
  line.set_scale_invariant(true);
  set(*line.mutable_color(), colour, 1);
  for (const Point2& corner : mission.footprint)
    set(*line.add_points(), y_down ? Point2(corner.x(), -corner.y()) : corner, 0);
}

void draw_robot(fox::SceneEntity& entity, const SeenRobot& robot, const Motion& motion, const Rgb& colour,
                bool y_down) {
  const double radius = robot.mission ? own_radius(*robot.mission) : robot.state->radius;
  if (robot.mission && !robot.mission->footprint.empty())
    draw_footprint(entity, *robot.mission, motion, colour, y_down);
  fox::CylinderPrimitive& body = *entity.add_cylinders();
  set(*body.mutable_pose(), motion.place, radius / 2);
  set(*body.mutable_size(), Point2(2 * radius, 2 * radius), radius);
  body.set_bottom_scale(1);
  body.set_top_scale(1);
  set(*body.mutable_color(), colour, 0.9);
  fox::TextPrimitive& name = *entity.add_texts();
  set(*name.mutable_pose(), motion.place, 1.5 * radius);
  name.set_billboard(true);
  name.set_font_size(12);
  name.set_scale_invariant(true);
  set(*name.mutable_color(), {1, 1, 1});
  name.set_text(robot.name);
  const double way = arrow_seconds * motion.velocity.norm();
  if (way <= arrow_seconds * standing) return;
  fox::ArrowPrimitive& arrow = *entity.add_arrows();
  set(*arrow.mutable_pose(), motion.place, 1.1 * radius, motion.heading);
  arrow.set_shaft_length(radius + 0.7 * way);
  arrow.set_head_length(0.3 * way);
  arrow.set_shaft_diameter(0.2 * radius);
  arrow.set_head_diameter(0.5 * radius);
  set(*arrow.mutable_color(), colour);
}

// Red, green, blue and alpha, one byte each.
constexpr std::array<char, 4> wall_bytes{0x30, 0x34, 0x3a, '\xff'};
constexpr std::string_view free_bytes("\0\0\0\0", 4);

/// A map in larger cells, each of `factor` x `factor` cells.
struct Shrunk {
  int factor = 1;
  int columns = 0;
  int rows = 0;
  double cell = 0;  ///< metres
};

Shrunk shrunk_of(const OccupancyMap& map) {
  const double cells = static_cast<double>(map.width) * map.height;
  const int factor = static_cast<int>(std::ceil(std::sqrt(std::max(1.0, cells / most_cells))));
  return {factor, (map.width + factor - 1) / factor, (map.height + factor - 1) / factor,
          map.resolution * factor};
}

bool is_blocked(const OccupancyMap& map, const Shrunk& shrunk, int column, int row) {
  const int right = std::min(map.width, (column + 1) * shrunk.factor);
  const int bottom = std::min(map.height, (row + 1) * shrunk.factor);
  for (int j = row * shrunk.factor; j < bottom; ++j) {
    for (int i = column * shrunk.factor; i < right; ++i) {
      if (map.is_blocked(i, j)) return true;
    }
  }
  return false;
}

}  // namespace

Projection projection_of(const FleetView& view) {
  if (!view.map()) return {};
  const OccupancyMap& map = view.map()->map;
  return {.y_down = map.y_axis == YAxis::down, .origin = map.origin};
}

fox::Grid grid(const MapMessage& message, WallTime now) {
  const OccupancyMap& map = message.map;
  const Shrunk shrunk = shrunk_of(map);
  const bool y_down = map.y_axis == YAxis::down;
  constexpr std::array names{"red", "green", "blue", "alpha"};
  fox::Grid out;
  *out.mutable_timestamp() = stamp(now);
  out.set_frame_id(frame_id);
  // The corner of the first row that is sent. It is the lowest row in Foxglove's frame.
  const double first_row = y_down ? map.origin.y() + shrunk.rows * shrunk.cell : map.origin.y();
  set(*out.mutable_pose(), Projection{.y_down = y_down}({map.origin.x(), first_row}), 0);
  out.mutable_cell_size()->set_x(shrunk.cell);
  out.mutable_cell_size()->set_y(shrunk.cell);
  const auto columns = static_cast<std::size_t>(shrunk.columns);
  out.set_column_count(static_cast<std::uint32_t>(columns));
  out.set_cell_stride(names.size());
  out.set_row_stride(static_cast<std::uint32_t>(names.size() * columns));
  for (std::uint32_t k = 0; k < names.size(); ++k) {
    fox::PackedElementField& field = *out.add_fields();
    field.set_name(names[k]);
    field.set_offset(k);
    field.set_type(fox::PackedElementField::UINT8);
  }
  std::string& data = *out.mutable_data();
  data.reserve(columns * static_cast<std::size_t>(shrunk.rows) * names.size());
  for (int row = 0; row < shrunk.rows; ++row) {
    for (int column = 0; column < shrunk.columns; ++column) {
      const bool wall = is_blocked(map, shrunk, column, y_down ? shrunk.rows - 1 - row : row);
      data.append(wall ? std::string_view(wall_bytes.data(), wall_bytes.size()) : free_bytes);
    }
  }
  return out;
}

fox::SceneUpdate robots(const FleetView& view, WallTime now) {
  const Projection projection = projection_of(view);
  const double time = view.fleet_time(now).value_or(0);
  fox::SceneUpdate scene;
  for (const SeenRobot& robot : view.robots()) {
    if (!robot.state) continue;
    fox::SceneEntity& entity = add_entity(scene, robot.name, now);
    *entity.mutable_lifetime() = google::protobuf::util::TimeUtil::MillisecondsToDuration(
        static_cast<std::int64_t>(1000 * robot_lifetime));
    draw_robot(entity, robot, motion_of(*robot.state, time, projection),
               is_lost(robot.heard, now) ? silent_colour : colour_of(phase_of(robot)), projection.y_down);
  }
  return scene;
}

fox::PosesInFrame poses(const FleetView& view, WallTime now) {
  const Projection projection = projection_of(view);
  const double time = view.fleet_time(now).value_or(0);
  fox::PosesInFrame out;
  *out.mutable_timestamp() = stamp(now);
  out.set_frame_id(frame_id);
  for (const SeenRobot& robot : view.robots()) {
    if (!robot.state) continue;
    const Motion motion = motion_of(*robot.state, time, projection);
    set(*out.add_poses(), motion.place, 0, motion.heading);
  }
  return out;
}

fox::FrameTransforms transforms(const FleetView& view, WallTime now) {
  const Projection projection = projection_of(view);
  const double time = view.fleet_time(now).value_or(0);
  fox::FrameTransforms out;
  for (const SeenRobot& robot : view.robots()) {
    if (!robot.state) continue;
    const Motion motion = motion_of(*robot.state, time, projection);
    fox::FrameTransform& transform = *out.add_transforms();
    *transform.mutable_timestamp() = stamp(now);
    transform.set_parent_frame_id(frame_id);
    transform.set_child_frame_id(robot.name);
    set(*transform.mutable_translation(), motion.place, 0);
    set_turn(*transform.mutable_rotation(), motion.heading);
  }
  return out;
}

void add_path(fox::SceneUpdate& scene, const SeenRobot& robot, Projection projection, WallTime now) {
  if (robot.path.empty()) {
    add_deletion(scene, robot.name, now);
    return;
  }
  fox::LinePrimitive& line = add_lines(add_entity(scene, robot.name, now), fox::LinePrimitive::LINE_STRIP,
                                       colour_of(Phase::driving), 0.8, 2, projection);
  for (const Point2& point : robot.path) add_point(line, point, paths_height, projection);
}

void add_inactive_tree(fox::SceneUpdate& scene, const InactiveTreesMessage& tree, Projection projection,
                       WallTime now) {
  fox::LinePrimitive& lines =
      add_lines(add_entity(scene, fmt::format("{:x}/{}", tree.id.broker, tree.id.number), now),
                fox::LinePrimitive::LINE_LIST, tree_colour, 0.5, 1, projection);
  for (const InactiveTreesMessage::Node& node : tree.nodes) {
    if (node.parent < 0) continue;
    const Point2& parent = tree.nodes[static_cast<std::size_t>(node.parent)].position;
    add_point(lines, parent, trees_height, projection);
    add_point(lines, node.position, trees_height, projection);
  }
}

void add_root_trees(fox::SceneUpdate& scene, const SeenRobot& robot, std::size_t first, std::uint32_t part,
                    Projection projection, WallTime now) {
  fox::SceneEntity& entity = add_entity(scene, part_id(robot.name, part), now);
  for (const Root side : {Root::start, Root::goal}) {
    fox::LinePrimitive& lines =
        add_lines(entity, fox::LinePrimitive::LINE_LIST, side == Root::start ? start_colour : goal_colour,
                  0.7, 1, projection);
    for (std::size_t k = first; k < robot.root_nodes.size(); ++k) {
      const RootNodes::Node& node = robot.root_nodes[k];
      if (node.parent < 0 || node.side != side) continue;
      const Point2& parent = robot.root_nodes[static_cast<std::size_t>(node.parent)].position;
      add_point(lines, parent, trees_height, projection);
      add_point(lines, node.position, trees_height, projection);
    }
  }
}

void delete_root_trees(fox::SceneUpdate& scene, const RobotName& robot, std::uint32_t parts, WallTime now) {
  for (std::uint32_t part = 0; part < parts; ++part) add_deletion(scene, part_id(robot, part), now);
}

void add_deletion_of_all(fox::SceneUpdate& scene, WallTime now) {
  fox::SceneEntityDeletion& deletion = *scene.add_deletions();
  *deletion.mutable_timestamp() = stamp(now);
  deletion.set_type(fox::SceneEntityDeletion::ALL);
}

fox::Log log_of(const SeenRobot& robot, WallTime now) {
  const AgentStatus& status = *robot.status;
  fox::Log log;
  *log.mutable_timestamp() = stamp(now);
  log.set_level(has_no_way(status.phase) ? fox::Log::WARNING : fox::Log::INFO);
  log.set_name(robot.name);
  log.set_message(status.reason.empty() ? text_of(status)
                                        : fmt::format("{}: {}", text_of(status), status.reason));
  return log;
}

}  // namespace coppice::foxglove_scene
