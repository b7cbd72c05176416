#include "files/trajectory_file.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "files/text_file.h"

namespace coppice {

void write_trajectory(const std::filesystem::path& path, const std::vector<NamedTrack>& tracks) {
  struct Row {
    const TrackPoint* point;
    const std::string* robot;
  };
  std::vector<Row> rows;
  for (const NamedTrack& named : tracks) {
    for (const TrackPoint& point : named.track.points) rows.push_back({&point, &named.robot});
  }
  std::ranges::stable_sort(rows, [](const Row& a, const Row& b) {
    return a.point->time != b.point->time ? a.point->time < b.point->time : *a.robot < *b.robot;
  });
  std::string csv = "time,robot,x,y,vx,vy\n";
  for (const Row& row : rows) {
    const TrackPoint& p = *row.point;
    fmt::format_to(std::back_inserter(csv), "{:.6f},{},{:.6f},{:.6f},{:.6f},{:.6f}\n", p.time, *row.robot,
                   p.position.x(), p.position.y(), p.velocity.x(), p.velocity.y());
  }
  write_file(path, csv);
}

}  // namespace coppice
