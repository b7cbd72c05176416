// Examines this machine for `coppice doctor`: reads limits, binds sockets, sends datagrams to itself.
#pragma once

#include "coppice/run/diagnosis.h"

namespace coppice {

/// Takes about half a second, or longer to look up a discovery server's name. A property that cannot be found
/// out counts as missing; an unknown limit counts as no limit.
Machine examine(const FleetPlan& plan);

/// Cores that this process may use, by its affinity and its control group's quota.
double usable_cores();

}  // namespace coppice
