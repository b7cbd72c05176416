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
    if (known && known->run == reservation->run && known->number >= reservation->number) return;
    known = std::move(reservation);
    ++news_;
  }
  /// Null: none of this run has come.
  const ReservationMessage* find(const RobotName& robot, const RunId& run) const {
    const auto known = known_.find(robot);
    return known != known_.end() && known->second->run == run ? known->second.get() : nullptr;
  }
  auto begin() const { return known_.begin(); }
  auto end() const { return known_.end(); }
  /// Grows with each message that tells something new.
  std::uint32_t news() const { return news_; }

 private:
  Known known_{};
  std::uint32_t news_ = 0;
};

}  // namespace coppice
