// The check of lengths, speeds and accelerations of a scenario.
#pragma once

#include <string>

namespace coppice {

/// Throws InputError, which names the field, if the value is not within the bounds of quantities.h.
void check_size(double value, const std::string& field);

}  // namespace coppice
