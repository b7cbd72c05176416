// Sequences as they come off the network, no longer than fleet.idl allows.
//
// What fastddsgen makes takes any length for which there might be bytes left, and makes room for it at once:
// seventeen million members of a plan, from as many zeros, took 1.6 GB.
#pragma once

#include <cstdint>
#include <vector>

#include <fastcdr/Cdr.h>
#include <fastcdr/exceptions/BadParamException.h>

namespace coppice::idl {

/// Throws eprosima::fastcdr::exception::BadParamException if there are more than `most`, before it makes
/// room.
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
