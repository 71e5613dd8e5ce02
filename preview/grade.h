// The image pass of the terrain: motion blur, vignette, contrast, gamma. These are pure functions from picture to picture.
#pragma once

#include <span>
#include <vector>

#include "core/image.h"
#include "core/keys.h"
#include "preview/camera.h"
#include "preview/layer.h"

namespace cloudbake {

/// The motion of every pixel on the picture while the shutter was open: x to the right in widths of the picture, y down in heights.
struct Velocities {
  int width = 0, height = 0;
  std::vector<Vec2> pixels;  ///< width·height
};

/// How far the point that a pixel shows has moved since the camera was at `previous`: its place now minus its place then. `distances` has
/// width·height entries ≥ 0; at infinity only the camera's turn moves a point. The result is 0 for points that were behind the previous
/// camera. The same camera twice gives exactly 0. Throws std::invalid_argument for another count of distances, or if the sizes differ.
Velocities cameraVelocity(const Camera& camera, const Camera& previous, std::span<const float> distances);

struct MotionBlurSettings {
  double shutter_seconds = 1.0 / 24;  ///< how long it is open: until now, of the scene's time
  int taps = 32;                      ///< ≥ 1; 1: no blur
  float limit = 0.25F;                ///< velocities are clamped to ±limit per component, ≥ 0
};
/// Its keys in a scene file.
const Keys<MotionBlurSettings>& motionBlurKeys();

/// The mean of the picture at p − v·i/(taps − 1), i = 0 … taps − 1, read bilinearly. The shutter opens now, and points continue their
/// motion, so that each is drawn out along v. In forward flight all taps are inside the picture; beyond the border the outermost pixels are
/// repeated. Where v is 0 the pixel stays exactly the same. Throws std::invalid_argument for velocities of another size.
Image motionBlur(const Image& image, const Velocities& velocities, const MotionBlurSettings& settings = {});

struct VignetteSettings {
  float corner = 0.5F;    ///< factor in the corners, 0 … 1; 1 in the centre
  float exponent = 0.1F;  ///< > 0: small = only the rim darkens
};
/// Its keys in a scene file.
const Keys<VignetteSettings>& vignetteKeys();

/// corner + (1 − corner)·(16 u v (1 − u)(1 − v))^exponent; u and v in [0, 1] across the picture.
float vignetteFactor(float u, float v, const VignetteSettings& settings = {});
Image vignette(const Image& image, const VignetteSettings& settings = {});

struct ContrastSettings {
  float amount = 0.4F;     ///< weight of c²(3 − 2c) against c, 0 … 1
  Vec3 lift{0, 0, 0.04F};  ///< added last
};
/// Its keys in a scene file.
const Keys<ContrastSettings>& contrastKeys();

/// (1 − amount)·c + amount·c²(3 − 2c) + lift per channel. c is display-referred: values above 1 count as 1, below 0 as 0.
Vec3 contrastColor(Vec3 color, const ContrastSettings& settings = {});
Image contrast(const Image& image, const ContrastSettings& settings = {});

/// Linear to display by the square root; below 0 counts as 0.
Image gammaBySqrt(const Image& image);

}  // namespace cloudbake
