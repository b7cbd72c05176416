// What people are told of orders: who gave them, and of which robots a sentence is.
#pragma once

#include <string>
#include <vector>

#include "messages/messages.h"

namespace coppice {

/// " by ann".
std::string sender_of(const OrderMessage& order);

/// "r1 VERB REST", or "r1, r2 and 3 more: each VERB REST", with as many names as fit into a reason; empty:
/// there are none.
std::string sentence_of(const std::vector<RobotName>& robots, const char* verb, const char* rest);

/// Who cancels, and why: "cancelled by anna: replaced by order 4f32".
std::string reason_of(const OrderMessage& cancellation);

}  // namespace coppice
