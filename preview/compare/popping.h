// Popping: how much the picture of a cloud changes when a level of detail takes its place.
#pragma once

#include <span>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// The most that a switch to a level may change the picture: the rms of the 8-bit values over the cloud's pixels.
inline constexpr float kMostPopping = 2;

/// The change at a size.
struct SizeChange {
  float pixels = 0;  ///< that the longest side of the full cloud covers
  float rms = 0;     ///< of the 8-bit values of all pixels that show either mesh, on the side where it is largest
};

/// Pictures of a full cloud from four sides and at many sizes, which those of its levels are compared with. The look is that of renderLobe,
/// under one sun: a side is lit from the front, one from behind, and two at an angle.
class Popping {
 public:
  explicit Popping(const BakedMesh& full);
  /// The changes from the largest size to the smallest one.
  std::vector<SizeChange> of(const BakedMesh& level) const;

 private:
  struct Pixels {
    float size;
    size_t side, first, count;  // of `rays_`, in pixels
  };
  std::vector<Vec3> tonesOf(const BakedMesh& mesh, std::vector<bool>& shows) const;

  std::vector<Ray> rays_;
  std::vector<Pixels> pictures_;
  std::vector<Vec3> tones_;
  std::vector<bool> shows_;
};

/// The largest size up to which no change is above `most`, with two digits, rounded down; 0 if there is none. Between two sizes the
/// change is a power of the size.
int switchPixels(std::span<const SizeChange> changes, float most = kMostPopping);

}  // namespace cloudbake
