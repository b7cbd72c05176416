#include "coppice/simulate/fault_options.h"

#include <charconv>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "files/number_check.h"
#include "simulation/fault_limits.h"

namespace coppice {

namespace {

/// Splits the text at the last `separator`. Throws a usage error with the option and the expected form.
std::pair<std::string, std::string> split(const std::string& text, char separator, const std::string& option,
                                          const std::string& expected) {
  const auto at = text.rfind(separator);
  if (at == std::string::npos) throw CLI::ValidationError(option, text + " is not " + expected);
  return {text.substr(0, at), text.substr(at + 1)};
}

double seconds(const std::string& text, const std::string& option) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value >= 0 && value <= longest_fault))
    throw CLI::ValidationError(
        option, fmt::format("'{}' is not a number of seconds from 0 to {}", text, longest_fault));
  return value;
}

}  // namespace

void add_fault_options(CLI::App& command, Faults& faults, std::optional<double>& tracking_tolerance) {
  const char* group = "Faults (drawn from the scenario's seed)";
  const auto number = [&](const char* name, double& value, const char* what) {
    return command.add_option(name, value, what)->group(group);
  };
  const auto pairs = [&](const char* name, char separator, const char* expected, const char* what,
                         auto&& take) {
    const auto take_all = [=](const std::vector<std::string>& texts) {
      for (const std::string& text : texts) {
        const auto [first, second] = split(text, separator, name, expected);
        take(first, second);
      }
    };
    command.add_option_function<std::vector<std::string>>(name, take_all, what)
        ->type_name(expected)
        ->group(group)
        ->default_str("none")
        ->allow_extra_args(false);
  };
  number("--loss", faults.bus.loss, "share of lost samples; reliable ones are sent again")
      ->check(number_between(0, largest_loss));
  number("--delay", faults.bus.delay, "delay of every sample, seconds")
      ->check(number_between(0, longest_delay));
  number("--jitter", faults.bus.jitter, "greatest deviation of a delay, seconds")
      ->check(number_between(0, longest_delay));
  number("--duplicate", faults.bus.duplicate, "share of the samples that arrive twice")
      ->check(number_between(0, 1));
  command.add_flag("--reorder", faults.bus.reorder, "lets samples of one sender overtake each other")
      ->group(group);
  number("--kill-rate", faults.kill_rate, "agents killed, per robot and hour")
      ->check(number_between(0, most_an_hour));
  pairs("--kill", '@', "ROBOT@SECONDS", "an agent to kill, and the time",
        [&faults](const std::string& robot, const std::string& time) {
          faults.kills.push_back({robot, seconds(time, "--kill")});
        });
  number("--restart-after", faults.restart_after, "seconds after which a killed agent is restarted")
      ->check(number_between(shortest_fault, longest_fault))
      ->default_str("never");
  number("--pause-rate", faults.pause_rate, "pauses of agents, per robot and hour")
      ->check(number_between(0, most_an_hour));
  number("--pause", faults.pause, "duration of a pause, seconds")
      ->check(number_between(shortest_fault, longest_fault));
  number("--clock-skew", faults.clock_skew, "greatest error of an agent's clock, seconds")
      ->check(number_between(0, longest_fault));
  number("--clock-drift", faults.clock_drift,
         "greatest difference of the rates of two agents' clocks, seconds per second")
      ->check(number_between(0, largest_drift));
  number(
      "--odometry-noise", faults.drive.odometry_noise,
      "robots follow by odometry with that noise, metres (standard deviation; as many radians for the yaw)")
      ->check(number_between(0, most_noise));
  number("--drive-lag", faults.drive.lag, "robots follow with that lag, seconds (time constant)")
      ->check(number_between(0, longest_lag));
  number("--slip", faults.drive.slip, "robots follow with wheels that lose up to that share of their speed")
      ->check(number_between(0, most_slip));
  command
      .add_option("--tracking-tolerance", tracking_tolerance,
                  "metres by which such robots may be off their references; less where there is less room")
      ->check(number_between(1e-3, 1e3))
      ->default_str("what a robot drives in a quarter of a second, at most its radius")
      ->group(group);
  pairs("--partition", ':', "FROM:UNTIL", "a time in which the network is split in two, seconds",
        [&faults](const std::string& from, const std::string& until) {
          const double begin = seconds(from, "--partition");
          const double end = seconds(until, "--partition");
          if (begin >= end) throw CLI::ValidationError("--partition", from + " is not before " + until);
          faults.bus.partitions.push_back({begin, end});
        });
}

}  // namespace coppice
