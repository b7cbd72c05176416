#include "monitor/recording/player.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace coppice {

namespace {

constexpr double slowest = 0.01;
constexpr double fastest = 100;
constexpr std::size_t most_due = 50'000;  // messages in one turn

/// Tracks are left out: pages show the present, and tracks are the largest part of a recording.
Topics shown() {
  return Topics().set().reset(topic_number<TrackMessage>());
}

}  // namespace

Player::Player(const Recording& recording, WallTime now)
    : recording_(&recording),
      playback_(recording, recording.begin(), shown()),
      next_(playback_.next()),
      from_(recording.begin()),
      since_(now) {}

WallTime Player::at(WallTime now) const {
  const WallTime reached = playing_ ? from_ + speed_ * std::max(0.0, now - since_) : from_;
  return std::min(reached, recording_->end());
}

void Player::go_on(WallTime at, WallTime now) {
  from_ = at;
  since_ = now;
}

bool Player::jump(WallTime to, WallTime now) {
  go_on(std::clamp(to, recording_->begin(), recording_->end()), now);
  playback_ = Playback(*recording_, from_, shown());
  next_ = playback_.next();
  return true;
}

bool Player::heed(const live::FromPage& wish, WallTime now) {
  switch (wish.what_case()) {
    case live::FromPage::kPlaying: {
      const bool from_the_end = wish.playing() && at(now) >= recording_->end();
      go_on(at(now), now);
      playing_ = wish.playing();
      return from_the_end && jump(recording_->begin(), now);
    }
    case live::FromPage::kSpeed:
      go_on(at(now), now);
      if (std::isfinite(wish.speed())) speed_ = std::clamp(wish.speed(), slowest, fastest);
      return false;
    case live::FromPage::kSeek:
      return std::isfinite(wish.seek()) && jump(wish.seek(), now);
    case live::FromPage::WHAT_NOT_SET:
      return false;
  }
  return false;
}

std::vector<Arrival> Player::due(WallTime now) {
  std::vector<Arrival> arrivals;
  const WallTime reached = at(now);
  for (; next_ && next_->at <= reached; next_ = playback_.next()) {
    arrivals.push_back(*std::move(next_));
    if (arrivals.size() < most_due) continue;
    go_on(arrivals.back().at, now);  // after a pause of this process it catches up turn by turn
    next_ = playback_.next();
    return arrivals;
  }
  if (playing_ && reached >= recording_->end()) {
    go_on(reached, now);
    playing_ = false;
  }
  return arrivals;
}

live::Playback Player::state(WallTime now) const {
  live::Playback state;
  state.set_playing(playing_);
  state.set_speed(speed_);
  state.set_from(recording_->begin());
  state.set_until(recording_->end());
  state.set_at(at(now));
  return state;
}

}  // namespace coppice
