// What somebody may have meant who misspelt a name.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace coppice {

/// The name that is fewest changes away (a letter more, less, another or swapped with the next), or the only
/// one that begins so; empty if none is near: within one change in three letters.
std::string nearest_name(std::string_view misspelt, std::span<const std::string> names);

}  // namespace coppice
