// The messages of the bus as JSON, for people and scripts. The names are those of the fields in recordings.
#pragma once

#include <memory>
#include <string>

#include "messages/messages.h"

namespace coppice {

class RecordedJson {
 public:
  RecordedJson();
  ~RecordedJson();
  RecordedJson(const RecordedJson&) = delete;
  RecordedJson& operator=(const RecordedJson&) = delete;

  /// One line: {"topic": {fields}}. Fields that are 0 or empty are in it, too.
  std::string line(const Message& message);

 private:
  struct Schema;
  std::unique_ptr<Schema> schema_;
};

}  // namespace coppice
