#include <cstdlib>
#include <iostream>

#include "coppice/commands.h"
#include "coppice/examination.h"

namespace coppice {

int doctor_command(const FleetPlan& asked) {
  FleetPlan plan = asked;
  const char* const usual_servers = std::getenv("ROS_DISCOVERY_SERVER");
  if (plan.discovery.empty() && usual_servers != nullptr) plan.discovery = usual_servers;
  const std::vector<Finding> findings = diagnose(examine(plan), plan);
  std::cout << table_of(findings);
  return exit_code(findings);
}

}  // namespace coppice
