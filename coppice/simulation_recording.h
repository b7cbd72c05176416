// A recording of what the roles of a simulation say, as if all of it had come over a bus without delay or
// loss. Its times are virtual: it begins at 0.
#pragma once

#include <optional>

#include "coppice/commands.h"
#include "coppice/recording_file.h"
#include "simulation/fleet_simulation.h"

namespace coppice {

class SimulationRecording {
 public:
  /// Outlives the simulation's run. Throws InputError as RecordingFile does.
  SimulationRecording(FleetSimulation& simulation, const NewRecording& recording) {
    if (recording.file.empty()) return;
    file_.emplace(recording.file, recording.force);
    simulation.set_listener([this](const Message& message, double now) {
      file_->on({arrival_of(message, now)});
      file_->step(now);
    });
  }
  SimulationRecording(const SimulationRecording&) = delete;  // the simulation knows where it is
  SimulationRecording& operator=(const SimulationRecording&) = delete;

  /// After the run: with that the file is whole.
  void finish() {
    if (file_) file_->finish();
  }

 private:
  std::optional<RecordingFile> file_;
};

}  // namespace coppice
