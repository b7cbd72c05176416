#include "monitor/recording/recording.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "files/file_kind.h"
#include "messages/message_key.h"
#include "messages/validation.h"

namespace coppice {

namespace {

constexpr mcap::Time latest_time = std::numeric_limits<mcap::Time>::max();

Topics topics_that(bool (*holds)(const TopicInfo&)) {
  Topics topics;
  for (TopicNumber topic = 0; topic < topic_count; ++topic) topics[topic] = holds(topic_infos[topic]);
  return topics;
}
Topics topics_that_keep_latest() {
  return topics_that([](const TopicInfo& info) {
    return info.durability == Durability::transient_local && info.depth == 1;
  });
}
Topics topics_that_keep_all() {
  return topics_that([](const TopicInfo& info) {
    return info.durability == Durability::transient_local && info.depth != 1;
  });
}
Topics topics_that_keep_nothing() {
  return topics_that([](const TopicInfo& info) { return info.durability == Durability::volatile_; });
}

/// Returns the file's name, unless the file is of another kind.
const std::string& recording_in(const std::string& file) {
  refuse_other_kinds(file, {FileKind::recording}, "a recording (MCAP)");
  return file;
}

McapMessages messages_of(const Recording& recording, const Topics& topics, mcap::Time from,
                         mcap::Time until) {
  return {recording.file(), from, until, recording.channels_of(topics)};
}

/// Recordings of earlier versions do not tell the first number of a trajectory.
void complete(Message& message) {
  auto* const r = std::get_if<ReservationMessage>(&message);
  if (r != nullptr && r->first_number == 0) r->first_number = r->number;
}

}  // namespace

Recording::Recording(const std::string& file) : reader_(recording_in(file)) {
  for (const auto& [id, channel] : reader_.channels()) {
    const auto schema = reader_.schemas().find(channel.schema);
    if (schema == reader_.schemas().end() || channel.message_encoding != mcap::protobuf) continue;
    for (TopicNumber topic = 0; topic < topic_count; ++topic) {
      if (channel.topic == channel_name(topic) && schema->second.name == schema_name(topic))
        topics_.emplace(id, topic);
    }
  }
  if (topics_.empty())
    mcap::refuse(reader_.at(0),
                 "not a recording of a fleet: expected a channel of coppice record, found none");
}

std::uint64_t Recording::count(TopicNumber topic) const {
  std::uint64_t all = 0;
  for (const auto& [channel, messages] : reader_.statistics().channel_messages) {
    if (topic_of(channel) == topic) all += messages;
  }
  return all;
}

std::optional<TopicNumber> Recording::topic_of(std::uint16_t channel) const {
  const auto known = topics_.find(channel);
  return known == topics_.end() ? std::nullopt : std::optional(known->second);
}

std::set<std::uint16_t> Recording::channels_of(const Topics& topics) const {
  std::set<std::uint16_t> channels;
  for (const auto& [channel, topic] : topics_) {
    if (topics[topic]) channels.insert(channel);
  }
  return channels;
}

Playback::Playback(const Recording& recording, WallTime from, const Topics& topics)
    : recording_(&recording),
      kept_(messages_of(recording, topics & topics_that_keep_all(), 0, nanoseconds(from))),
      rest_(messages_of(recording, topics, nanoseconds(from), latest_time)) {
  const mcap::Time begin = nanoseconds(from);
  std::map<std::pair<TopicNumber, std::string>, Arrival> latest;
  const auto gather = [&](McapMessages messages) {
    while (auto arrival = next_of(messages)) {
      const auto* const state = std::get_if<RobotState>(arrival->message.get());
      if (state != nullptr && state->passed_on) continue;
      latest.insert_or_assign(std::pair(arrival->message->index(), key_of(*arrival->message)),
                              std::move(*arrival));
    }
  };
  gather(messages_of(recording, topics & topics_that_keep_latest(), 0, begin));
  gather(messages_of(recording, topics & topics_that_keep_nothing(), nanoseconds(from - lead_in), begin));
  for (auto& [key, arrival] : latest) state_.push_back(std::move(arrival));
  std::ranges::stable_sort(state_, {}, &Arrival::at);
  std::ranges::reverse(state_);
  next_kept_ = next_of(kept_);
}

std::optional<Arrival> Playback::next() {
  if (next_kept_ && (state_.empty() || next_kept_->at < state_.back().at))
    return std::exchange(next_kept_, next_of(kept_));
  if (state_.empty()) return next_of(rest_);
  Arrival first = std::move(state_.back());
  state_.pop_back();
  return first;
}

std::optional<Arrival> Playback::next_of(McapMessages& messages) {
  while (const mcap::Message* const next = messages.next()) {
    auto message = message_in(*recording_->topic_of(next->channel), next->data);
    if (message) complete(*message);
    if (message && !problem_with(*message)) return arrival_of(std::move(*message), wall_time(next->log_time));
    ++rejected_;
  }
  return std::nullopt;
}

}  // namespace coppice
