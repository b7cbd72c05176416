// The one exception for bad input: its text names the file, the line or field, and what was expected.
#pragma once

#include <stdexcept>

namespace coppice {

struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace coppice
