// The exception for bad input. Its text names the file, the line or the field, and what was expected.
#pragma once

#include <stdexcept>

namespace coppice {

struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace coppice
