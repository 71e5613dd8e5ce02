// What stages will take: what is told of them, and that it grows with what makes them long.
#include "pipeline/fields/work.h"

#include <gtest/gtest.h>

#include <vector>

#include "pipeline/fields/stopwatch.h"
#include "pipeline/options/settings.h"

namespace cloudbake {
namespace {

std::vector<Sphere> rowOfSpheres(int count) {
  std::vector<Sphere> spheres;
  for (int i = 0; i < count; ++i) spheres.push_back({{float(i), 0, 0}, 1});
  return spheres;
}

TEST(Work, OfALevelSetGrowsWithVoxelsAndBlend) {
  const std::vector<Sphere> spheres = rowOfSpheres(100);
  FieldSettings coarse, fine, blended;
  coarse.voxels = 200, fine.voxels = 3000, blended.voxels = 200;
  blended.blend = {0.5F, true};
  const StageWork quick = levelSetWork(spheres, coarse), slow = levelSetWork(spheres, fine), wide = levelSetWork(spheres, blended);
  EXPECT_EQ(slow.what, "the level set of 3000 voxels along the longest side");
  EXPECT_GT(slow.processor_seconds, 100 * quick.processor_seconds);
  EXPECT_GT(slow.bytes, 100 * quick.bytes);
  EXPECT_GT(wide.processor_seconds, 2 * quick.processor_seconds);
  coarse.voxel_size = 101.0F / 3000;
  EXPECT_EQ(levelSetWork(spheres, coarse).what, slow.what) << "a voxel size counts before a number of voxels";
}

TEST(Work, OfARemeshAndOfASweep) {
  EXPECT_EQ(remeshWork(2.5e6).what, "a mesh of about 2500000 triangles");
  EXPECT_DOUBLE_EQ(remeshWork(2e6).processor_seconds, 2 * remeshWork(1e6).processor_seconds);
  const Box box{{0, 0, 0}, {1, 1, 1}};
  const StageWork sweep = sweepWork(box, 0.01, 100, 1000);
  EXPECT_EQ(sweep.what, "a sweep of 100 directions over 1124864 cells");
  EXPECT_GT(sweepWork(box, 0.01, 1000, 1000).processor_seconds, 9 * sweep.processor_seconds);
  EXPECT_GT(sweepWork(box, 0.005, 100, 1000).bytes, 7 * sweep.bytes);
}

TEST(Work, IsAnnouncedToWhoeverAsks) {
  std::vector<std::string> told;
  const Stopwatch watch({}, [&](const StageWork& work) { told.push_back(work.what); });
  watch.announce(remeshWork(7));
  EXPECT_EQ(told, std::vector<std::string>{"a mesh of about 7 triangles"});
  Stopwatch().announce(remeshWork(7));
}

}  // namespace
}  // namespace cloudbake
