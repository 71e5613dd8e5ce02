// The one rule about files that another file names: buffers, images, material libraries and textures of a sculpt.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "io/file/read_settings.h"

namespace cloudbake {

constexpr uint64_t kLargestNeighbour = 0xFFFFFFFF;  ///< bytes: a GLB, which has to hold it, has at most 4 GiB

/// Why `file` may not refer to `named`, with the cure: it lies outside the folder of `file` (unless allow_outside), is no regular file (a
/// pipe, a device, a folder), or is larger than kLargestNeighbour. Nothing if it may, and if `named` does not exist. Opens nothing.
std::optional<std::string> refusalOfNeighbour(const std::filesystem::path& file, const std::filesystem::path& named, bool allow_outside);

/// All bytes of `named`. Throws InputError for `file` if it is refused, and IoError if it cannot be read.
std::string readNeighbour(const std::filesystem::path& file, const std::filesystem::path& named, const ReadSettings& settings);

/// The path of a texture or material library as another program has written it, maybe with backslashes, or with an absolute path of
/// another machine: relative to `named_by`, else relative to `file`, else a file of that name in the folder of `file`; the first that
/// exists and may be used. If there is none, the first of the three. `named_by` is the file that has the name, if that is a neighbour of
/// `file`.
std::filesystem::path neighbourNamed(const std::filesystem::path& file, const std::string& written, bool allow_outside,
                                     const std::filesystem::path& named_by = {});

}  // namespace cloudbake
