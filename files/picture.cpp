#include "files/picture.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "coppice/motion/kinematics.h"
#include "files/text_file.h"

namespace coppice {

namespace {

constexpr double largest_side_pixels = 1000;

/// Hues that are the golden angle apart: neighbours in the list differ clearly, for any number of robots.
std::string colour_of(std::size_t robot) {
  const double hue = std::fmod(205 + 137.508 * static_cast<double>(robot), 360);
  // Distinguishes robots for viewers who cannot tell hues apart.
  const int lightness = robot % 2 == 0 ? 42 : 56;
  return fmt::format("hsl({:.0f},75%,{}%)", hue, lightness);
}

class Svg {
 public:
  explicit Svg(const OccupancyMap& map) : map_(map), flip_(map.y_axis == YAxis::up) {}

  Point2 place(const Point2& p) const {
    const Point2 cell = (p - map_.origin) / map_.resolution;
    return {cell.x(), flip_ ? map_.height - cell.y() : cell.y()};
  }
  double size(double metres) const { return metres / map_.resolution; }

  template <class... Args>
  void add(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(body_), format, std::forward<Args>(args)...);
  }

  /// Draws blocked cells, one rectangle for each run of cells in a row.
  void add_map() {
    add("<path fill=\"#3b3f46\" d=\"");
    for (int j = 0; j < map_.height; ++j) {
      for (int i = 0; i < map_.width;) {
        if (!map_.is_blocked(i, j)) {
          ++i;
          continue;
        }
        int end = i;
        while (end < map_.width && map_.is_blocked(end, j)) ++end;
        add("M{} {}h{}v1h-{}z", i, flip_ ? map_.height - 1 - j : j, end - i, end - i);
        i = end;
      }
    }
    add("\"/>\n");
  }

  void add_line(const Path& path, const std::string& style) {
    if (path.size() < 2) return;
    add("<polyline fill=\"none\" {} points=\"", style);
    for (const Point2& p : path) {
      const Point2 q = place(p);
      add("{:.2f},{:.2f} ", q.x(), q.y());
    }
    add("\"/>\n");
  }

  std::string finish() const {
    const double scale = largest_side_pixels / std::max(map_.width, map_.height);
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.0f}\" height=\"{:.0f}\" viewBox=\"0 0 {} "
        "{}\">\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{}</svg>\n",
        map_.width * scale, map_.height * scale, map_.width, map_.height, body_);
  }

 private:
  const OccupancyMap& map_;
  bool flip_;
  std::string body_;
};

void add_edges(Svg& svg, const PictureContent& content, int robot, double width) {
  const std::string colour = robot < 0 ? "#b8bcc4" : colour_of(static_cast<std::size_t>(robot));
  svg.add("<path fill=\"none\" stroke=\"{}\" stroke-opacity=\"0.7\" stroke-width=\"{:.2f}\" d=\"", colour,
          width);
  for (const PictureContent::Edge& edge : content.edges) {
    if (edge.robot != robot) continue;
    const Point2 a = svg.place(edge.from);
    const Point2 b = svg.place(edge.to);
    svg.add("M{:.1f} {:.1f}L{:.1f} {:.1f}", a.x(), a.y(), b.x(), b.y());
  }
  svg.add("\"/>\n");
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
  return out;
}

/// The robot's footprint, or its disc.
void add_body(Svg& svg, const PictureContent::Robot& robot, const Point2& place, double yaw,
              const std::string& style) {
  const Point2 centre = svg.place(place);
  if (robot.footprint.empty()) {
    svg.add("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\" {}/>\n", centre.x(), centre.y(),
            svg.size(robot.radius), style);
    return;
  }
  svg.add("<path {} d=\"", style);
  char command = 'M';
  for (const Point2& corner : robot.footprint) {
    const Point2 p = svg.place(place + rotated(corner, yaw));
    svg.add("{}{:.2f} {:.2f}", std::exchange(command, 'L'), p.x(), p.y());
  }
  svg.add("Z\"/>\n");
}

