// What is worked out once about a map, and serves every mission on it. It follows from the map alone: robots
// of one process share it.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "messages/messages.h"
#include "motion/packed_roadmap.h"
#include "planning/clearance_field.h"

namespace coppice {

struct MapContext {
  explicit MapContext(const MapMessage& map) : map_id(map.map_id), field(map.map), places(field) {}

  std::string map_id;
  ClearanceField field;
  MapRoadmaps places;
};

/// The grounds of the robots of one process and thread, as long as one of them is on it.
class MapContexts {
 public:
  std::shared_ptr<MapContext> of(const MapMessage& map) {
    std::weak_ptr<MapContext>& known = known_[map.map_id];
    std::shared_ptr<MapContext> ground = known.lock();
    if (!ground) known = ground = std::make_shared<MapContext>(map);
    return ground;
  }

 private:
  std::map<std::string, std::weak_ptr<MapContext>> known_;
};

}  // namespace coppice
