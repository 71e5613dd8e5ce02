// Parts of a glTF sculpt that several primitives share, taken apart.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/sculpt.h"

namespace cloudbake {

/// The vertices that the triangles use, ascending.
std::vector<uint32_t> usedVertices(std::span<const Triangle> triangles);

/// A part that has only the vertices `kept` (ascending) of another, and triangles of these, which are numbered as in the other.
SculptPart partOf(const SculptPart& part, const std::vector<uint32_t>& kept, std::span<const Triangle> triangles);

/// Where a part comes from.
struct PartSource {
  size_t part = 0;
  std::vector<uint32_t> vertices;  ///< #V numbers of its vertices there
};

/// The sculpt with a part per primitive, for changes of its triangles: where several primitives share a part for which `is_split` is true,
/// each gets a part of the vertices that it uses, in the document too. Other parts stay. Nothing if there is no such part. `sources`, if
/// given, gets a source per part. Throws InputError if an attribute of the document is damaged.
std::optional<Sculpt> withPartPerPrimitive(const Sculpt& sculpt, const std::function<bool(size_t)>& is_split,
                                           std::vector<PartSource>* sources = nullptr);

}  // namespace cloudbake
