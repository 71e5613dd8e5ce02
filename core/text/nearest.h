// The name that somebody may have meant.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace cloudbake {

/// `, did you mean "…"?` for the candidate nearest to `name`; empty where nothing is near.
std::string nearestName(std::string_view name, std::span<const std::string> candidates);

}  // namespace cloudbake
