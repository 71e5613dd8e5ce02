// Whether the values of a glTF have the types of the specification. Only for io/gltf.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "io/gltf/asset_info.h"

namespace cloudbake {

/// Throws InputError with the place of the first value of another type than glTF 2.0 gives it, of the first list of another length, and of
/// the first object without a value that readers need. What extensions and `extras` hold is free, but for the extensions that are read.
void checkValueTypes(const std::filesystem::path& file, const Json& document);

/// A value for a message: 1.5, "text", a list, an object.
std::string valueText(const Json& value);

}  // namespace cloudbake
