// The last reservation of each other robot that was heard.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <utility>

#include "messages/messages.h"

namespace coppice {

/// A reservation of another robot, by the own clock.
struct KnownReservation {
  ReservationBasis basis;
  Trajectory trajectory;
  double radius = 0;
};

class Reservations {
 public:
  using Known = std::map<RobotName, std::shared_ptr<const ReservationMessage>>;

  void hear(std::shared_ptr<const ReservationMessage> reservation) {
    auto& known = known_[reservation->robot];
    const bool is_of_the_run = known && known->run == reservation->run;
    if (is_of_the_run && known->number >= reservation->number) return;
    const bool renews = is_of_the_run && known->trajectory == reservation->trajectory;
    if (!renews) since_[reservation->robot] = reservation->number;
    known = std::move(reservation);
    ++news_;
  }
  /// Null: none of this run has come.
  const ReservationMessage* find(const RobotName& robot, const RunId& run) const {
    const auto known = known_.find(robot);
    return known != known_.end() && known->second->run == run ? known->second.get() : nullptr;
  }
  /// The first number, as far as was heard, of the trajectory that a robot has reserved. Whoever named one of
  /// the numbers from then on planned around that trajectory.
  std::uint32_t since(const RobotName& robot) const {
    const auto known = since_.find(robot);
    return known != since_.end() ? known->second : 0;
  }
  auto begin() const { return known_.begin(); }
  auto end() const { return known_.end(); }
  /// Grows with each message that tells something new.
  std::uint32_t news() const { return news_; }

 private:
  Known known_{};
  std::map<RobotName, std::uint32_t> since_{};
  std::uint32_t news_ = 0;
};

}  // namespace coppice
