#include "motion/safe_interval_search.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>

#include "motion/corner_speed.h"

namespace coppice {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// An agent must not fall silent: these take some tenths of a second.
constexpr std::size_t most_expansions = 40'000;
constexpr std::size_t most_expansions_in_all = 80'000;
constexpr double detour = 1.5;       // of the shortest way: vertices further away are not looked at
constexpr double worthwhile = 1.2;   // of the path: if the lattice's way is longer, the path is looked at too
constexpr double detour_steps = 20;  // spacings beyond that

}  // namespace

SafeIntervalSearch::SafeIntervalSearch(const ClearanceField& field, Lattice& lattice, double radius,
                                       const Path& path)
    : field_(field), lattice_(lattice), radius_(radius), roomy_((1 + reserved_stray_radii) * radius) {
  start_ = add_point(path.front());
  goal_ = add_point(path.back());
  measure_distances();
  if (distance_[start_] <= worthwhile * length_of(path)) return;
  add_path(path);
  measure_distances();
}

/// The way through passages that the lattice misses.
void SafeIntervalSearch::add_path(const Path& path) {
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
  lattice_.for_each_around(p, Lattice::usual_reach, [&](Vertex w) {
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

/// Dijkstra's search from the goal, a little further than to the start.
void SafeIntervalSearch::measure_distances() {
  distance_.assign(lattice_.size() + points_.size(), std::numeric_limits<float>::infinity());
  std::priority_queue<std::pair<float, Vertex>, std::vector<std::pair<float, Vertex>>, std::greater<>> open;
  distance_[goal_] = 0;
  open.emplace(0, goal_);
  double most = infinity;
  while (!open.empty()) {
    const auto [here, v] = open.top();
    open.pop();
    if (here > distance_[v]) continue;
    if (here > most) break;
    if (v == start_) most = detour * here + detour_steps * lattice_.spacing();
    for_each_link(v, [&, from = here](Vertex w, double length) {  // clang 14 captures no binding
      const auto through = static_cast<float>(from + length);
      if (through >= distance_[w]) return;
      distance_[w] = through;
      open.emplace(through, w);
    });
  }
}

SafeIntervalSearch::Known& SafeIntervalSearch::known(Vertex v, SpaceTime& others) {
  const auto [at_v, is_new] = known_.try_emplace(v);
  Known& known = at_v->second;
  if (!is_new) return known;
  known.safe = others.safe_at(at(v));
  known.states.assign(known.safe.size(), none);
  return known;
}

/// Seconds that a robot loses because it slows down for the turn at a state's vertex.
double SafeIntervalSearch::time_lost(const State& s, Vertex to, const Limits& limits) const {
  if (s.parent == none) return 0;
  const Point2 here = at(s.vertex);
  const Point2 in = (here - at(states_[s.parent].vertex)).normalized();
  const Point2 out = (at(to) - here).normalized();
  return time_lost_around(in, out, reserved_stray_radii * radius_, limits);
}

/// The earliest arrivals at a vertex, one in each of its safe intervals, straight from a state.
void SafeIntervalSearch::reach(std::uint32_t from, Vertex to, double length, SpaceTime& others,
                               const Limits& limits) {
  const State s = states_[from];
  const double duration = length / limits.max_speed;
  Known& there = known(to, others);
  if (std::ranges::find(there.from, from) != there.from.end()) return;
  there.from.push_back(from);
  const double ready = s.time + time_lost(s, to, limits);
  double departure = ready;
  for (std::size_t k = 0; k < there.safe.size(); ++k) {
    const Interval& safe = there.safe[k];
    if (safe.end <= departure + duration) continue;
    departure = std::max(departure, safe.begin - duration);
    if (departure > s.safe_until) return;
    std::uint32_t& state = there.states[k];
    if (state != none && (states_[state].closed || departure + duration >= states_[state].time)) continue;
    departure = s.parent == none ? others.first_departure(at(s.vertex), at(to), duration, departure)
                                 : others.first_departure(at(s.vertex), at(to), ready, departure, limits);
    if (departure > s.safe_until || departure == infinity) return;
    const double arrival = departure + duration;
    if (arrival >= safe.end) continue;
    if (state == none) {
      state = static_cast<std::uint32_t>(states_.size());
      states_.push_back({to, safe.end, infinity, none});
    }
    State& known = states_[state];
    if (arrival >= known.time) continue;
    known.time = arrival;
    known.parent = from;
    open_.emplace_back(arrival + distance_[to] / limits.max_speed, state);
    std::ranges::push_heap(open_, std::greater<>());
  }
}

std::optional<Trajectory> SafeIntervalSearch::search(SpaceTime& others, double begin, const Limits& limits,
                                                     double before) {
  const double speed = limits.max_speed;
  if (distance_[start_] == std::numeric_limits<float>::infinity()) return std::nullopt;
  known_.clear();
  states_.clear();
  open_.clear();
  std::size_t expanded = 0;
  Known& first = known(start_, others);
  const auto safe =
      std::ranges::find_if(first.safe, [&](const Interval& i) { return i.begin <= begin && begin < i.end; });
  if (safe == first.safe.end()) return std::nullopt;
  first.states[static_cast<std::size_t>(safe - first.safe.begin())] = 0;
  states_.push_back({start_, safe->end, begin, none});
  open_.emplace_back(begin + distance_[start_] / speed, 0);
  while (!open_.empty()) {
    std::ranges::pop_heap(open_, std::greater<>());
    if (open_.back().first >= before) return std::nullopt;
    const std::uint32_t number = open_.back().second;
    open_.pop_back();
    if (std::exchange(states_[number].closed, true)) continue;
    const State here = states_[number];
    if (here.vertex == goal_ && here.safe_until == infinity) return trajectory_to(number, begin, speed);
    if (++expanded > most_expansions || ++expanded_in_all_ > most_expansions_in_all) return std::nullopt;
    for_each_link(here.vertex, [&](Vertex w, double length) {
      if (distance_[w] == std::numeric_limits<float>::infinity()) return;
      if (here.parent != none) {
        const Vertex up = states_[here.parent].vertex;
        if (up != w && field_.segment_free(at(up), at(w), roomy_))
          reach(here.parent, w, (at(up) - at(w)).norm(), others, limits);
      }
      reach(number, w, length, others, limits);
    });
  }
  return std::nullopt;
}

Trajectory SafeIntervalSearch::trajectory_to(std::uint32_t state, double begin, double speed) const {
  Trajectory back{{states_[state].time, at(states_[state].vertex)}};
  for (; states_[state].parent != none; state = states_[state].parent) {
    const State& before = states_[states_[state].parent];
    const Point2 from = at(before.vertex);
    const double departure = states_[state].time - (at(states_[state].vertex) - from).norm() / speed;
    if (departure > before.time + 1e-9) back.push_back({departure, from});
    back.push_back({before.time, from});
  }
  std::ranges::reverse(back);
  back.front().time = begin;
  return back;
}

}  // namespace coppice
