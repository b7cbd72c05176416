#include "monitor/server/web_problem.h"

#include <algorithm>
#include <string>

#include <boost/beast/http/status.hpp>
#include <rapidjson/stringbuffer.h>
#include <rapidjson/writer.h>

namespace coppice {

namespace {

using ProblemWriter = rapidjson::Writer<rapidjson::StringBuffer, rapidjson::UTF8<>, rapidjson::UTF8<>,
                                        rapidjson::CrtAllocator, rapidjson::kWriteValidateEncodingFlag>;

bool is_utf8(const std::string& text) {
  rapidjson::StringBuffer out;
  return ProblemWriter(out).String(text.data(), static_cast<rapidjson::SizeType>(text.size()));
}

/// Details repeat what clients sent, which may be any bytes.
std::string readable(std::string_view text) {
  std::string copy(text);
  if (!is_utf8(copy))
    std::ranges::replace_if(
        copy, [](unsigned char c) { return c >= 0x80; }, '?');
  return copy;
}

}  // namespace

WebReply problem_reply(unsigned status, std::string_view detail) {
  const auto title = boost::beast::http::obsolete_reason(boost::beast::http::int_to_status(status));
  rapidjson::StringBuffer text;
  ProblemWriter out(text);
  const std::string plain = readable(detail);
  out.StartObject();
  out.Key("type");
  out.String("about:blank");
  out.Key("title");
  out.String(title.data(), static_cast<rapidjson::SizeType>(title.size()));
  out.Key("status");
  out.Uint(status);
  out.Key("detail");
  out.String(plain.data(), static_cast<rapidjson::SizeType>(plain.size()));
  out.EndObject();
  return {"application/problem+json", std::string(text.GetString(), text.GetSize()), status};
}

}  // namespace coppice
