// The bus of the simulation: in memory, on a virtual clock, deterministic for a seed.
//
// It delivers according to the table of topics: best-effort samples may be lost, reliable ones arrive in the
// end, and late joiners receive what transient-local topics keep. Each sample takes `delay` seconds.
// BusFaults adds further faults.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "coppice/planning/random.h"
#include "coppice/simulation/faults.h"
#include "messages/bus.h"
#include "messages/messages.h"
#include "messages/name_index.h"
#include "messages/topics.h"

namespace coppice {

class SimulatedBus {
 public:
  /// The connection of one participant. It stays valid for as long as the bus lives.
  class Port {
   public:
    void publish(Outgoing message) { bus_.publish(*this, std::move(message)); }
    /// Takes all messages that are due by the bus's time.
    std::vector<Arrival> take();
    /// The time of the next reliable message, which wakes its receiver; infinity if there is none.
    /// Best-effort samples do not wake.
    double next_delivery() const { return next_delivery_; }
    /// The process has ended: it receives nothing more, and what it kept for late joiners is gone.
    void close();

   private:
    friend class SimulatedBus;
    Port(SimulatedBus& bus, std::size_t index, RobotName robot, int side)
        : bus_(bus), index_(index), robot_(std::move(robot)), side_(side) {}
    void deliver(double due, const std::shared_ptr<const Message>& message, Reliability reliability);

    struct Delivery {
      Arrival arrival;
      Reliability reliability;
    };
    SimulatedBus& bus_;
    std::size_t index_;
    RobotName robot_;  ///< empty: another role
    int side_;
    bool closed_ = false;
    std::vector<Delivery> inbox_;  ///< messages under way, in the order of sending
    double next_delivery_ = std::numeric_limits<double>::infinity();
    std::array<std::vector<double>, 2> last_due_;  ///< by reliability and sender
  };

  /// `delay`: seconds from publishing to delivery without faults, above 0.
  explicit SimulatedBus(double delay, BusFaults faults = {}, Random random = Random(0))
      : delay_(delay), faults_(std::move(faults)), random_(random) {}

  /// `robot`: the name, for an agent. `side`: the side of the partitions.
  Port& attach(Role role, const RobotName& robot = {}, int side = 0);

  /// From now on only participants of this role join. Messages that this role does not read are not kept.
  void keep_for(Role late) { late_ = late; }

  /// Virtual time, seconds; it must not decrease.
  void set_time(double now) { now_ = now; }

  /// Number of samples that did not reach a reader at the first attempt.
  std::size_t lost() const { return lost_; }
  /// Number of messages that no reader would accept (validation.h). A sender of such messages would seem
  /// silent to all others.
  std::size_t rejected() const { return rejected_; }

 private:
  void publish(const Port& sender, Outgoing outgoing);
  void send(const Port& sender, Port& receiver, const std::shared_ptr<const Message>& message,
            Reliability reliability);
  bool is_cut(const Port& sender, const Port& receiver, double time) const;
  bool fails(const Port& sender, const Port& receiver, double time);
  double delay_of_a_sample();

  double delay_;
  BusFaults faults_;
  Random random_;
  double now_ = 0;
  std::size_t lost_ = 0;
  std::size_t rejected_ = 0;
  std::optional<Role> late_;  ///< none: participants of any role may join
  std::vector<std::unique_ptr<Port>> ports_;
  std::array<std::vector<Port*>, 8> by_role_;
  NameIndex robots_;
  std::vector<Port*> port_of_robot_;  ///< by its number in `robots_`: its latest port
  struct Kept {
    std::size_t sender;
    std::shared_ptr<const Message> message;
  };
  /// Messages that transient-local topics keep, by topic and key, in the order of first publication.
  std::vector<std::pair<std::string, std::vector<Kept>>> kept_;
  std::unordered_map<std::string, std::size_t> kept_index_;
};

}  // namespace coppice
