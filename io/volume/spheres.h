// A cluster of spheres as a table of points and radii: to Houdini, Blender or Python, and back from their scatters.
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

/// The format that the extension names, .ply or .csv in any case. Throws UsageError for any other.
SphereFormat sphereFormatOf(const std::filesystem::path& file);

/// A file of the spheres; readSpheres gives the same floats back, bit by bit.
/// PLY: binary little endian, an element `vertex` with the float properties x, y, z, pscale (the radius).
/// CSV: the line `x,y,z,radius`, then a line per sphere with the fewest digits that read back the same, ends of "\n".
std::string encodeSpheres(std::span<const Sphere> spheres, SphereFormat format);

/// The spheres of a file, in its order and its frame and unit.
///
/// Columns are found by name, whatever their order and case; where several names of a line stand in a file, the earlier counts:
///   x, P[x], P[0], Px — and so for y and z;
///   radius, pscale, r (a colour where there is a column g), scale. A `width` is not read: tools disagree on whether it is a diameter.
/// PLY: text or binary, numbers of any type; lists and other elements are passed over.
/// CSV: separated by comma, semicolon or tab; other columns, blank lines and lines that begin with # are passed over. Without a line of
/// names, exactly four columns: x, y, z, radius.
/// Guaranteed: 1 to `most` spheres, every centre finite, every radius finite and above 0.
/// Throws IoError where the file cannot be read, InputError with the line (binary: the point, counted from 0) where it is unusable,
/// UsageError where the extension names no format.
std::vector<Sphere> readSpheres(const std::filesystem::path& file, size_t most = kMaxSpheres);
/// The same from the bytes of `file`, which names them and their format.
std::vector<Sphere> decodeSpheres(const std::filesystem::path& file, const std::string& bytes, size_t most = kMaxSpheres);

}  // namespace cloudbake
