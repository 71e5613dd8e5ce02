// Reads a sculpt that a test has made.
#pragma once

#include <string>

#include "core/sculpt.h"
#include "core/warnings.h"
#include "io/sculpt/read_mesh.h"
#include "tests/io/io_helpers.h"

namespace cloudbake {

struct ReadSculpt {
  Sculpt sculpt;
  Warnings warnings;
  std::vector<Vec3> positions() const { return surfaceInScene(sculpt).positions; }
};

/// The name chooses the reader.
inline ReadSculpt readBytes(const std::string& name, const std::string& bytes, const ReadSettings& settings = {}) {
  const TestFolder folder;
  ReadSculpt result;
  result.sculpt = readMesh(folder.write(name, bytes), settings, result.warnings);
  return result;
}

struct Corners {
  Vec3 low{1e9F, 1e9F, 1e9F}, high{-1e9F, -1e9F, -1e9F};
};

inline Corners boxOf(const std::vector<Vec3>& points) {
  Corners box;
  for (const Vec3 p : points) {
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
  }
  return box;
}

inline void expectNear(Vec3 is, Vec3 wanted, double tolerance) {
  EXPECT_NEAR(is.x, wanted.x, tolerance);
  EXPECT_NEAR(is.y, wanted.y, tolerance);
  EXPECT_NEAR(is.z, wanted.z, tolerance);
}

}  // namespace cloudbake
