#include "dds/type_objects.h"

#include "fleetTypeObject.h"

namespace coppice {

void register_type_objects() {
  registerfleetTypes();
}

}  // namespace coppice
