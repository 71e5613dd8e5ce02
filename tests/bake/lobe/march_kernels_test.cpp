#include "bake/lobe/march_kernels.h"

#include <gtest/gtest.h>

#include "bake/field/dense_field.h"
#include "bake/field/level_set.h"
#include "bake/lobe/directions.h"
#include "bake/lobe/sphere_rays.h"
#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/surface.h"
#include "bake/truth/peers.h"
#include "core/level_set_type.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

// Trilinear φ straight from the grid, in double, at positions on a dense field's lattice.
class GridSampler {
 public:
  GridSampler(const LevelSet& level_set, const DenseField& field)
      : accessor_(level_set.grid->vdb->getConstAccessor()), first_(field.first) {}
  float operator()(Vec3 p) const {
    const double at[] = {p.x, p.y, p.z};
    int cell[3];
    double part[3];
    for (size_t a = 0; a < 3; ++a) {
      if (!(std::fabs(at[a]) < 1e6)) return accessor_.getTree()->background();
      cell[a] = int(std::floor(at[a])), part[a] = at[a] - cell[a];
    }
    double sum = 0;
    for (int n = 0; n < 8; ++n) {
      const int i = n & 1, j = n >> 1 & 1, k = n >> 2;
      sum += double(accessor_.getValue({first_[0] + cell[0] + i, first_[1] + cell[1] + j, first_[2] + cell[2] + k})) *
             (i ? part[0] : 1 - part[0]) * (j ? part[1] : 1 - part[1]) * (k ? part[2] : 1 - part[2]);
    }
    return float(sum);
  }

 private:
  openvdb::FloatGrid::ConstAccessor accessor_;
  std::array<int, 3> first_;
};

struct Shape {
  const char* name;
  LevelSet level_set;
};

std::vector<Shape> shapes() {
  Warnings warnings;
  const auto settings = [](int voxels) {
    LevelSetSettings s;
    s.voxels = voxels;
    return s;
  };
  SurfaceMesh inner = ballMesh(0.55F, 4);
  reverse(inner);
  const std::vector<Sphere> cluster{
      {{0, 0, 0}, 1}, {{0.9F, 0.3F, 0}, 0.7F}, {{-0.7F, 0.4F, 0.5F}, 0.6F}, {{1.9F, 0, 0}, 0.05F}, {{0, 4, 0}, 0.3F}};
  return {{"spheres", levelSetFromSpheres(cluster, settings(90), warnings)},
          {"hollow ball", levelSetFromMesh(merged(ballMesh(1, 4), inner), settings(60), warnings)},
          {"coarse torus", levelSetFromMesh(torusMesh(1, 0.3F, 7, 5), settings(45), warnings)},
          {"thin sheet", levelSetFromMesh(boxMesh({-1, -0.03F, -1}, {1, 0.03F, 1}), settings(50), warnings)}};
}

// Rays of every kind about a field, on its lattice; a multiple of 8.
struct Rays {
  std::vector<float> arrays[6];
  size_t count() const { return arrays[0].size(); }
  void add(Vec3 o, Vec3 w) {
    const float values[] = {o.x, o.y, o.z, w.x, w.y, w.z};
    for (size_t n = 0; n < 6; ++n) arrays[n].push_back(values[n]);
  }
  Ray ray(size_t i) const { return {{arrays[0][i], arrays[1][i], arrays[2][i]}, {arrays[3][i], arrays[4][i], arrays[5][i]}}; }
  RayArrays view() const {
    return {{arrays[0].data(), arrays[1].data(), arrays[2].data()}, {arrays[3].data(), arrays[4].data(), arrays[5].data()}, count()};
  }
};

