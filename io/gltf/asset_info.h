// Converts the metadata that an asset records about its bake to JSON and back.
#pragma once

#include <filesystem>
#include <optional>

#include "core/text/json.h"
#include "core/types.h"

namespace cloudbake {

/// The layout of lobe impostors (io/gltf/impostor/impostor_file.h), which are no baked assets.
inline constexpr const char* kImpostorLayout = "lobe-impostor";
/// Whether the metadata of a document say that it is of a layout.
bool isOfLayout(const Json& document, const char* layout);
inline bool isImpostorDocument(const Json& document) { return isOfLayout(document, kImpostorLayout); }
/// Likewise of kSequenceLayout (io/gltf/sequence/sequence_file.h), whose meshes are baked assets only together.
bool isSequenceDocument(const Json& document);

/// A whole number. Throws Json::type_error for any other value; get<int>() would cast 1e39. A number above 2⁶³ wraps.
int64_t wholeNumber(const Json& value);
/// The same for a member of an object; `fallback` if it is missing.
int64_t wholeNumber(const Json& object, const char* key, int64_t fallback);

/// The double that prints as short as the float (0.01, not 0.009999999776482582) and reads back as the same float.
double shortest(float value);

/// The object for `asset.extras.cloudbake` and for reports. Floats are printed in the shortest form that reads back as the same float.
Json writeInfo(const AssetInfo& info);

/// Reads the metadata from the whole document of `file`. Throws InputError if there is none, if it is of another layout, if a value is of
/// another type, or if a number is not finite in 32 bits.
AssetInfo requireInfo(const std::filesystem::path& file, const Json& document);

/// The same; nothing where that throws, but numbers may be infinite.
std::optional<AssetInfo> readInfo(const Json& document);
/// The message of requireInfo; empty if nothing is wrong.
std::string infoFault(const std::filesystem::path& file, const Json& document);
/// Whether there is any metadata, right or wrong.
bool hasInfo(const Json& document);

}  // namespace cloudbake
