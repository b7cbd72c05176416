// When the recorded runs of these tests began.
#pragma once

#include "messages/run_id.h"

namespace coppice::test {

inline constexpr WallTime epoch = 1.7e9;

}  // namespace coppice::test