Rays raysAbout(const DenseField& field, const LevelSet& level_set) {
  Rays rays;
  uint64_t state = 7;
  const auto draw = [&] { return float((state = state * 6364136223846793005ULL + 1442695040888963407ULL) >> 40) / 16777216.0F; };
  const auto unit = [&] {
    for (;;)
      if (const Vec3 v{2 * draw() - 1, 2 * draw() - 1, 2 * draw() - 1}; dot(v, v) > 0.01F && dot(v, v) <= 1) return *normalized(v);
  };
  const Vec3 size{float(field.bricks[0] * 8), float(field.bricks[1] * 8), float(field.bricks[2] * 8)};
  const auto inBox = [&] { return Vec3{draw() * size.x, draw() * size.y, draw() * size.z}; };
  const auto onSurface = [&] {
    // The grid's surface, roughly: the nearest of some random points by |φ|.
    const GridSampler phi(level_set, field);
    Vec3 best = inBox();
    for (int n = 0; n < 60; ++n)
      if (const Vec3 p = inBox(); std::fabs(phi(p)) < std::fabs(phi(best))) best = p;
    return best;
  };
  const Vec3 middle = size * 0.5F;
  const Vec3 axes[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}, {0, 0.6F, 0.8F}, {0.6F, 0, -0.8F}};
  for (int n = 0; n < 40; ++n) {
    const Vec3 outside = middle + unit() * (2 * length(size)), inside = inBox();
    rays.add(inside, unit());                                                                   // from anywhere in the box
    rays.add(onSurface(), unit());                                                              // from about the surface
    rays.add(outside, *normalized(inside - outside));                                           // from outside, towards the box
    rays.add(outside, *normalized(outside - inside));                                           // from outside, away from it
    rays.add(inside, axes[n % 8]);                                                              // along axes
    rays.add({std::floor(inside.x), std::floor(inside.y), std::floor(inside.z)}, axes[n % 8]);  // along the lattice's edges
    rays.add({std::floor(inside.x), std::floor(inside.y), std::floor(inside.z)},
             *normalized(Vec3{1, 1, n % 2 ? 1.0F : -1.0F}));             // through its corners
    rays.add({float(n % 2) * size.x, inside.y, inside.z}, axes[n % 8]);  // on the box's face
  }
  return rays;
}

const Quadrature kQuadratures[] = {Quadrature::kCrossing, Quadrature::kMidpoint, Quadrature::kEnd};

}  // namespace

namespace {

// Rays whose march differs from the template of inside_length.h on the grid itself, by up to a step; more is a failure.
struct Agreement {
  size_t rays = 0, a_step_off = 0;
  double worst_rounding_steps = 0;
};
void compareMarch(const Shape& shape, const MarchSettings& settings, Agreement& agreement) {
  const DenseField field = denseFromLevelSet(shape.level_set);
  const Rays rays = raysAbout(field, shape.level_set);
  ASSERT_EQ(rays.count() % 8, 0U);
  const GridSampler phi(shape.level_set, field);
  std::vector<float> lengths(rays.count());
  marchRays(field, rays.view(), settings, lengths.data());
  const float step = settings.length / float(settings.steps);
  for (size_t i = 0; i < rays.count(); ++i) {
    const double truth = insideLength(phi, rays.ray(i), settings), error = std::fabs(lengths[i] - truth);
    ++agreement.rays;
    if (error < 1e-3 * step + 1e-5 * truth) {
      agreement.worst_rounding_steps = std::max(agreement.worst_rounding_steps, error / step);
      continue;
    }
    ++agreement.a_step_off;
    EXPECT_LE(error, 1.001 * step) << shape.name << " ray " << i << ", quadrature " << int(settings.quadrature) << ", " << settings.steps
                                   << " steps of " << step << ": " << lengths[i] << " for " << truth;
  }
}

}  // namespace

// Every ray has the length that reading every sample gives. Rounding may turn a sample that lies on the surface: a step's difference, in
// under one of 1000 rays.
TEST(MarchKernels, AgreesWithEverySample) {
  Agreement agreement;
  for (const Shape& shape : shapes())
    for (const Quadrature quadrature : kQuadratures)
      for (const auto& [steps, ray_length] : {std::pair{1, 6.0F}, std::pair{7, 50.0F}, std::pair{100, 60.0F}, std::pair{100, 500.0F},
                                              std::pair{1000, 500.0F}, std::pair{10, 1e-3F}, std::pair{1000, 3000.0F}})
        compareMarch(shape, {quadrature, steps, ray_length}, agreement);
  std::printf("[figures] march against every sample: %zu rays, %zu a step off, the others within %.1e steps\n", agreement.rays,
              agreement.a_step_off, agreement.worst_rounding_steps);
  EXPECT_LT(double(agreement.a_step_off), 1e-3 * double(agreement.rays));
}

// Steps that are longer than the empty border of the field (8 voxels): the step from the last sample inside the box to the first one beyond
// it may begin inside the cloud, and counts.
TEST(MarchKernels, StepsLongerThanTheBorderAgreeToo) {
  for (const Quadrature quadrature : kQuadratures) {
    Agreement agreement;
    for (const Shape& shape : shapes())
      for (const auto& [steps, ray_length] : {std::pair{1, 30.0F}, std::pair{7, 200.0F}, std::pair{10, 150.0F}, std::pair{100, 10000.0F}})
        compareMarch(shape, {quadrature, steps, ray_length}, agreement);
    EXPECT_LT(double(agreement.a_step_off), 1e-3 * double(agreement.rays)) << int(quadrature) << ": " << agreement.a_step_off;
  }
}

