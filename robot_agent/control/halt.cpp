// Part of class Run: an operator tells the robot to stand, and to go on.
#include <utility>
#include <variant>

#include "robot_agent/control/run.h"

namespace coppice {

/// The robot stands while an operator wants it to. It lets go of all that others count on, once it stands.
void Run::heed_halt(double now) {
  const Halt halt = process_.halt;
  if (halt == Halt::none || stopped()) {
    if (halted()) go_on(now);
    return;
  }
  if (!halted()) {
    Halted standing;
    std::visit(
        [&]<class T>(T& task) {
          if constexpr (requires { standing.work = std::move(task); }) standing.work = std::move(task);
        },
        task_);
    round_.leave();
    enter(std::move(standing));
  }
  if (std::exchange(std::get<Halted>(task_).halt, halt) == halt) return;
  status_.reason = halt == Halt::paused ? "paused by the operator" : "stopped by the operator";
  status_changed_ = true;
}

/// The robot goes on with its work where it stands.
void Run::go_on(double now) {
  Halted standing = std::move(std::get<Halted>(task_));
  status_.reason.clear();
  if (std::holds_alternative<Impossible>(standing.work)) return set_out(now);
  std::visit([&](auto& work) { enter(std::move(work)); }, standing.work);
  retry_after_change();
}

}  // namespace coppice
