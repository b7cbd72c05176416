#include "files/trajectory_file.h"

#include <algorithm>
#include <iterator>
#include <ostream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "files/text_file.h"

namespace coppice {

namespace {

/// The rows of a part, in the order of the file.
std::string rows_of(const TrackPart& part) {
  struct Row {
    const TrackPoint* point;
    const std::string* robot;
  };
  std::vector<Row> rows;
  for (const NamedTrack& named : part.tracks) {
    for (const TrackPoint& point : named.track.points) {
      if (part.holds(point)) rows.push_back({&point, &named.robot});
    }
  }
  std::ranges::stable_sort(rows, [](const Row& a, const Row& b) {
    return a.point->time != b.point->time ? a.point->time < b.point->time : *a.robot < *b.robot;
  });
  std::string csv;
  for (const Row& row : rows) {
    const TrackPoint& p = *row.point;
    fmt::format_to(std::back_inserter(csv), "{:.6f},{},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f}\n", p.time,
                   *row.robot, p.position.x(), p.position.y(), p.velocity.x(), p.velocity.y(), p.yaw,
                   p.angular_velocity);
  }
  return csv;
}

}  // namespace

void write_trajectory(const std::filesystem::path& path, const TrackParts& parts) {
  write_file(path, [&](std::ostream& out) {
    out << "time,robot,x,y,vx,vy,yaw,omega\n";
    parts([&](const TrackPart& part) { out << rows_of(part); });
  });
}

}  // namespace coppice
