#include "monitor/recording/recorded_json.h"

#include <stdexcept>

#include <fmt/format.h>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/dynamic_message.h>
#include <google/protobuf/util/json_util.h>

#include "monitor/recording/recorded_messages.h"

namespace coppice {

namespace pb = google::protobuf;

/// The types of recordings, made at run time from their own description.
struct RecordedJson::Schema {
  pb::DescriptorPool pool;
  pb::DynamicMessageFactory factory{&pool};
};

RecordedJson::RecordedJson() : schema_(std::make_unique<Schema>()) {
  pb::FileDescriptorSet files;
  if (!files.ParseFromString(recorded_schema())) throw std::logic_error("the schema of recordings is broken");
  for (const pb::FileDescriptorProto& file : files.file()) schema_->pool.BuildFile(file);
}

RecordedJson::~RecordedJson() = default;

std::string RecordedJson::line(const Message& message) {
  const TopicNumber topic = message.index();
  const pb::Descriptor* const type = schema_->pool.FindMessageTypeByName(schema_name(topic));
  const std::unique_ptr<pb::Message> fields(schema_->factory.GetPrototype(type)->New());
  pb::util::JsonPrintOptions options;
  options.always_print_primitive_fields = true;
  options.preserve_proto_field_names = true;
  std::string json;
  const bool is_whole = fields->ParseFromString(recorded(message)) &&
                        pb::util::MessageToJsonString(*fields, &json, options).ok();
  if (!is_whole) throw std::runtime_error(fmt::format("a {} cannot be written as JSON", schema_name(topic)));
  return fmt::format(R"({{"{}":{}}})", topic_infos.at(topic).name, json);
}

}  // namespace coppice
