// Reads sequences from the network with the bounds of fleet.idl.
//
// The code of fastddsgen accepts any length for which there might be enough bytes, and allocates it at once:
// a plan with seventeen million members, from as many zeros, took 1.6 GB.
#pragma once

#include <cstdint>
#include <vector>

#include <fastcdr/Cdr.h>
#include <fastcdr/exceptions/BadParamException.h>

namespace coppice::idl {

/// Throws eprosima::fastcdr::exception::BadParamException before it allocates, if there are more than `most`
/// elements.
template <class T>
void read_bounded(eprosima::fastcdr::Cdr& bytes, std::vector<T>& sequence, std::uint32_t most) {
  eprosima::fastcdr::Cdr::state begin(bytes);
  std::uint32_t length = 0;
  bytes >> length;
  if (length > most) throw eprosima::fastcdr::exception::BadParamException("sequence is too long");
  bytes.setState(begin);
  bytes >> sequence;
}

}  // namespace coppice::idl
