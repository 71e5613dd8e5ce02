// Reads and writes a cluster of spheres as a table of points and radii, to exchange it with Houdini, Blender or Python.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/types.h"

namespace cloudbake {

enum class SphereFormat { kPly, kCsv };

constexpr size_t kMaxSpheres = 10'000'000;

/// The format for the extension, .ply or .csv in any case. Throws UsageError for any other.
SphereFormat sphereFormatOf(const std::filesystem::path& file);

/// The bytes of a file of the spheres. readSpheres returns the same floats, bit by bit.
/// PLY: binary little endian, an element `vertex` with the float properties x, y, z, pscale (the radius).
/// CSV: the line `x,y,z,radius`, then a line per sphere with the fewest digits that read back the same; lines end in "\n".
std::string encodeSpheres(std::span<const Sphere> spheres, SphereFormat format);

/// The spheres of a file, in its order, frame and unit.
///
/// Columns are found by name, in any order and case. If a file has several of these names, the first in the list is used:
///   x, P[x], P[0], Px — and likewise for y and z;
///   radius, pscale, r (a colour if there is also a column g), scale. A `width` is not read: tools disagree on whether it is a diameter.
/// PLY: text or binary, numbers of any type; lists and other elements are ignored.
/// CSV: separated by comma, semicolon or tab; other columns, blank lines and lines that begin with # are ignored. Without a line of
/// names there must be exactly four columns: x, y, z, radius.
/// Guaranteed: 1 to `most` spheres, every centre finite, every radius finite and above 0.
/// Throws IoError if the file cannot be read, InputError with the line (binary: the point, counted from 0) if it is unusable, and
/// UsageError for an unknown extension.
std::vector<Sphere> readSpheres(const std::filesystem::path& file, size_t most = kMaxSpheres);
/// The same from the bytes of `file`, whose name is used for messages and to find the format.
std::vector<Sphere> decodeSpheres(const std::filesystem::path& file, const std::string& bytes, size_t most = kMaxSpheres);

}  // namespace cloudbake
