// Tests of a recorded simulation: the recording holds all messages, and the run is the same without it.
#include "coppice/simulate/simulation_recording.h"

#include <fstream>
#include <map>
#include <memory>

#include <gtest/gtest.h>

#include "coppice/files/input_error.h"
#include "coppice/files/scenario_file.h"
#include "monitor/recording/recording.h"
#include "tests/support.h"

namespace coppice {
namespace {

struct SimulationRecordingTest : testing::Test {
  /// With losses, where an additional participant would change which messages are lost.
  std::unique_ptr<FleetSimulation> simulate(const std::string& record) const {
    Faults faults;
    faults.bus.loss = 0.3;
    faults.bus.jitter = 0.05;
    faults.bus.delay = 0.1;
    auto simulation = std::make_unique<FleetSimulation>(
        scenario, SimulationSettings{.timeout = 300, .faults = std::move(faults)});
    SimulationRecording recording(*simulation, {record});
    simulation->run([](const PlannerService&, double) { return true; });
    recording.finish();
    return simulation;
  }

  Scenario scenario = read_scenario(test::scenarios() / "rooms-8.json", {});
  test::TemporaryFolder folder;
  std::string file = (folder.path() / "run.mcap").string();
};

TEST_F(SimulationRecordingTest, ARecordingDoesNotChangeTheRun) {
  const auto alone = simulate({});
  const auto recorded = simulate(file);
  EXPECT_EQ(alone->service().report().SerializeAsString(), recorded->service().report().SerializeAsString());
  EXPECT_GT(recorded->suffered().lost, 0u);
}

TEST_F(SimulationRecordingTest, ARecordingHoldsEveryStateDespiteLoss) {
  const auto simulation = simulate(file);
  const Recording recording(file);
  EXPECT_EQ(recording.file().ending(), "") << "it is whole";
  Playback playback(recording, recording.begin());
  std::map<RobotName, std::map<double, Point2>> said;
  std::size_t missions = 0;
  std::size_t maps = 0;
  while (const auto arrival = playback.next()) {
    if (const auto* s = std::get_if<RobotState>(arrival->message.get()))
      said[s->robot][s->promise.stamp] = s->promise.position;
    missions += std::holds_alternative<Mission>(*arrival->message);
    maps += std::holds_alternative<MapMessage>(*arrival->message);
  }
  EXPECT_EQ(playback.rejected(), 0u);
  EXPECT_GE(maps, 1u);
  EXPECT_GE(missions, scenario.robots.size());
  for (const NamedTrack& track : simulation->tracks()) {
    std::size_t found = 0;
    for (const TrackPoint& point : track.track.points) {
      const auto state = said[track.robot].lower_bound(point.time - 1e-6);
      if (state == said[track.robot].end() || state->first > point.time + 1e-6) continue;
      ++found;
      EXPECT_LT((state->second - point.position).norm(), 1e-6) << track.robot << " at " << point.time;
    }
    EXPECT_GT(found, track.track.points.size() / 5)
        << track.robot;  // a standing robot sends at each fourth period
  }
}

TEST_F(SimulationRecordingTest, ARecordingReplacesNoFile) {
  std::ofstream(file) << "mine";
  EXPECT_THROW(simulate(file), InputError);
  EXPECT_EQ(test::contents(file), "mine");
}

}  // namespace
}  // namespace coppice
