#include "motion/lattice/safe_interval_search.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "motion/trajectory/corner_speed.h"

namespace coppice {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// An agent must not fall silent: these take some tenths of a second.
constexpr std::size_t most_expansions = 40'000;
constexpr std::size_t most_expansions_in_all = 80'000;
constexpr double detour = 1.5;       // of the shortest way: vertices further away are not looked at
constexpr double winding = 1.2;      // of the path: if the lattice's way is longer, the path is looked at too
constexpr double detour_steps = 40;  // spacings beyond that

/// Metres along lines in the eight directions of a lattice, across a box of this size.
double octile(const Point2& size) {
  return size.maxCoeff() + (std::numbers::sqrt2 - 1) * size.minCoeff();
}

}  // namespace

SafeIntervalSearch::SafeIntervalSearch(const ClearanceField& field, Lattice& lattice, double radius,
                                       const Path& path)
    : field_(field), lattice_(lattice), radius_(radius), roomy_((1 + reserved_stray_radii) * radius) {
  start_ = add_point(path.front());
  goal_ = add_point(path.back());
  begin_distances();
  if (distance(start_) <= winding * length_of(path)) return;
  add_path(path);
  begin_distances();
}

/// The way through passages that the lattice misses.
void SafeIntervalSearch::add_path(Path path) {
  path.erase(std::unique(path.begin(), path.end()), path.end());
  if (path.size() == 1) path.push_back(path.front());  // the robot is at its goal
  Vertex before = start_;
  for (std::size_t k = 1; k < path.size(); ++k) {
    if (!field_.segment_free(path[k - 1], path[k], radius_)) {
      before = add_point(path[k]);
      continue;
    }
    const Point2 way = path[k] - path[k - 1];
    const double parts = std::max(1.0, std::ceil(way.norm() / (2 * lattice_.spacing())));
    for (double part = 1; part <= parts; ++part) {
      const bool last = k + 1 == path.size() && part == parts;
      const Vertex v = last ? goal_ : add_point(path[k - 1] + way * (part / parts));
      const double length = way.norm() / parts;
      links_[v - lattice_.size()].push_back({before, length});
      links_[before - lattice_.size()].push_back({v, length});
      before = v;
    }
  }
}

SafeIntervalSearch::Vertex SafeIntervalSearch::add_point(const Point2& p) {
  const auto v = static_cast<Vertex>(lattice_.size() + points_.size());
  points_.push_back(p);
  links_.emplace_back();
  lattice_.for_each_around(p, Lattice::coarsest, [&](Vertex w) {
    if (!lattice_.vertex_free(w) || !field_.segment_free(p, lattice_.at(w), radius_)) return;
    const double length = (p - lattice_.at(w)).norm();
    if (length == 0) return;
    links_.back().push_back({w, length});
    links_off_[w].push_back({v, length});
  });
  return v;
}

template <class Fn>
void SafeIntervalSearch::for_each_link(Vertex v, Fn&& fn) {
  if (v >= lattice_.size()) {
    for (const Link& link : links_[v - lattice_.size()]) fn(link.to, link.length);
    return;
  }
  lattice_.for_each_neighbour(
      v, [](Vertex) { return true; }, fn);
  if (const auto off = links_off_.find(v); off != links_off_.end()) {
    for (const Link& link : off->second) fn(link.to, link.length);
  }
}

/// Begins an A* search from the goal to the start, which goes on as distances are requested (Silver,
/// "Cooperative Pathfinding", 2005: reverse resumable A*).
void SafeIntervalSearch::begin_distances() {
  distance_.assign(lattice_.size() + points_.size(), std::numeric_limits<float>::infinity());
  settled_.assign(distance_.size(), false);
  distance_[goal_] = 0;
  unsettled_ = {{0, 0, goal_}};
  most_ = infinity;
  most_ = detour * distance(start_) + detour_steps * lattice_.spacing();
}

/// Metres to the goal; infinite: a way from the start to the goal through v is too long.
float SafeIntervalSearch::distance(Vertex v) {
  const Point2& start = points_.front();
  while (!settled_[v] && !unsettled_.empty() && unsettled_.front().through <= most_) {
    const Reached here = unsettled_.front();
    std::ranges::pop_heap(unsettled_, std::greater<>(), &Reached::through);
    unsettled_.pop_back();
    if (settled_[here.vertex]) continue;
    settled_[here.vertex] = true;
    for_each_link(here.vertex, [&](Vertex w, double length) {
      const auto distance = static_cast<float>(here.distance + length);
      if (settled_[w] || distance >= distance_[w]) return;
      distance_[w] = distance;
      unsettled_.push_back({distance + static_cast<float>(octile((at(w) - start).cwiseAbs())), distance, w});
      std::ranges::push_heap(unsettled_, std::greater<>(), &Reached::through);
    });
  }
  return settled_[v] ? distance_[v] : std::numeric_limits<float>::infinity();
}

SafeIntervalSearch::Known& SafeIntervalSearch::known(Vertex v, SpaceTime& others) {
  if (number_[v] != none) return known_[number_[v]];
  number_[v] = static_cast<std::uint32_t>(known_.size());
  const auto first = static_cast<std::uint32_t>(states_.size());
  const Point2 place = at(v);
  for (const Interval& safe : others.safe_at(place)) states_.push_back({v, place, safe});
  known_.push_back({first, static_cast<std::uint32_t>(states_.size())});  // clang 14 emplaces no aggregate
  return known_.back();
}

