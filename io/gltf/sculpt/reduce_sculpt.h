// A glTF sculpt with fewer triangles and vertices.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/sculpt.h"
#include "io/gltf/sculpt/part_per_primitive.h"

namespace cloudbake {

/// Whether a part's vertices move by joints or morph targets.
bool isDeformed(const Sculpt& sculpt, size_t part);

/// Per vertex of all parts, the first vertex of its part with the same values of every attribute; itself if something moves the part.
/// Throws InputError if an attribute of a glTF is damaged.
std::vector<uint32_t> firstAlike(const Sculpt& sculpt);

/// The sculpt with other triangles (#parts lists of own vertices) and without the vertices that they leave unused, which keep their order.
/// What remains is unchanged: every attribute of a vertex, nodes, materials, and of glTF the rest of the document. A part with an empty
/// list stays whole; others must have a primitive of their own (withPartPerPrimitive). Throws InputError if an attribute of the document is
/// damaged.
Sculpt withTriangles(const Sculpt& sculpt, std::span<const std::vector<Triangle>> triangles_per_part);

}  // namespace cloudbake
