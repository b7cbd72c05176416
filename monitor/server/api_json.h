// Robots, halts and alarms as JSON, in one line each, as docs/openapi.yaml describes them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "monitor/view/alarms.h"
#include "monitor/view/fleet_view.h"

namespace coppice {

/// A string of JSON, or null if it is empty.
std::string text_or_null(std::string_view text);

/// `order`: the id of the order that it has; null: none. `time`: fleet time, which it is `now`.
std::string json_of(const SeenRobot& robot, double time, const std::string* order, Halt halt, WallTime now);

std::string json_of(const std::vector<Alarm>& alarms);

std::string json_of(const HaltMessage& halts);

}  // namespace coppice
