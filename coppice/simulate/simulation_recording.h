// Records the messages of a simulation's roles, as if all came over a bus without delay or loss. Times are
// virtual and begin at 0.
#pragma once

#include <optional>

#include "coppice/commands.h"
#include "coppice/watch/recording_file.h"
#include "simulation/fleet_simulation.h"

namespace coppice {

class SimulationRecording {
 public:
  /// Must outlive the simulation's run. Throws InputError as RecordingFile does.
  SimulationRecording(FleetSimulation& simulation, const NewRecording& recording) {
    if (recording.file.empty()) return;
    file_.emplace(recording.file, recording.force);
    simulation.set_listener([this](const Message& message, double now) {
      file_->on({arrival_of(message, now)});
      file_->step(now);
    });
  }
  SimulationRecording(const SimulationRecording&) = delete;  // the simulation refers to its address
  SimulationRecording& operator=(const SimulationRecording&) = delete;

  /// Call it after the run. With it the file is complete.
  void finish() {
    if (file_) file_->finish();
  }

 private:
  std::optional<RecordingFile> file_;
};

}  // namespace coppice
