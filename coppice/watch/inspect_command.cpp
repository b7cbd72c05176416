#include <iostream>
#include <string>
#include <variant>

#include <fmt/format.h>
#include <rapidjson/stringbuffer.h>
#include <rapidjson/writer.h>

#include "coppice/commands.h"
#include "monitor/recording/recorded_json.h"
#include "runtime/journal_examination.h"

namespace coppice {

namespace {

/// Each record as one line of JSON, with the byte at which it begins.
class Lines {
 public:
  void operator()(std::size_t place, const Message& message) { print(place, json_.line(message)); }
  void operator()(std::size_t place, const std::string& note) {
    rapidjson::StringBuffer quoted;
    rapidjson::Writer<rapidjson::StringBuffer>(quoted).String(note.data(),
                                                              static_cast<rapidjson::SizeType>(note.size()));
    print(place, fmt::format(R"({{"note":{}}})", quoted.GetString()));
  }
  void operator()(std::size_t place, std::monostate) { print(place, R"({"unreadable":true})"); }

 private:
  static void print(std::size_t place, const std::string& json) {
    std::cout << fmt::format(R"({{"byte":{},)", place) << json.substr(1) << '\n';
  }
  RecordedJson json_;
};

}  // namespace

int inspect_command(const InspectOptions& options) {
  Lines lines;
  const JournalExamination journal =
      examine_journal(options.file, [&](std::size_t place, const Recorded& record) {
        std::visit([&](const auto& what) { lines(place, what); }, record);
      });
  if (journal.in_use) return 0;
  for (const JournalDamage& damage : journal.damages)
    std::cerr << fmt::format("{}: damaged from byte {} to byte {}\n", options.file, damage.from,
                             damage.until);
  return journal.damages.empty() ? 0 : 1;
}

}  // namespace coppice
