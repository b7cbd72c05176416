// The frames that ROS 2 programs publish on tf and tf_static, and the pose of one in another: a small part of
// tf2's buffer (REP 105), in the plane and at the present time.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ros2/conversion.h"

namespace coppice {

/// The pose of a frame in its parent.
struct RosTransform {
  std::string parent;
  std::string child;
  RosPose pose{};
  bool is_static = false;  ///< it holds for ever
};

class Transforms {
 public:
  /// Seconds after which a transform that is not static says nothing any more.
  static constexpr WallTime longest_age = 0.5;

  void take(const RosTransform& transform, WallTime arrived);

  /// The pose of a frame in another one above it; none: a frame between them is missing, or its transform is
  /// too old.
  std::optional<RosPose> pose_in(const std::string& ancestor, const std::string& frame, WallTime now) const;

 private:
  struct Known {
    RosTransform transform;
    WallTime arrived = 0;
  };
  std::map<std::string, Known> known_;  ///< by child
};

}  // namespace coppice
