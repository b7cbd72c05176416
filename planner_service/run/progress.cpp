#include "planner_service/run/progress.h"

#include <fmt/format.h>

#include "planner_service/timing.h"

namespace coppice {

namespace {

constexpr double worth_telling = 0.01;  // of the control periods

}  // namespace

std::string progress_line(const Progress& p) {
  const double rate = p.elapsed > 0 ? static_cast<double>(p.nodes) / p.elapsed : 0;
  const std::string missions = p.missions > p.robots ? fmt::format("{} missions, ", p.missions) : "";
  const std::string missed =
      p.periods_missed >= worth_telling
          ? fmt::format(", {:.0f} % of control periods missed (too little processor time)",
                        100 * p.periods_missed)
          : "";
  return fmt::format("{}paths found {}/{}, arrived {}/{}, elapsed {:.1f} s, {:.0f} nodes/s{}", missions,
                     p.planned, p.robots, p.arrived, p.robots, p.elapsed, rate, missed);
}

void ProgressDisplay::show(const Progress& progress, WallTime now) {
  if (now < next_) return;
  next_ = now + (terminal_ ? service_timing.progress_redraw : service_timing.progress_line);
  if (terminal_) {
    out_ << "\r\x1b[K" << progress_line(progress) << std::flush;
  } else {
    out_ << progress_line(progress) << std::endl;
  }
}

void ProgressDisplay::finish(const Progress& progress) {
  out_ << (terminal_ ? "\r\x1b[K" : "") << progress_line(progress) << std::endl;
}

}  // namespace coppice
