#include "robot_agent/control/connectivity.h"

namespace coppice {

namespace {

template <class... Fns>
struct Overloaded : Fns... {
  using Fns::operator()...;
};
template <class... Fns>  // clang 14 deduces nothing for aggregates
Overloaded(Fns...)->Overloaded<Fns...>;

}  // namespace

void Connectivity::stand_until(double until) {
  if (std::holds_alternative<Connected>(state_)) state_ = Settling{until};
  std::visit(Overloaded{[](Connected&) {}, [&](auto& state) { state.until = until; }}, state_);
}

void Connectivity::observe(bool cut_off, double now, double until) {
  const bool settles = std::holds_alternative<Settling>(state_) || std::holds_alternative<Connected>(state_);
  if (cut_off && settles) {
    state_ = CutOff{until};
  } else if (cut_off) {
    stand_until(until);
  } else if (const auto* was = std::get_if<CutOff>(&state_)) {
    state_ = Settling{was->until};
  } else if (settles && !listens(now)) {
    state_ = Connected{};
  }
}

bool Connectivity::still_joining(double now) {
  if (joining() && !listens(now)) state_ = Connected{};
  return joining();
}

double Connectivity::peer_is_unheard(double now) {
  if (const auto* isolated = std::get_if<Isolated>(&state_)) return isolated->peer_unheard_since;
  auto* const cut_off = std::get_if<CutOff>(&state_);
  if (cut_off == nullptr) return now;
  if (!cut_off->peer_unheard_since) cut_off->peer_unheard_since = now;
  return *cut_off->peer_unheard_since;
}

bool Connectivity::peers_are_heard() {
  if (auto* const cut_off = std::get_if<CutOff>(&state_)) cut_off->peer_unheard_since.reset();
  const auto* const isolated = std::get_if<Isolated>(&state_);
  if (isolated == nullptr) return false;
  state_ = Settling{isolated->until};
  return true;
}

void Connectivity::isolate() {
  if (const auto* cut_off = std::get_if<CutOff>(&state_))
    state_ = Isolated{cut_off->until, cut_off->peer_unheard_since.value_or(cut_off->until)};
}

bool Connectivity::listens(double now) const {
  return std::visit(Overloaded{[](const Connected&) { return false; },
                               [&](const auto& state) { return now < state.until; }},
                    state_);
}

}  // namespace coppice
