// What an asset records of its bake, as JSON and back.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "core/types.h"

namespace cloudbake {

using Json = nlohmann::ordered_json;  ///< keeps the order of keys

/// The object that stands in `asset.extras.cloudbake` and in reports. A float prints as short as it reads back to the same float.
Json writeInfo(const AssetInfo& info);

/// From a whole glTF document; nothing where it carries none, or one of another layout.
std::optional<AssetInfo> readInfo(const Json& document);

}  // namespace cloudbake
