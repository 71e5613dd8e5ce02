// The pinhole camera, and the angles that place cameras and suns.
#pragma once

#include <optional>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// World units, +Y up. `look_from` ≠ `look_at`.
struct Camera {
  Vec3 look_from{0, 0, 1}, look_at;
  float vertical_fov_degrees = 35;  ///< 0 < fov < 180, of the whole picture's height
  int width = 960, height = 540;    ///< pixels, at least 1
  float roll_radians = 0;           ///< positive: the camera's top leans to its right, so that the picture's horizon rises on the right
  int first_row = 0;                ///< of the rows that the renderers of layers draw
  std::optional<int> row_count{};   ///< unset: all
  int rows() const { return row_count.value_or(height); }
};

/// The unit direction of an azimuth and an elevation, for cameras and suns alike. Azimuth 0 is +Z, which faces the viewer in glTF's
/// convention, 90 is +X; the elevation counts up from the horizon, 90 is +Y. Multiples of 90 degrees are exact.
Vec3 directionFromAngles(float azimuth_degrees, float elevation_degrees);

/// The unit axes of a camera's picture.
struct CameraAxes {
  Vec3 right, up, forward;
};

/// The axes of a level camera, turned by its roll: right' = right·cos − up·sin, up' = up·cos + right·sin. A camera that looks straight up
/// or down is tilted from azimuth 0: without roll the top of the picture is −Z looking down and +Z looking up.
CameraAxes cameraAxes(const Camera& camera);

/// The ray through a point of the picture: (0, 0) is the upper left corner, (width, height) the lower right one, and the
/// centre of the first pixel is at (0.5, 0.5).
Ray cameraRay(const Camera& camera, float x, float y);

/// The same for many points: what does not depend on the point is computed once.
class CameraRays {
 public:
  explicit CameraRays(const Camera& camera);
  /// The same bits as cameraRay(camera, x, y).
  Ray at(float x, float y) const;

 private:
  Vec3 look_from_;
  CameraAxes axes_;
  float center_x_, center_y_, per_pixel_;
};

/// n·n places in a pixel, 0 … 1, the same in every pixel, each in its own row, column and stratum; the centre for n = 1.
/// `samples_per_side` under 1 counts as 1.
std::vector<Vec2> pixelPlaces(int samples_per_side);

/// A camera that looks at the centre of a box from an azimuth and elevation. It is as near as possible with the whole box in view and 6% of
/// the picture free at each side. A box without size is viewed from afar.
Camera frameCamera(const Box& box, float azimuth_degrees, float elevation_degrees, float fov_degrees, int width, int height);

}  // namespace cloudbake
