// The trajectory of a run as CSV: all control steps of all robots in fleet time.
#pragma once

#include <filesystem>

#include "files/track_record.h"

namespace coppice {

/// Header `time,robot,x,y,vx,vy`; rows sorted by time, then by robot. Seconds, metres, metres per second,
/// with six decimals. Throws InputError if the file cannot be written.
void write_trajectory(const std::filesystem::path& path, const TrackParts& parts);

}  // namespace coppice
