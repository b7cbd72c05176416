// The trajectory of a run as CSV: every control step of every robot, fleet time.
#pragma once

#include <filesystem>

#include "files/track_record.h"

namespace coppice {

/// Header `time,robot,x,y,vx,vy`; rows by time, then by robot. Seconds, metres, metres per second, to a
/// millionth. Throws InputError if the file cannot be written.
void write_trajectory(const std::filesystem::path& path, const TrackParts& parts);

}  // namespace coppice
