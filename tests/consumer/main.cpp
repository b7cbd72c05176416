// Uses a layer of Coppice. Coppice's own settings would warn of the unused arguments.

#include "coppice/planning/clearance_field.h"

int main(int argc, char** argv) {
  const coppice::OccupancyMap map{.width = 4, .height = 3, .blocked = std::vector<std::uint8_t>(12, 0)};
  return coppice::ClearanceField(map).is_free({2, 1.5}, 1) ? 0 : 1;
}
