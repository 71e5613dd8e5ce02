// The picture of the shadow that a cloud casts under a sun, for decals and light cookies of engines (`cloudbake shadow`).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/memory_budget.h"
#include "core/types.h"
#include "pipeline/options/settings.h"
#include "pipeline/picture/scene_picture.h"
#include "preview/mesh_clouds/shadow_frame.h"

namespace cloudbake {

/// The shares of the light that come through a cloud, seen from the sun.
struct ShadowPicture {
  ShadowFrame frame;
  float extinction = 0;  ///< σ per world unit
  int size = 0;          ///< pixels to a side
  /// exp(−σ ℓ) as means over the pixels, 0 … 1, row by row from the top. ℓ is the length inside of the cloud along the light. The outermost
  /// pixels are 1, so that a sampler that repeats them has no shadow outside.
  std::vector<float> transmittance;
};

/// Draws it from the same field as the shadows of scenes, with cells of about the size of the pixels. `size` ≥ 6; the extinction is that of
/// the asset if none is given. Throws InputError, without a file, if the mesh encloses nothing.
ShadowPicture drawShadow(const BakedMesh& mesh, Vec3 to_sun, int size, std::optional<float> extinction,
                         uint64_t memory_limit = kMemoryLimit);

/// The same of the light and with the size that settings give.
ShadowPicture drawShadow(const BakedMesh& mesh, const Settings& settings);

/// The shadow of all mesh clouds of a scene at its view's time, under its key light, on what is below all of them, by the grid of the scene
/// or by a shadow of each, as its [light] says. The extinction is 0, because each cloud has its own. Throws InputError, without a file, if
/// no cloud of it casts a shadow.
ShadowPicture drawShadow(const Scenery& scenery, const ShadowPictureSettings& settings);

/// A grey PNG with 8 bits per pixel, whose values are linear, and its frame as JSON, schema "cloudbake-shadow-1", which the PNG has as the
/// text of this keyword too. The values are 255 times the transmittance.
inline constexpr const char* kShadowKeyword = "cloudbake-shadow";
struct ShadowFiles {
  std::string png, frame;
};
ShadowFiles encodeShadow(const ShadowPicture& picture);

/// The file of the frame beside a picture: NAME.json of NAME.png.
std::filesystem::path shadowFrameFile(const std::filesystem::path& picture);

}  // namespace cloudbake
