// Apart from dds_bus.cpp because a header of Fast DDS's type objects opens its namespace for everyone who
// includes it, where Eigen's comparisons of enumerators become ambiguous.
#pragma once

namespace coppice {

/// Makes the types of idl/fleet.idl known, so that generic tools see what the samples hold.
void register_type_objects();

}  // namespace coppice
