// Looks at this machine for `coppice doctor`: reads limits, binds sockets, sends datagrams to itself.
#pragma once

#include "coppice/diagnosis.h"

namespace coppice {

/// Takes about half a second, or as long as the network looks for a discovery server's name. What cannot be
/// found out counts as missing, or as no limit where it is one.
Machine examine(const FleetPlan& plan);

/// That this process may run on: by its affinity and its control group's quota.
double usable_cores();

}  // namespace coppice
