#include "messages/message_key.h"

#include <variant>

namespace coppice {

namespace {

struct KeyOf {
  std::string operator()(const MapMessage& m) const { return m.map_id; }
  std::string operator()(const InactiveTreesMessage& m) const {
    return std::to_string(m.id.broker) + "/" + std::to_string(m.id.number);
  }
  std::string operator()(const ActiveTreesMessage& m) const { return std::to_string(m.broker); }
  std::string operator()(const BrokerStatus& m) const { return std::to_string(m.broker); }
  std::string operator()(const ServiceStatus& m) const { return std::to_string(m.service); }
  std::string operator()(const Claim& m) const { return std::to_string(m.claimant); }
  std::string operator()(const JointPlanMessage& m) const { return m.round.leader; }
  std::string operator()(const OrderMessage& m) const { return m.id; }
  std::string operator()(const OrderStatus& m) const { return m.order.id; }
  std::string operator()(const HaltMessage&) const { return {}; }
  std::string operator()(const auto& m) const { return m.robot; }
};

}  // namespace

std::string key_of(const Message& message) {
  return std::visit(KeyOf(), message);
}

}  // namespace coppice