/// A line from the middle of the robot to its front.
void add_heading(Svg& svg, const PictureContent::Robot& robot, const Point2& place, double yaw,
                 const std::string& colour, double width) {
  const Point2 from = svg.place(place);
  const Point2 to = svg.place(place + rotated({robot.radius, 0}, yaw));
  svg.add("<path stroke=\"{}\" stroke-width=\"{:.2f}\" d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}\"/>\n", colour, width,
          from.x(), from.y(), to.x(), to.y());
}

}  // namespace

PictureContent::Robot robot_of(const RobotTask& task) {
  return {.name = task.name,
          .radius = task.radius,
          .start = task.start,
          .goal = task.goal,
          .footprint = task.footprint,
          .yaw = task.start_yaw,
          .goal_yaw = task.goal_yaw,
          .has_heading = is_differential(limits_of(task))};
}

std::string picture_svg(const PictureContent& content) {
  Svg svg(content.map);
  // Line widths are the same in the picture for maps of all sizes.
  const double unit = std::max(content.map.width, content.map.height) / largest_side_pixels;
  svg.add_map();
  for (int robot = -1; robot < static_cast<int>(content.robots.size()); ++robot) {
    add_edges(svg, content, robot, (robot < 0 ? 0.6 : 1.0) * unit);
  }
  for (std::size_t i = 0; i < content.robots.size(); ++i) {
    const PictureContent::Robot& robot = content.robots[i];
    const std::string colour = colour_of(i);
    svg.add_line(robot.path,
                 fmt::format("stroke=\"{}\" stroke-width=\"{:.2f}\" stroke-dasharray=\"{:.1f} {:.1f}\"",
                             colour, 1.6 * unit, 6 * unit, 4 * unit));
    svg.add_line(robot.track, fmt::format("stroke=\"{}\" stroke-width=\"{:.2f}\" stroke-linejoin=\"round\"",
                                          colour, 3 * unit));
    const double radius = svg.size(robot.radius);
    const Point2 disc = svg.place(robot.body.value_or(robot.start));
    const std::string outline = fmt::format("stroke=\"{}\" stroke-width=\"{:.2f}\"", colour, 2.5 * unit);
    add_body(svg, robot, robot.body.value_or(robot.start), robot.yaw, fmt::format("fill=\"{}\"", colour));
    add_body(svg, robot, robot.goal, robot.goal_yaw,
             fmt::format("fill=\"{}\" {}", robot.body ? "none" : "#ffffff", outline));
    if (robot.has_heading) {
      const double width = std::max(unit, radius / 4);
      add_heading(svg, robot, robot.body.value_or(robot.start), robot.yaw, "#ffffff", width);
      add_heading(svg, robot, robot.goal, robot.goal_yaw, colour, width);
    }
    svg.add("<text x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"{:.1f}\" font-family=\"sans-serif\">{}</text>\n",
            disc.x() + radius, disc.y() - radius, 14 * unit, escaped(robot.name));
  }
  const bool of_a_moment = std::ranges::any_of(
      content.robots, [](const PictureContent::Robot& robot) { return robot.body.has_value(); });
  svg.add(
      "<text x=\"{0:.1f}\" y=\"{1:.1f}\" font-size=\"{2:.1f}\" font-family=\"sans-serif\" stroke=\"#ffffff\" "
      "stroke-width=\"{3:.1f}\" paint-order=\"stroke\">disc: {4}, ring: goal, dashed: path, solid: driven, "
      "thin: trees (grey: shared)</text>\n",
      8 * unit, content.map.height - 8 * unit, 13 * unit, 3 * unit, of_a_moment ? "robot" : "start");
  return svg.finish();
}

void write_picture(const std::filesystem::path& path, const PictureContent& content) {
  write_file(path, picture_svg(content));
}

}  // namespace coppice
