// A fuzz case in words.
#pragma once

#include <string>

#include "simulation/fuzz.h"

namespace coppice {

/// Names all that was drawn. Of what robots differ in, the least and the largest.
std::string in_words(const FuzzCase& fuzz_case);

}  // namespace coppice
