#include "runtime/black_box.h"

#include <utility>
#include <variant>
#include <vector>

namespace coppice {

namespace {

constexpr int most_kept = 200;  // 10 s of a robot that drives

std::string box_of(const RobotName& robot) {
  return "track-of-" + robot;
}

}  // namespace

BlackBox::BlackBox(const std::string& folder, const RobotName& robot)
    : journal_(*journal_in(folder, box_of(robot))) {}

/// The end before this one stays in the file while this one is written: the process may be killed meanwhile.
void BlackBox::keep(const TrackMessage& rest) {
  kept_ = kept_ % most_kept + 1;
  journal_.keep(kept_ == 1 ? Keep::begin_anew : Keep::append, rest);
}

std::optional<TrackMessage> rest_of_track(const std::string& folder, const RobotName& robot) {
  try {
    const auto journal = journal_in(folder, box_of(robot));
    const std::vector<Message> kept = journal->messages();
    if (kept.empty()) return std::nullopt;
    return std::get<TrackMessage>(kept.back());
  } catch (const JournalInUse&) {
    return std::nullopt;
  }
}

}  // namespace coppice
