// Apart from dds_bus.cpp, because a header of Fast DDS's type objects opens its namespace for every file that
// includes it, and then Eigen's comparisons of enumerators become ambiguous.
#pragma once

namespace coppice {

/// Registers the types of idl/fleet.idl, so that generic tools can read the samples.
void register_type_objects();

}  // namespace coppice
