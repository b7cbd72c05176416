#include <iostream>

#include "coppice/commands.h"
#include "coppice/run/examination.h"
#include "dds/discovery.h"

namespace coppice {

int doctor_command(const FleetPlan& asked) {
  FleetPlan plan = asked;
  if (plan.discovery.empty()) plan.discovery = usual_discovery_servers();
  const std::vector<Finding> findings = diagnose(examine(plan), plan);
  std::cout << table_of(findings);
  return exit_code(findings);
}

}  // namespace coppice
