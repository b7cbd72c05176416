// Checks a run from outside: by the text of the map and the scenario, the report and the recorded trajectory,
// with plain geometry over all near cells, and without the library's clearance field.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "report.pb.h"

namespace coppice::test {

struct Vertex {
  double x = 0;
  double y = 0;
};

inline double distance(Vertex a, Vertex b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}
inline Vertex between(Vertex a, Vertex b, double share) {
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
}

/// The minimum of a function that falls and then rises on [0, 1], by ternary search.
template <class F>
double least_on_unit(F&& f) {
  double low = 0;
  double high = 1;
  for (int i = 0; i < 60; ++i) {
    const double a = low + (high - low) / 3;
    const double b = high - (high - low) / 3;
    (f(a) < f(b) ? high : low) = f(a) < f(b) ? b : a;
  }
  return f((low + high) / 2);
}

/// The rows of a Moving AI map; all characters but '.', 'G' and 'S' are blocked.
class PlainMap {
 public:
  explicit PlainMap(const std::filesystem::path& path) {
    std::ifstream in(path);
    std::string line;
    while (std::getline(in, line) && line.rfind("map", 0) != 0) continue;
    while (std::getline(in, line) && !line.empty()) rows_.push_back(line);
    if (rows_.empty()) throw std::runtime_error(path.string() + ": no map");
  }

  /// Least distance from the segment to a blocked cell or the border, up to `reach`.
  double clearance(Vertex a, Vertex b, double reach) const {
    const double width = static_cast<double>(rows_[0].size());
    const double height = static_cast<double>(rows_.size());
    double least = reach;
    for (const Vertex p : {a, b}) least = std::min({least, p.x, p.y, width - p.x, height - p.y});
    const auto cell = [](double value, double most) {
      return static_cast<int>(std::clamp(value, 0.0, most - 1));
    };
    for (int j = cell(std::min(a.y, b.y) - reach, height); j <= cell(std::max(a.y, b.y) + reach, height);
         ++j) {
      for (int i = cell(std::min(a.x, b.x) - reach, width); i <= cell(std::max(a.x, b.x) + reach, width);
           ++i) {
        if (is_blocked(i, j)) least = std::min(least, to_cell(a, b, i, j));
      }
    }
    return least;
  }

 private:
  bool is_blocked(int i, int j) const {
    return std::string_view(".GS").find(rows_[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)]) ==
           std::string_view::npos;
  }
  /// From a segment to the closed cell: convex along the segment.
  static double to_cell(Vertex a, Vertex b, int i, int j) {
    return least_on_unit([&](double share) {
      const Vertex p = between(a, b, share);
      return std::hypot(std::max({i - p.x, 0.0, p.x - i - 1}), std::max({j - p.y, 0.0, p.y - j - 1}));
    });
  }

  std::vector<std::string> rows_;
};

struct Expected {
  std::string name;
  Vertex start;
  Vertex goal;
};

/// The robots of a Moving AI .scen at the centres of their cells, with the names that the scenario reader
/// gives them.
inline std::vector<Expected> robots_of_scen(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);  // "version 1"
  std::vector<Expected> robots;
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    std::string bucket;
    std::string map;
    int width = 0;
    int height = 0;
    Vertex start;
    Vertex goal;
    if (!(fields >> bucket >> map >> width >> height >> start.x >> start.y >> goal.x >> goal.y)) continue;
    robots.push_back({"r" + std::to_string(robots.size() + 1),
                      {start.x + 0.5, start.y + 0.5},
                      {goal.x + 0.5, goal.y + 0.5}});
  }
  return robots;
}

struct Sample {
  double time = 0;
  Vertex place;
  bool stands = false;
};

/// By robot, in the order of the file.
inline std::map<std::string, std::vector<Sample>> read_trajectory_rows(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  if (line != "time,robot,x,y,vx,vy,yaw,omega") throw std::runtime_error("header: " + line);
  std::map<std::string, std::vector<Sample>> tracks;
  while (std::getline(in, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    Sample sample;
    std::string robot;
    Vertex velocity{};
    if (!(fields >> sample.time >> robot >> sample.place.x >> sample.place.y >> velocity.x >> velocity.y))
      throw std::runtime_error(line);
    sample.stands = velocity.x == 0 && velocity.y == 0;
    tracks[robot].push_back(sample);
  }
  return tracks;
}

/// The position of a robot that moves straight between samples, and stands before the first and after the
/// last. The times of the calls must increase.
class Follower {
 public:
  explicit Follower(const std::vector<Sample>& track) : track_(track) {}
  Vertex at(double time) {
    while (next_ < track_.size() && track_[next_].time <= time) ++next_;
    if (next_ == 0) return track_.front().place;
    if (next_ == track_.size()) return track_.back().place;
    const Sample& a = track_[next_ - 1];
    const Sample& b = track_[next_];
    return between(a.place, b.place, (time - a.time) / (b.time - a.time));
  }

 private:
  const std::vector<Sample>& track_;
  std::size_t next_ = 0;
};

/// Until when a track says where its robot is: for ever if the robot stands at the end.
inline double known_until(const std::vector<Sample>& track) {
  return track.back().stands ? std::numeric_limits<double>::infinity() : track.back().time;
}

/// Least distance of two robots while both tracks say where they are; motion is straight between samples.
inline double least_distance(const std::vector<Sample>& a, const std::vector<Sample>& b) {
  std::vector<double> times;
  for (const auto* track : {&a, &b}) {
    for (const Sample& sample : *track) times.push_back(sample.time);
  }
  std::sort(times.begin(), times.end());
  const double end = std::min(known_until(a), known_until(b));
  Follower in_a(a);
  Follower in_b(b);
  Vertex a0 = in_a.at(times.front());
  Vertex b0 = in_b.at(times.front());
  double least = distance(a0, b0);
  for (std::size_t i = 1; i < times.size() && times[i] <= end; ++i) {
    const Vertex a1 = in_a.at(times[i]);
    const Vertex b1 = in_b.at(times[i]);
    // Nearly always they are too far apart to come nearer than before.
    if (distance(a0, b0) - distance(a0, a1) - distance(b0, b1) < least)
      least = std::min(
          least, least_on_unit([&](double s) { return distance(between(a0, a1, s), between(b0, b1, s)); }));
    a0 = a1;
    b0 = b1;
  }
  return least;
}

}  // namespace coppice::test
