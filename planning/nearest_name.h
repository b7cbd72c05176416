// Guesses the name that was meant by a misspelt one.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace coppice {

/// The name that is the fewest changes away (a letter added, removed, replaced, or swapped with the next), or
/// the only name that begins with the text. Empty if no name is near: at most one change in three letters,
/// but one change is always allowed.
std::string nearest_name(std::string_view misspelt, std::span<const std::string> names);

}  // namespace coppice
