// The bus of the simulation: in memory, on a virtual clock, the same for the same seed.
//
// It delivers by the table of topics: best-effort samples may be lost, reliable ones arrive, late joiners get
// what transient-local topics keep. Every sample takes `delay` seconds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bus/bus.h"
#include "bus/messages.h"

namespace coppice {

class SimulatedBus {
 public:
  /// One participant's end. Stays valid for as long as the bus lives.
  class Port {
   public:
    void publish(const Message& message) { bus_.publish(*this, message); }
    /// All that is due by the bus's time.
    std::vector<Message> take();
    /// When the next message is due; infinity if none is under way.
    double next_delivery() const;

   private:
    friend class SimulatedBus;
    Port(SimulatedBus& bus, Role role) : bus_(bus), role_(role) {}

    struct UnderWay {
      double due;
      Message message;
    };
    SimulatedBus& bus_;
    Role role_;
    std::vector<UnderWay> inbox_;  ///< in the order in which it was sent; due times do not fall
  };

  /// `delay`: seconds from publishing to delivery, above 0.
  explicit SimulatedBus(double delay) : delay_(delay) {}

  Port& attach(Role role);

  /// Virtual time, seconds; never runs back.
  void set_time(double now) { now_ = now; }

 private:
  void publish(const Port& sender, const Message& message);

  double delay_;
  double now_ = 0;
  std::vector<std::unique_ptr<Port>> ports_;
  /// What transient-local topics keep, by topic and key, in the order of first publication.
  std::vector<std::pair<std::string, std::vector<Message>>> kept_;
  std::map<std::string, std::size_t> kept_index_;
};

}  // namespace coppice
