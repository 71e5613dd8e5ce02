// Single files out of a ZIP archive.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace cloudbake {

/// The contents of the file `name` of an archive, stored or deflated. Nothing if there is none, it is damaged or encrypted, packed in
/// another way, or larger than `limit` bytes. Throws std::bad_alloc.
std::optional<std::string> fileInZip(std::string_view zip, std::string_view name, uint64_t limit);

}  // namespace cloudbake
