// A recording (monitor/recorder.h) as it grows on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include "files/binary_file.h"
#include "monitor/recorder.h"

namespace coppice {

class RecordingFile {
 public:
  /// `force`: replaces what is there. Throws InputError if it may not, or the file cannot be made; so do step
  /// and finish where there is no room.
  RecordingFile(std::filesystem::path path, bool force)
      : file_(std::move(path), force ? BinaryOutput::Existing::replace : BinaryOutput::Existing::refuse) {}

  void on(std::vector<Arrival> arrivals) { recorder_.on(std::move(arrivals)); }
  void step(WallTime now) { append(recorder_.step(now)); }
  void finish() { append(recorder_.finish()); }

  const Recorder& recorder() const { return recorder_; }
  std::uint64_t size() const { return file_.size(); }

 private:
  void append(const mcap::Bytes& bytes) {
    if (!bytes.empty()) file_.append(bytes);
  }

  BinaryOutput file_;
  Recorder recorder_;
};

}  // namespace coppice
