#include <algorithm>
#include <iostream>
#include <limits>

#include <fmt/format.h>

#include "coppice/commands.h"
#include "coppice/watch/recording_file.h"
#include "dds/dds_bus.h"
#include "runtime/process.h"

namespace coppice {

namespace {

// Seconds. Short, because states do not end a wait, and DDS keeps only the last 32 of each robot.
constexpr double look_period = 0.02;
constexpr WallTime longest_farewell = 1;  // seconds: a running fleet goes on sending

void tell(const Recorder& recorder, const std::string& file, std::uint64_t bytes, WallTime lasted) {
  std::uint64_t all = 0;
  for (const std::uint32_t count : recorder.counts()) all += count;
  std::cout << fmt::format("{}: {} messages in {:.1f} s, {:.2f} MB\n", file, all, lasted,
                           1e-6 * static_cast<double>(bytes));
  for (TopicNumber topic = 0; topic < topic_count; ++topic) {
    if (recorder.counts()[topic] > 0)
      std::cout << fmt::format("  {:<14} {:>9}\n", topic_infos[topic].name, recorder.counts()[topic]);
  }
  if (recorder.left_out() > 0)
    std::cout << fmt::format("{} messages were longer than a recording holds\n", recorder.left_out());
}

}  // namespace

int record_command(const RecordOptions& options) {
  install_stop_signals();
  DdsBus bus(options.network, Role::observer, "recorder");
  RecordingFile file(options.file, options.force);
  ProcessClock clock;
  const WallTime begin = clock.now();
  const WallTime end = begin + options.duration.value_or(std::numeric_limits<double>::infinity());
  WallTime now = begin;
  for (; !stop_requested() && now < end; now = clock.now()) {
    file.step(now);
    bus.wait(std::min(look_period, end - now));
    file.on(take(bus, clock));
  }
  // Everything that has arrived by now.
  const WallTime latest = now + longest_farewell;
  for (auto arrivals = take(bus, clock); !arrivals.empty() && clock.now() < latest;
       arrivals = take(bus, clock))
    file.on(std::move(arrivals));
  file.finish();
  tell(file.recorder(), options.file, file.size(), now - begin);
  return 0;
}

}  // namespace coppice
