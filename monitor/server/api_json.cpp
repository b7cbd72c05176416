#include "monitor/server/api_json.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>

#include <rapidjson/stringbuffer.h>
#include <rapidjson/writer.h>

#include "monitor/view/fleet_table.h"

namespace coppice {

namespace {

using Writer = rapidjson::Writer<rapidjson::StringBuffer>;

constexpr std::array<std::string_view, 3> halt_names{"none", "paused", "stopped"};

void write(Writer& out, const char* name, std::string_view text) {
  out.Key(name);
  out.String(text.data(), static_cast<rapidjson::SizeType>(text.size()));
}

/// The stricter one of a pause and a stop.
void write(Writer& out, const char* name, Halt halt) {
  write(out, name, halt_names.at(static_cast<std::size_t>(strictest(halt))));
}

void write_number_or_null(Writer& out, const char* name, std::optional<double> value) {
  out.Key(name);
  if (value && std::isfinite(*value)) {
    out.Double(*value);
  } else {
    out.Null();
  }
}

void write_text_or_null(Writer& out, const char* name, std::string_view text) {
  if (!text.empty()) return write(out, name, text);
  out.Key(name);
  out.Null();
}

}  // namespace

std::string text_or_null(std::string_view text) {
  if (text.empty()) return "null";
  rapidjson::StringBuffer json;
  Writer(json).String(text.data(), static_cast<rapidjson::SizeType>(text.size()));
  return {json.GetString(), json.GetSize()};
}

std::string json_of(const SeenRobot& robot, double time, const std::string* order, Halt halt, WallTime now) {
  rapidjson::StringBuffer text;
  Writer out(text);
  out.SetMaxDecimalPlaces(3);
  std::optional<Point2> place;
  std::optional<double> yaw;
  if (robot.state) {
    place = position_at(*robot.state, time);
    if (robot.state->max_angular_speed > 0) yaw = yaw_at(*robot.state, time);
  }
  out.StartObject();
  write(out, "name", robot.name);
  write(out, "phase", name_of(phase_of(robot)));
  write_number_or_null(out, "x", place ? std::optional(place->x()) : std::nullopt);
  write_number_or_null(out, "y", place ? std::optional(place->y()) : std::nullopt);
  write_number_or_null(out, "yaw", yaw);
  write_text_or_null(out, "order", order == nullptr ? "" : *order);
  write(out, "halt", halt);
  const bool is_silent = is_lost(robot, now);
  write_text_or_null(out, "why", sentence_of(robot, time, now));
  write_number_or_null(out, "time_left", time_left(robot, time, now));
  write_number_or_null(out, "silent_since", is_silent ? std::optional(last_heard(robot)) : std::nullopt);
  out.EndObject();
  return {text.GetString(), text.GetSize()};
}

std::string json_of(const HaltMessage& halts) {
  rapidjson::StringBuffer text;
  Writer out(text);
  out.StartObject();
  write(out, "everybody", halts.everybody);
  out.Key("robots");
  out.StartArray();
  for (const HaltMessage::Robot& robot : halts.robots) {
    out.StartObject();
    write(out, "name", robot.robot);
    write(out, "halt", robot.halt);
    out.EndObject();
  }
  out.EndArray();
  out.EndObject();
  return {text.GetString(), text.GetSize()};
}

std::string json_of(const std::vector<Alarm>& alarms) {
  rapidjson::StringBuffer text;
  Writer out(text);
  out.SetMaxDecimalPlaces(3);
  out.StartObject();
  out.Key("alarms");
  out.StartArray();
  for (const Alarm& alarm : alarms) {
    out.StartObject();
    write(out, "kind", alarm_names.at(static_cast<std::size_t>(alarm.kind)));
    write_text_or_null(out, "robot", alarm.robot);
    write_number_or_null(out, "since", alarm.since);
    write(out, "text", alarm.text);
    out.EndObject();
  }
  out.EndArray();
  out.EndObject();
  return {text.GetString(), text.GetSize()};
}

}  // namespace coppice
