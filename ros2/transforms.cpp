#include "ros2/transforms.h"

#include <cstddef>

#include "coppice/motion/kinematics.h"

namespace coppice {

namespace {

constexpr std::size_t most_frames = 1000;  // of one site; more are not kept
constexpr int most_steps = 20;             // from a frame to one above it: no longer chain makes sense

}  // namespace

void Transforms::take(const RosTransform& transform, WallTime arrived) {
  if (known_.size() >= most_frames && !known_.contains(transform.child)) return;
  known_[transform.child] = {transform, arrived};
}

std::optional<RosPose> Transforms::pose_in(const std::string& ancestor, const std::string& frame,
                                           WallTime now) const {
  RosPose pose{};
  std::string at = frame;
  for (int k = 0; at != ancestor; ++k) {
    const auto link = known_.find(at);
    if (k == most_steps || link == known_.end()) return std::nullopt;
    const auto& [transform, arrived] = link->second;
    if (!transform.is_static && now - arrived > longest_age) return std::nullopt;
    pose = {transform.pose.position + rotated(pose.position, transform.pose.yaw),
            wrapped(transform.pose.yaw + pose.yaw)};
    at = transform.parent;
  }
  return pose;
}

}  // namespace coppice
