#include "messages/order_json.h"

#include <cstddef>
#include <string_view>

#include <rapidjson/stringbuffer.h>
#include <rapidjson/writer.h>

namespace coppice {

namespace {

using Writer = rapidjson::Writer<rapidjson::StringBuffer>;

void write(Writer& out, std::string_view text) {
  out.String(text.data(), static_cast<rapidjson::SizeType>(text.size()));
}
void write_field(Writer& out, const char* name, std::string_view text) {
  out.Key(name);
  write(out, text);
}
void write_text_or_null(Writer& out, const char* name, std::string_view text) {
  out.Key(name);
  if (text.empty()) {
    out.Null();
  } else {
    write(out, text);
  }
}
void write_time(Writer& out, const char* name, WallTime at) {
  out.Key(name);
  if (at == 0) {
    out.Null();
  } else {
    out.Double(at);
  }
}

void write_visits(Writer& out, const OrderMessage& order) {
  out.Key("goals");
  out.StartArray();
  for (const Visit& visit : order.visits) {
    out.StartObject();
    out.Key("x");
    out.Double(visit.position.x());
    out.Key("y");
    out.Double(visit.position.y());
    if (visit.has_yaw) {
      out.Key("yaw");
      out.Double(visit.yaw);
    }
    if (visit.wait > 0) {
      out.Key("wait");
      out.Double(visit.wait);
    }
    out.EndObject();
  }
  out.EndArray();
}

}  // namespace

std::string json_of(const OrderStatus& status) {
  const OrderMessage& order = status.order;
  rapidjson::StringBuffer text;
  Writer out(text);
  out.SetMaxDecimalPlaces(6);
  out.StartObject();
  write_field(out, "id", order.id);
  write_field(out, "action", action_names.at(static_cast<std::size_t>(order.action)));
  write_field(out, "state", order_state_names.at(static_cast<std::size_t>(status.state)));
  write_text_or_null(out, "robot", status.robot);
  out.Key("for");
  out.StartArray();
  for (const std::string& robot : order.robots) write(out, robot);
  out.EndArray();
  write_visits(out, order);
  out.Key("visited");
  out.Uint(status.visited);
  write_text_or_null(out, "cancels", order.cancels);
  write_text_or_null(out, "reason", status.reason);
  out.Key("priority");
  out.Int(order.priority);
  write_text_or_null(out, "by", order.by);
  write_time(out, "deadline", order.deadline);
  write_time(out, "accepted_at", status.accepted_at);
  write_time(out, "begun_at", status.begun_at);
  write_time(out, "ended_at", status.ended_at);
  out.EndObject();
  return {text.GetString(), text.GetSize()};
}

}  // namespace coppice
