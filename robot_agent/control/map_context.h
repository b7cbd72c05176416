// The data that agents compute once for a map. It follows from the map alone and serves every mission on it:
// the robots of one process share it.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "coppice/planning/clearance_field.h"
#include "messages/messages.h"
#include "motion/lattice/packed_roadmap.h"

namespace coppice {

struct MapContext {
  explicit MapContext(const MapMessage& map)
      : map_id(map.map_id), field(map.map, map.margin), roadmaps(field) {}

  std::string map_id;
  ClearanceField field;
  MapRoadmaps roadmaps;
};

/// The map contexts of the robots of one process and thread. A context lives as long as one robot uses it.
class MapContexts {
 public:
  std::shared_ptr<MapContext> of(const MapMessage& map) {
    std::weak_ptr<MapContext>& known = known_[map.map_id];
    std::shared_ptr<MapContext> context = known.lock();
    if (!context) known = context = std::make_shared<MapContext>(map);
    return context;
  }

 private:
  std::map<std::string, std::weak_ptr<MapContext>> known_;
};

}  // namespace coppice
