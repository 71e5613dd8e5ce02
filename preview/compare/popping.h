// Popping: how much the picture of a cloud changes when a level of detail takes its place.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"
#include "preview/mesh_clouds/lit_mesh.h"

namespace cloudbake {

/// The most that a switch to a level may change the picture: the rms of the 8-bit values over the cloud's pixels.
inline constexpr float kMostPopping = 2;

/// The change at a size.
struct SizeChange {
  float pixels = 0;  ///< that the longest side of the full cloud covers
  float rms = 0;     ///< of the 8-bit values of all pixels that show either mesh, on the side where it is larger
};

/// The pictures of a full cloud, with which those of its levels are compared: of two opposite sides, one lit from the front and one from
/// behind, drawn as by renderLobe.
class Popping {
 public:
  /// `half_lambert`: as in LightSettings, which an impostor of a mesh has been made with.
  explicit Popping(const BakedMesh& full, float half_lambert = LightSettings{}.half_lambert);
  ~Popping();

  /// The changes by a level, from the largest size to the smallest one. The largest size has one ray per pixel, so that it shows the change
  /// that no mean over a pixel makes smaller: that of all sizes above it. An impostor is drawn at each size, up to kLargestOfImpostors.
  std::vector<SizeChange> changesBy(const BakedMesh& level) const;
  static constexpr int kLargestOfImpostors = 256;

 private:
  std::vector<SizeChange> changesByImpostor(const BakedMesh& level) const;
  struct Side;
  float half_lambert_;
  std::vector<Side> sides_;
};

/// Pictures from the same two sides with the same lights at one size, for meshes that are in one box.
class SidePictures {
 public:
  /// `pixels`, a multiple of 32: what the longest side of the box covers.
  SidePictures(const Box& box, int pixels);
  ~SidePictures();

  /// The pixels of both sides: 8-bit values, and whether they show the mesh.
  struct Taken {
    std::vector<std::array<uint8_t, 3>> values;
    std::vector<uint8_t> shows;
  };
  Taken of(const BakedMesh& mesh) const;
  /// The rms of the differences over all pixels that show either mesh.
  static float rmsBetween(const Taken& a, const Taken& b);

 private:
  struct Side;
  std::vector<Side> sides_;
};

/// The largest size up to which no change is above `most`, with two digits, rounded down; 0 if there is none. Between two sizes the
/// change is a power of the size. If it is not above `most` at the largest size, the answer is kLargestSwitch.
int switchPixels(std::span<const SizeChange> changes, float most = kMostPopping);
inline constexpr int kLargestSwitch = 4000;  ///< a cloud that fills the largest screens

/// The change at any size: between two sizes it is a power of the size, beyond the first and the last one it is theirs. No changes: 0.
float changeAt(std::span<const SizeChange> changes, float pixels);

}  // namespace cloudbake
