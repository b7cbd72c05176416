#include "ros2/names.h"

#include <map>
#include <stdexcept>

namespace coppice {

namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool fits(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || is_digit(c) || c == '_';
}

}  // namespace

std::string ros_name(const RobotName& robot) {
  std::string name = robot;
  for (char& c : name) c = fits(c) ? c : '_';
  return name.empty() || is_digit(name[0]) ? "_" + name : name;
}

std::string filled(const std::string& name, const RobotName& robot) {
  constexpr std::string_view place = "{}";
  std::string result = name;
  const std::string own = ros_name(robot);
  for (auto at = result.find(place); at != std::string::npos; at = result.find(place, at + own.size()))
    result.replace(at, place.size(), own);
  return result;
}

void check_ros_names(const RosNames& names, std::span<const RobotName> robots) {
  std::map<std::string, RobotName> seen;
  for (const RobotName& robot : robots) {
    const auto [known, fresh] = seen.emplace(filled(names.robot_namespace, robot), robot);
    if (!fresh)
      throw std::runtime_error("robots " + known->second + " and " + robot + " would both be \"" +
                               known->first + "\" in ROS: rename one of them");
  }
}

std::string ros_topic(const RosNames& names, const RobotName& robot, std::string_view topic) {
  const std::string own = filled(names.robot_namespace, robot);
  return "rt/" + (own.empty() ? own : own + "/") + std::string(topic);
}

std::string ros_topic(std::string_view topic) {
  return "rt/" + std::string(topic);
}

}  // namespace coppice
