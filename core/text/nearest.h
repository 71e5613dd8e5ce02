// Suggests the name that a user may have meant.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace cloudbake {

/// `, did you mean "…"?` for the candidate nearest to `name`; empty if none is near.
std::string nearestName(std::string_view name, std::span<const std::string> candidates);

}  // namespace cloudbake
