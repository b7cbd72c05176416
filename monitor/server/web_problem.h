// Errors of the HTTP API: problem details (RFC 9457).
#pragma once

#include <string_view>

#include "monitor/server/web_server.h"

namespace coppice {

/// `detail`: what is wrong, and what was expected.
WebReply problem_reply(unsigned status, std::string_view detail);

}  // namespace coppice
