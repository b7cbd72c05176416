#include "monitor/recording/recorder.h"

#include <algorithm>
#include <string>
#include <utility>

namespace coppice {

namespace {

constexpr WallTime longest_late = 5;  // seconds: an older message was stamped by a clock that was set back

/// The chunk for a topic's messages. It depends on what a seek reads of the topic (recording.h): nothing, the
/// latest of each key, or all. So a seek need not read the other chunks.
std::size_t chunk_of(const TopicInfo& info) {
  if (info.durability == Durability::volatile_) return 0;
  return info.depth == 1 ? 1 : 2;
}

}  // namespace

Recorder::Recorder(McapWriter::Compression compression) : writer_("coppice " COPPICE_VERSION, compression) {
  for (TopicNumber topic = 0; topic < topic_count; ++topic) {
    channels_[topic] =
        writer_.add_channel(channel_name(topic), mcap::protobuf, schema_name(topic), recorded_schema());
  }
}

void Recorder::on(std::vector<Arrival> arrivals) {
  // The bus hands over messages topic by topic. A late message is recorded with the latest time, so that the
  // file stays in order.
  std::ranges::stable_sort(arrivals, {}, &Arrival::at);
  for (const Arrival& arrival : arrivals) add(arrival);
}

void Recorder::add(const Arrival& arrival) {
  const TopicNumber topic = arrival.message->index();
  const std::string bytes = recorded(*arrival.message);
  if (bytes.size() > largest_recorded(topic)) {
    ++left_out_;
    return;
  }
  if (arrival.at + ahead_ < latest_ - longest_late) ahead_ = latest_ - arrival.at;  // the clock was set back
  latest_ = std::max(latest_, arrival.at + ahead_);
  McapChunk& chunk = chunks_[chunk_of(topic_infos[topic])];
  chunk.add(channels_[topic], counts_[topic]++, nanoseconds(latest_), bytes);
  if (chunk.size() >= chunk_size) writer_.write(std::exchange(chunk, {}));
}

mcap::Bytes Recorder::step(WallTime now) {
  const bool has_some = std::ranges::any_of(chunks_, [](const McapChunk& chunk) { return !chunk.empty(); });
  if (has_some) begun_ = std::min(begun_.value_or(now), now);
  if (begun_ && now - *begun_ >= chunk_period) end_chunks();
  return writer_.take();
}

void Recorder::end_chunks() {
  for (McapChunk& chunk : chunks_) writer_.write(std::exchange(chunk, {}));
  begun_.reset();
}

mcap::Bytes Recorder::finish() {
  end_chunks();
  writer_.finish();
  return writer_.take();
}

}  // namespace coppice
