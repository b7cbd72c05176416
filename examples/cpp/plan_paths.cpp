// A map in, paths out: plan_paths MAP plans for ten random robots of radius 1 m.

#include <cstdio>
#include <exception>

#include <coppice/files/map_file.h>
#include <coppice/planning/map_generator.h>
#include <coppice/planning/plan_paths.h>

int main(int argc, char** argv) try {
  if (argc != 2) throw std::invalid_argument("usage: plan_paths MAP");
  const coppice::OccupancyMap map = coppice::read_map(argv[1]);
  const coppice::ClearanceField field(map);

  coppice::Random random(1);
  std::vector<coppice::PlanningProblem> problems;
  for (const auto& [start, goal] : coppice::random_tasks(field, 10, 1, 0.3, random))
    problems.push_back({start, goal, 1});

  const coppice::PathPlan plan = coppice::plan_paths(field, problems, {.seed = 1});
  for (const coppice::PlannedPath& robot : plan.robots) {
    std::printf("%.1f m:", coppice::length_of(robot.path));
    for (const coppice::Point2& p : robot.path) std::printf(" (%.1f, %.1f)", p.x(), p.y());
    std::printf("%s\n", robot.reason.c_str());
  }
} catch (const std::exception& problem) {
  std::fprintf(stderr, "%s\n", problem.what());
  return 2;
}
