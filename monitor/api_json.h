// Robots and halts as JSON, in one line each, as docs/openapi.yaml describes them.
#pragma once

#include <string>

#include "monitor/fleet_view.h"

namespace coppice {

/// `order`: the id of the order that it has; null: none. `time`: fleet time.
std::string json_of(const SeenRobot& robot, double time, const std::string* order, Halt halt);

std::string json_of(const HaltMessage& halts);

}  // namespace coppice
