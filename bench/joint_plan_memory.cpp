// Memory for a joint plan of all robots of a scenario: joint_plan_memory SCENARIO prints the peak memory of
// its process (VmHWM of proc(5), kB) before and after planning.
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "coppice/files/scenario_file.h"
#include "coppice/planning/clearance_field.h"
#include "coppice/planning/random.h"
#include "motion/joint/joint_planner.h"

namespace coppice {
namespace {

int most_memory() {
  std::ifstream status("/proc/self/status");
  std::string line;
  while (std::getline(status, line)) {
    if (line.starts_with("VmHWM:")) return std::atoi(line.c_str() + 6);
  }
  return 0;
}

void measure(const Scenario& scenario) {
  const ClearanceField field(scenario.map);
  MapRoadmaps roadmaps(field);
  std::cout << "map " << most_memory() << '\n';
  std::vector<JointTask> tasks;
  for (const RobotTask& robot : scenario.robots) tasks.push_back({robot.start, robot.goal, robot.radius});
  const JointPlan plan = joint_plan(roadmaps, std::move(tasks), Random(1));
  std::cout << "joint plan " << most_memory() << ", " << plan.moves.size() << " moves, "
            << plan.stranded.size() << " stranded\n";
}

}  // namespace
}  // namespace coppice

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "expected a scenario\n";
    return 2;
  }
  coppice::measure(coppice::read_scenario(argv[1], {.margin = 0}));
}
