// The end of a robot's track, which its agent leaves in a file in case that it is killed.
//
// An agent sends its track in batches. A killed agent has not sent its last points, and its robot brakes
// without it (docs/safety.md, A1). The service completes the record from the file.
#pragma once

#include <optional>
#include <string>

#include "messages/messages.h"
#include "runtime/journal.h"

namespace coppice {

class BlackBox {
 public:
  /// Creates the folder, and the file of this robot in it. Throws as Journal does.
  BlackBox(const std::string& folder, const RobotName& robot);

  /// The track will end so, unless this is called again.
  void keep(const TrackMessage& rest);

 private:
  Journal journal_;
  int kept_ = 0;  ///< in the file
};

/// The end of the track of a robot whose agent was killed. None if the robot has no file in this folder, or
/// its agent lives. Throws std::runtime_error if the file is damaged.
std::optional<TrackMessage> rest_of_track(const std::string& folder, const RobotName& robot);

}  // namespace coppice