// From the middle of a ball, tangent to it, past it and through it from outside: the chords in closed form.
TEST(MarchKernels, BallInClosedForm) {
  Warnings warnings;
  const LevelSet level_set = levelSetFromSpheres(std::vector<Sphere>{{{0, 0, 0}, 1}}, {}, warnings);
  const DenseField field = denseFromLevelSet(level_set);
  const Vec3 middle{float(-field.first[0]), float(-field.first[1]), float(-field.first[2])};
  const float r = 50;
  Rays rays;
  const double truth[] = {r, 2 * r, 0, 0, 2 * r, 2 * std::sqrt(r * r - 30.0 * 30), 0, 80};
  rays.add(middle, {0, 1, 0});
  rays.add(middle + Vec3{0, 0, r}, {0, 0, -1});
  rays.add(middle + Vec3{0, 0, r}, {0, 0, 1});
  rays.add(middle + Vec3{r + 0.5F, 0, 0}, {0, 1, 0});
  rays.add(middle + Vec3{-1000, 0, 0}, {1, 0, 0});
  rays.add(middle + Vec3{300, 30, 0}, {-1, 0, 0});
  rays.add(middle + Vec3{300, 30, 0}, {1, 0, 0});
  rays.add(middle + Vec3{0, -30, 0}, {0, 1, 0});
  std::vector<float> lengths(8);
  marchRays(field, rays.view(), {Quadrature::kCrossing, 2000, 2000}, lengths.data());
  for (size_t i = 0; i < 8; ++i) EXPECT_NEAR(lengths[i], truth[i], 0.05) << i;
}

// A ray's length does not depend on its neighbours: any order, any number of vectors.
TEST(MarchKernels, RaysAreIndependent) {
  const Shape shape = shapes().front();
  const DenseField field = denseFromLevelSet(shape.level_set);
  const Rays rays = raysAbout(field, shape.level_set);
  const MarchSettings settings{Quadrature::kCrossing, 100, 200};
  std::vector<float> together(rays.count());
  marchRays(field, rays.view(), settings, together.data());
  for (size_t i = 0; i < rays.count(); i += 5) {
    Rays alone;
    for (size_t n = 0; n < 8; ++n) alone.add(rays.ray((i + 37 * n) % rays.count()).origin, rays.ray((i + 37 * n) % rays.count()).direction);
    float lengths[8];
    marchRays(field, alone.view(), settings, lengths);
    for (size_t n = 0; n < 8; ++n) ASSERT_EQ(lengths[n], together[(i + 37 * n) % rays.count()]) << i;
  }
}

// The bake that skips and the plain one that reads every sample of OpenVDB's tree: the same directions within 0.01° (where there is one to
// speak of: κ ≥ 0.1) and densities within 0.1 %.
TEST(MarchKernels, BakeAgreesWithThePlainOne) {
  for (const auto& [name, level_set] : shapes()) {
    Warnings warnings;
    const DenseField field = denseFromLevelSet(level_set);
    const SurfaceMesh mesh = meshFromLevelSet(level_set, {.vertices = 150}, warnings);
    const BakePoints points{mesh.positions, mesh.normals};
    BakeSettings many;
    many.ray_length = boundingBox(mesh).diagonal();
    const auto directions = fibonacciDirections(200);
    const auto lengths = marchedLengths(mesh.positions, directions, field, many);
    const auto concentration = [&](size_t v) { return meanDirection(directions, std::span(lengths).subspan(v * 200, 200)).concentration; };
    for (const Sampler sampler : {Sampler::kStratified, Sampler::kFibonacci, Sampler::kUniform})
      for (const Quadrature quadrature : kQuadratures) {
        BakeSettings settings;
        settings.sampler = sampler;
        settings.quadrature = quadrature;
        settings.ray_length = boundingBox(mesh).diagonal();
        const auto fast = bakeSphereRays(points, field, settings, warnings), plain = plainSphereRays(points, level_set, settings, warnings);
        ASSERT_EQ(fast.size(), plain.size());
        double mean = 0, worst_angle = 0, worst_density = 0;
        for (const Lobe& lobe : plain) mean += double(lobe.thickness) / double(plain.size());
        size_t off = 0;
        for (size_t v = 0; v < fast.size(); ++v) {
          if (concentration(v) < 0.1) continue;
          const double angle = angleDegrees(fast[v].direction, plain[v].direction),
                       density = std::fabs(fast[v].thickness - plain[v].thickness) / mean;
          const bool agrees = angle < 0.01 && density < 1e-3;
          off += !agrees;
          EXPECT_TRUE(agrees || quadrature != Quadrature::kCrossing) << name << ' ' << v << ": " << angle << " deg, " << density;
          worst_angle = std::max(worst_angle, angle), worst_density = std::max(worst_density, density);
        }
        // Counted samples: one on the surface may turn.
        EXPECT_LE(off, fast.size() / 50) << name << ", quadrature " << int(quadrature) << ", worst " << worst_angle << " deg, "
                                         << worst_density;
      }
  }
}