/// Seconds that a robot loses because it slows down for the turn at a state's vertex.
double SafeIntervalSearch::time_lost(const State& s, Vertex to, const Limits& limits) const {
  if (s.parent == none) return 0;
  const Point2 out = (at(to) - s.place).normalized();
  return time_lost_around(s.heading, out, reserved_stray_radii * radius_, limits);
}

void SafeIntervalSearch::push(const Move& move) {
  open_.push_back(move);
  std::ranges::push_heap(open_, std::greater<>(), &Move::cost);
}

std::optional<SafeIntervalSearch::Move> SafeIntervalSearch::next_move() {
  if (open_.empty()) return std::nullopt;
  std::ranges::pop_heap(open_, std::greater<>(), &Move::cost);
  const Move move = open_.back();
  open_.pop_back();
  return move;
}

/// The earliest arrivals at a vertex, one in each of its safe intervals, straight from a state, if nobody
/// comes across.
void SafeIntervalSearch::offer_moves(std::uint32_t from, Vertex to, double length, SpaceTime& others,
                                     const Limits& limits) {
  Known& there = known(to, others);
  if (std::ranges::find(there.from, from) != there.from.end()) return;
  there.from.push_back(from);
  const State& s = states_[from];
  const double duration = length / limits.max_speed;
  const double ready = s.time + time_lost(s, to, limits);
  for (std::uint32_t k = there.first; k < there.end; ++k) {
    const State& t = states_[k];
    const double departure = std::max(ready, t.safe.begin - duration);
    if (departure > s.safe.end) return;
    const double arrival = departure + duration;
    if (t.closed || arrival >= std::min(t.safe.end, t.time)) continue;
    push({arrival + distance_[to] / limits.max_speed, from, k, departure, false});
  }
}

/// Whether the move takes place as offered. If it takes place later, it is offered again.
bool SafeIntervalSearch::look_at(Move& move, SpaceTime& others, const Limits& limits) {
  if (std::exchange(move.is_certain, true)) return true;
  const State& s = states_[move.from];
  State& t = states_[move.to];
  const Point2& a = s.place;
  const Point2& b = t.place;
  const double duration = (b - a).norm() / limits.max_speed;
  const double ready = s.time + time_lost(s, t.vertex, limits);
  const double offered = std::exchange(
      move.departure, s.parent == none ? others.first_departure(a, b, duration, move.departure)
                                       : others.first_departure(a, b, ready, move.departure, limits));
  if (move.departure == offered) return true;
  const double arrival = move.departure + duration;
  if (move.departure > s.safe.end || arrival >= std::min(t.safe.end, t.time)) return false;
  t.time = arrival;
  move.cost += move.departure - offered;
  push(move);
  return false;
}

/// The robot arrives: no earlier arrival in this state will be found.
void SafeIntervalSearch::carry_out(const Move& move, const Limits& limits) {
  State& to = states_[move.to];
  to.closed = true;
  if (move.from == none) return;
  const Point2 way = to.place - states_[move.from].place;
  to.parent = move.from;
  to.time = move.departure + way.norm() / limits.max_speed;
  to.heading = way.normalized();
}

void SafeIntervalSearch::begin_at(double time, SpaceTime& others, const Limits& limits) {
  const Known& start = known(start_, others);
  for (std::uint32_t k = start.first; k < start.end; ++k) {
    State& s = states_[k];
    if (time < s.safe.begin || time >= s.safe.end) continue;
    s.time = time;
    push({time + distance_[start_] / limits.max_speed, none, k, time, true});
  }
}

std::optional<Trajectory> SafeIntervalSearch::search(SpaceTime& others, double begin, const Limits& limits,
                                                     double before, double stays) {
  if (distance(start_) == std::numeric_limits<float>::infinity()) return std::nullopt;
  number_.assign(distance_.size(), none);
  known_.clear();
  states_.clear();
  open_.clear();
  begin_at(begin, others, limits);
  std::size_t expanded = 0;
  while (std::optional<Move> move = next_move()) {
    if (move->cost >= before) return std::nullopt;
    if (states_[move->to].closed || !look_at(*move, others, limits)) continue;
    carry_out(*move, limits);
    const State here = states_[move->to];
    if (here.vertex == goal_ && here.safe.end >= here.time + stays)
      return trajectory_to(move->to, begin, limits.max_speed);
    if (++expanded > most_expansions || ++expanded_in_all_ > most_expansions_in_all) return std::nullopt;
    for_each_link(here.vertex, [&](Vertex w, double length) {
      if (distance(w) == std::numeric_limits<float>::infinity()) return;
      if (here.parent != none) {
        const State& up = states_[here.parent];
        const Point2 place = at(w);
        if (up.vertex != w && field_.segment_free(up.place, place, roomy_))
          offer_moves(here.parent, w, (place - up.place).norm(), others, limits);
      }
      offer_moves(move->to, w, length, others, limits);
    });
  }
  return std::nullopt;
}

Trajectory SafeIntervalSearch::trajectory_to(std::uint32_t state, double begin, double speed) const {
  Trajectory back{{states_[state].time, states_[state].place}};
  for (; states_[state].parent != none; state = states_[state].parent) {
    const State& here = states_[state];
    const State& before = states_[here.parent];
    const double departure = here.time - (here.place - before.place).norm() / speed;
    if (departure > before.time + 1e-9) back.push_back({departure, before.place});
    back.push_back({before.time, before.place});
  }
  std::ranges::reverse(back);
  back.front().time = begin;
  return back;
}

}  // namespace coppice
