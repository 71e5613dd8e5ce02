// The numbers of layers that the page of `view` has beside their settings: the moon's picture and the lattices of dust, packed with the
// vertices.
#pragma once

#include <nlohmann/json.hpp>

#include "io/gltf/asset_info.h"
#include "pipeline/page/packed_mesh.h"
#include "pipeline/scene/scene_file.h"

namespace cloudbake {

/// A picture whose sides are at most `most` pixels, ≥ 1: each pixel is the mean of a square of pixels.
Image shrunkTo(const Image& picture, int most);

/// Packs them, in the order in which viewer/packed_mesh.js takes them. Returns `moon_picture`, width and height, if there is one, and
/// `lattices`, each with its `origin`, `cell_size`, `cells` and the number of `coefficients` of a cell; of several dusts with the same
/// lattice once. Throws UsageError if the lattices are too large for a page.
Json packedLayers(const SceneFile& scene, MeshPacker& packer);

/// The dusts of a scene, for its `lattices`: `lattice`, the number of its own; `to_own`, the way to its space, by columns and the offset;
/// and `extinction`, σ in those of the lattice.
Json dustPlaces(const SceneFile& scene);

}  // namespace cloudbake
