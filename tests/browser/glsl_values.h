// What the functions of shaders/functions/ must give, as the programs of tests/browser/ list them.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/random.h"
#include "core/vec3.h"
#include "tests/folders.h"

namespace cloudbake {

using Texel = std::array<float, 4>;

// Draws of one point.
class Draws {
 public:
  explicit Draws(uint32_t point) : point_(point) {}
  float between(float low, float high) { return low + (high - low) * uniformFloat(hashDraw(7, point_, count_++)); }
  Vec3 color() { return {between(0, 1.5F), between(0, 1.5F), between(0, 1.5F)}; }
  Vec3 direction() {
    for (;;) {
      const Vec3 v{between(-1, 1), between(-1, 1), between(-1, 1)};
      if (const auto unit = normalized(v); unit && length(v) < 1) return *unit;
    }
  }

 private:
  uint32_t point_, count_ = 0;
};

struct Point {
  std::vector<Texel> inputs;
  Texel expected{};
};

inline Texel texel(Vec3 v, float w = 0) { return {v.x, v.y, v.z, w}; }

/// A function of a GLSL file, and other files that it needs, which come first. `call` has its inputs in p[0], p[1], …; a found value may be
/// off by `absolute` and by `relative` times what is expected. `wrong` is a call with a mistake, which must be told from the right one at
/// half of the points.
struct Function {
  std::string file, name, call, wrong;
  double absolute, relative;
  std::function<Point(Draws&)> point;
  std::vector<std::string> uses{};
  std::string prelude{};  ///< GLSL after the files, such as a function that returns settings
  uint32_t points = 4000;
};

/// Points of a function that is cheap, and of one that marches, which takes the C++ most of the test's time.
inline constexpr uint32_t kManyPoints = 100000;
inline uint32_t marchedPoints() { return runsWhole() ? kManyPoints : kManyPoints / 4; }

std::vector<Function> sequenceFunctions(), terrainFunctions(), cloudFunctions(), nightFunctions(), gradeFunctions();

}  // namespace cloudbake
