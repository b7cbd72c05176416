// Two robots swap places in a corridor that is too narrow for both. A niche in the middle lets one pass.

#include <cstdio>

#include <coppice/motion/plan_trajectories.h>

int main() {
  coppice::OccupancyMap map{.width = 20, .height = 4, .blocked = std::vector<std::uint8_t>(80, 0)};
  for (int i = 0; i < 20; ++i) {
    for (int j = 2; j < 4; ++j) map.blocked[static_cast<std::size_t>(20 * j + i)] = i < 9 || i > 10;
  }
  const coppice::ClearanceField field(map);
  const coppice::Limits limits{.max_speed = 2, .max_acceleration = 4};
  const std::vector<coppice::DrivingTask> tasks{{{2, 1}, {18, 1}, 0.8, limits},
                                                {{18, 1}, {2, 1}, 0.8, limits}};

  const coppice::FleetTrajectories fleet = coppice::plan_trajectories(field, tasks);
  for (const coppice::Trajectory& trajectory : fleet.trajectories) {
    for (const coppice::TimedPoint& p : trajectory)
      std::printf("(%.2f, %.2f) at %.2f s; ", p.position.x(), p.position.y(), p.time);
    std::printf("\n");
  }
  return fleet.stranded.empty() ? 0 : 1;
}
