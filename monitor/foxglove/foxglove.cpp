#include "monitor/foxglove/foxglove.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <set>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/util/json_util.h>

#include "foxglove_socket.pb.h"
#include "monitor/foxglove/foxglove_scene.h"

namespace coppice {

namespace {

namespace scene = foxglove_scene;
namespace socket = foxglove_socket;

constexpr std::size_t most_nodes_at_once = 1 << 14;  // nodes of trees in one message
constexpr std::size_t most_complaints = 8;           // waiting to be sent; further ones are dropped

struct AdvertisedChannel {
  FoxgloveFeed::Topic topic;
  const char* name;
  const google::protobuf::Descriptor* schema;
};

/// A channel's id is its index here plus one.
const std::array<AdvertisedChannel, 9>& channels() {
  using enum FoxgloveFeed::Topic;
  static const std::array<AdvertisedChannel, 9> all{{
      {map, "/map", ::foxglove::Grid::descriptor()},
      {robots, "/robots", ::foxglove::SceneUpdate::descriptor()},
      {poses, "/poses", ::foxglove::PosesInFrame::descriptor()},
      {transforms, "/tf", ::foxglove::FrameTransforms::descriptor()},
      {paths, "/paths", ::foxglove::SceneUpdate::descriptor()},
      {trees, "/trees", ::foxglove::SceneUpdate::descriptor()},
      {root_trees, "/root_trees", ::foxglove::SceneUpdate::descriptor()},
      {log, "/log", ::foxglove::Log::descriptor()},
      {fleet, "/fleet", live::Figures::Point::descriptor()},
  }};
  return all;
}

void add_file(google::protobuf::FileDescriptorSet& set, const google::protobuf::FileDescriptor& file,
              std::set<std::string>& had) {
  if (!had.insert(file.name()).second) return;
  for (int k = 0; k < file.dependency_count(); ++k) add_file(set, *file.dependency(k), had);
  file.CopyTo(set.add_file());
}

/// The files that a decoder needs, each after the files that it imports.
std::string file_descriptors(const google::protobuf::Descriptor& type) {
  google::protobuf::FileDescriptorSet set;
  std::set<std::string> had;
  add_file(set, *type.file(), had);
  return set.SerializeAsString();
}

Outbound text(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.always_print_primitive_fields = true;
  auto json = std::make_shared<std::string>();
  // Cannot fail: all fields of these messages can be written in JSON.
  static_cast<void>(google::protobuf::util::MessageToJsonString(message, json.get(), options));
  return {std::move(json), true};
}

Outbound server_info() {
  socket::ServerInfo info;
  info.set_op("serverInfo");
  info.set_name("Coppice");
  (*info.mutable_metadata())["version"] = COPPICE_VERSION;
  return text(info);
}

Outbound advertisement() {
  socket::Advertise message;
  message.set_op("advertise");
  for (std::size_t k = 0; k < channels().size(); ++k) {
    const auto& [topic, name, schema] = channels()[k];
    socket::Advertise::Channel& channel = *message.add_channels();
    channel.set_id(static_cast<std::uint32_t>(k + 1));
    channel.set_topic(name);
    channel.set_encoding("protobuf");
    channel.set_schema_name(schema->full_name());
    channel.set_schema(file_descriptors(*schema));
    channel.set_schema_encoding("protobuf");
  }
  return text(message);
}

Outbound complaint(const std::string& what) {
  socket::Status status;
  status.set_op("status");
  status.set_level(2);
  status.set_message(what);
  return text(status);
}

template <class I>
void append_little_endian(std::string& out, I value) {
  for (std::size_t k = 0; k < sizeof value; ++k) out.push_back(static_cast<char>(value >> 8 * k & 0xff));
}

/// Message data: opcode 1, subscription, nanoseconds, message.
Outbound message_data(std::uint32_t subscription, WallTime at, const std::string& payload) {
  auto bytes = std::make_shared<std::string>(1, '\x01');
  append_little_endian(*bytes, subscription);
  append_little_endian(*bytes, static_cast<std::uint64_t>(std::llround(at * 1e6)) * 1000);
  *bytes += payload;
  return {std::move(bytes), false};
}

bool is_news(const Edition& edition, std::uint64_t& had) {
  return edition.bytes && std::exchange(had, edition.number) != edition.number;
}

/// The points of the time series since the last call. A new subscription gets only the latest point.
std::vector<std::string> new_figures(std::size_t& had, const LiveStream& live, bool anew) {
  const std::size_t dropped = live.figures_dropped();
  const std::size_t all = dropped + live.figures().size();
  if (anew && all > 0) had = all - 1;
  std::vector<std::string> points;
  for (had = std::max(had, dropped); had < all; ++had)
    points.push_back(live.figures()[had - dropped].SerializeAsString());
  return points;
}

/// Adds the trees that are new since the last call, as many as fit.
void add_trees(::foxglove::SceneUpdate& update, std::size_t& done, const FleetView& view, WallTime now) {
  const auto& trees = view.inactive_trees();
  for (std::size_t nodes = 0; done < trees.size() && nodes < most_nodes_at_once; ++done) {
    const auto& tree = std::get<InactiveTreesMessage>(*trees[done]);
    nodes += tree.nodes.size();
    scene::add_inactive_tree(update, tree, scene::projection_of(view), now);
  }
}

}  // namespace

std::vector<Outbound> FoxgloveFeed::next(const FleetView& view, const LiveStream& live) {
  std::vector<Outbound> out;
  if (!std::exchange(greeted_, true)) out = {server_info(), advertisement()};
  for (const std::string& what : std::exchange(complaints_, {})) out.push_back(complaint(what));
  for (Subscription& subscription : subscriptions_) {
    for (const std::string& payload : news(subscription, view, live))
      out.push_back(message_data(subscription.id, live.at(), payload));
  }
  return out;
}

void FoxgloveFeed::on(std::string_view message, bool text) {
  if (!text) return complain("This server does not accept data.");
  google::protobuf::util::JsonParseOptions options;
  options.ignore_unknown_fields = true;
  socket::FromClient said;
  if (!google::protobuf::util::JsonStringToMessage(std::string(message), &said, options).ok())
    return complain("This is not a message of the protocol.");
  if (said.op() == "subscribe") {
    for (const auto& wish : said.subscriptions()) subscribe(wish.id(), wish.channel_id());
  } else if (said.op() == "unsubscribe") {
    for (const std::uint32_t id : said.subscription_ids())
      std::erase_if(subscriptions_, [&](const Subscription& known) { return known.id == id; });
  } else {
    complain(fmt::format("{:.40}: this server does not support this operation.", said.op()));
  }
}

void FoxgloveFeed::subscribe(std::uint32_t id, std::uint32_t channel) {
  if (channel == 0 || channel > channels().size())
    return complain(fmt::format("There is no channel {}.", channel));
  if (std::ranges::find(subscriptions_, id, &Subscription::id) != subscriptions_.end())
    return complain(fmt::format("There is a subscription {} already.", id));
  const Topic topic = channels()[channel - 1].topic;
  if (std::ranges::find(subscriptions_, topic, &Subscription::topic) != subscriptions_.end())
    return complain(fmt::format("There is a subscription to channel {} already.", channel));
  subscriptions_.push_back({.id = id, .topic = topic});
}

void FoxgloveFeed::complain(const std::string& what) {
  if (complaints_.size() < most_complaints) complaints_.push_back(what);
}

std::vector<std::string> FoxgloveFeed::news(Subscription& subscription, const FleetView& view,
                                            const LiveStream& live) {
  const bool anew = subscription.run != live.run();
  if (anew) subscription = {.id = subscription.id, .topic = subscription.topic, .run = live.run()};
  switch (subscription.topic) {
    case Topic::map:
      if (!is_news(live.map(), subscription.edition)) return {};
      return {scene::grid(*view.map(), live.at()).SerializeAsString()};
    case Topic::poses:
      if (!is_news(live.frame(), subscription.edition)) return {};
      return {scene::poses(view, live.at()).SerializeAsString()};
    case Topic::transforms:
      if (!is_news(live.frame(), subscription.edition)) return {};
      return {scene::transforms(view, live.at()).SerializeAsString()};
    case Topic::fleet:
      return new_figures(subscription.items, live, anew);
    case Topic::log:
      return log_news(subscription, view, live.at());
    case Topic::robots:
    case Topic::paths:
    case Topic::trees:
    case Topic::root_trees:
      break;
  }
  ::foxglove::SceneUpdate update;
  if (anew) scene::add_deletion_of_all(update, live.at());
  add_scene_news(subscription, view, live, update);
  if (update.entities_size() == 0 && update.deletions_size() == 0) return {};
  return {update.SerializeAsString()};
}

void FoxgloveFeed::add_scene_news(Subscription& subscription, const FleetView& view, const LiveStream& live,
                                  ::foxglove::SceneUpdate& update) {
  if (subscription.topic == Topic::robots) {
    if (is_news(live.frame(), subscription.edition)) update.MergeFrom(scene::robots(view, live.at()));
    return;
  }
  if (subscription.topic == Topic::trees) return add_trees(update, subscription.items, view, live.at());
  if (std::exchange(subscription.edition, live.slow_tick()) == live.slow_tick()) return;
  subscription.robots.resize(view.robots().size());
  for (std::size_t k = 0; k < subscription.robots.size(); ++k) {
    if (subscription.topic == Topic::paths) {
      add_path(update, subscription.robots[k], view.robots()[k], view, live.at());
    } else {
      add_root_trees(update, subscription.robots[k], view.robots()[k], view, live.at());
    }
  }
}

std::vector<std::string> FoxgloveFeed::log_news(Subscription& subscription, const FleetView& view,
                                                WallTime now) {
  std::vector<std::string> lines;
  subscription.robots.resize(view.robots().size());
  for (std::size_t k = 0; k < subscription.robots.size(); ++k) {
    const SeenRobot& robot = view.robots()[k];
    if (!robot.status) continue;
    const auto phase = static_cast<std::uint32_t>(robot.status->phase) + 1;
    if (std::exchange(subscription.robots[k].of, phase) == phase) continue;
    lines.push_back(scene::log_of(robot, now).SerializeAsString());
  }
  return lines;
}

void FoxgloveFeed::add_path(::foxglove::SceneUpdate& update, Told& told, const SeenRobot& robot,
                            const FleetView& view, WallTime now) {
  if (std::exchange(told.of, robot.path_revision) == robot.path_revision) return;
  scene::add_path(update, robot, scene::projection_of(view), now);
}

void FoxgloveFeed::add_root_trees(::foxglove::SceneUpdate& update, Told& told, const SeenRobot& robot,
                                  const FleetView& view, WallTime now) {
  const std::uint32_t mission = robot.mission ? robot.mission->number : 0;
  if (told.of != mission) {
    scene::delete_root_trees(update, robot.name, told.parts, now);
    told = {.of = mission};
  }
  if (told.root_nodes == robot.root_nodes.size()) return;
  scene::add_root_trees(update, robot, told.root_nodes, told.parts++, scene::projection_of(view), now);
  told.root_nodes = robot.root_nodes.size();
}

}  // namespace coppice
