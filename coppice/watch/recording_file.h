// A recording (monitor/recording/recorder.h) that is written to disk as it grows.
#pragma once

#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include "files/binary_file.h"
#include "monitor/recording/recorder.h"

namespace coppice {

class RecordingFile {
 public:
  /// `force`: replaces an existing file. Throws InputError if the file exists and `force` is false, or if it
  /// cannot be created. step and finish throw InputError if the disk is full.
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
