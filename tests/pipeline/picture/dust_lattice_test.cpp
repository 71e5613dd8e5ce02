// Dust that a lattice of harmonics lights, against exact chords: through a ball in closed form, and through a grown cloud.
#include <cmath>

#include "bake/lobe/directions.h"
#include "bake/lobe/harmonics.h"
#include "bake/truth/reference.h"
#include "core/harmonic_lattice.h"
#include "core/harmonics.h"
#include "pipeline/fields/fields.h"
#include "pipeline/lobes/lobes.h"
#include "pipeline/lobes/parameters.h"
#include "pipeline/picture/picture.h"
#include "pipeline/picture/scene_picture.h"
#include "preview/backdrop/dust.h"
#include "tests/pipeline/picture_helpers.h"
#include "tests/pipeline/pipeline_helpers.h"

namespace cloudbake {
namespace {

constexpr float kSigma = 2;

// Through a ball of radius 1.
float throughBall(Vec3 p, Vec3 l) {
  const double b = dot(p, l), c = double(dot(p, p)) - 1, root = b * b - c;
  if (root <= 0) return 1;
  const double enter = -b - std::sqrt(root), leave = -b + std::sqrt(root);
  return float(std::exp(-kSigma * (std::max(0.0, leave) - std::max(0.0, enter))));
}

HarmonicLattice ballLattice(int order, int cells) {
  HarmonicLattice lattice;
  lattice.order = order;
  lattice.extinction = kSigma;
  lattice.cell_size = 2.0F / float(cells);
  lattice.cells = {cells + 2, cells + 2, cells + 2};
  const float low = -1 - lattice.cell_size / 2;
  lattice.origin = {low, low, low};
  const std::vector<Vec3> directions = fibonacciDirections(300);
  std::vector<float> values;
  for (int k = 0; k < cells + 2; ++k)
    for (int j = 0; j < cells + 2; ++j)
      for (int i = 0; i < cells + 2; ++i)
        for (const Vec3& l : directions)
          values.push_back(throughBall(lattice.origin + Vec3{float(i), float(j), float(k)} * lattice.cell_size, l));
  lattice.coefficients = fitHarmonics(directions, values, order);
  return lattice;
}

// The rms of the light that dust shows through a lattice from that by exact chords, in shares of the light where nothing is in the way; and
// that of dust in full light.
struct Errors {
  double by_lattice, in_full_light;
};
Errors errorsOf(const Box& box, const LightAt& by_lattice, const LightAt& exact) {
  const Camera camera = frameCamera({box.center() - box.size(), box.center() + box.size()}, 20, 10, 40, 64, 48);
  SkySettings sky;
  sky.to_sun = directionFromAngles(70, 40);
  const DustSettings settings{.reach = 2.5F, .thickness = 0.3F, .asymmetry = 0, .ambient = 0.5F, .samples = 40, .dither = 0};
  const auto draw = [&](const LightAt& light) { return renderDust(camera, sky, box, {}, settings, light).front(); };
  const Layer truth = draw(exact), found = draw(by_lattice), full = draw([](Vec3, Vec3) { return 1.0F; });
  const Vec3 most = sky.colors.sun_color + sky.colors.ambient_sky * 0.5F;
  double lattice = 0, without = 0;
  int count = 0;
  for (size_t i = 0; i < truth.pixels.size(); ++i) {
    if (!(truth.pixels[i].opacity > 0)) continue;
    const Vec3 off = found.pixels[i].color - truth.pixels[i].color, plain = full.pixels[i].color - truth.pixels[i].color;
    lattice += dot(off, off) / dot(most, most), without += dot(plain, plain) / dot(most, most);
    ++count;
  }
  EXPECT_GT(count, 500);
  return {std::sqrt(lattice / count), std::sqrt(without / count)};
}

// More bands come nearer to the truth. Without the lattice, in full light, the dust is off by more.
TEST(Dust, LitByALatticeInABall) {
  std::vector<Errors> found;
  for (const int order : {1, 2, 3}) {
    const HarmonicLattice lattice = ballLattice(order, 12);
    found.push_back(errorsOf(
        {{-1, -1, -1}, {1, 1, 1}}, [&](Vec3 p, Vec3 l) { return latticeTransmittance(lattice, p, l); }, throughBall));
  }
  std::printf("dust in and around a ball, rms of its light from exact chords: bands 1, 2, 3: %.3f %.3f %.3f, in full light %.3f\n",
              found[0].by_lattice, found[1].by_lattice, found[2].by_lattice, found[0].in_full_light);
  EXPECT_LT(found[2].by_lattice, found[1].by_lattice);
  EXPECT_LT(found[1].by_lattice, found[0].by_lattice);
  EXPECT_LT(found[0].by_lattice, 0.6 * found[0].in_full_light);
  EXPECT_LT(found[2].by_lattice, 0.03);
}

// A cloud of a preset, as `grow --basis --lattice` bakes it, against all hits of its mesh.
TEST(Dust, LitByALatticeInACloud) {
  BakeReport report;
  const BakedMesh baked = bakedMesh(sourceOf(SourceKind::kPreset, "congestus"), options({"vertices=3000", "voxels=50"}, kGrow), report);
  const Cloud cloud = cloudOf(baked.surface);
  const std::unique_ptr<Reference> reference = meshReference(baked.surface);
  const Box box = boundingBox(baked.surface);
  double last = 1;
  for (const std::string basis : {"sh1", "sh2", "sh3"}) {
    const Settings settings = settingsFor({"basis=" + basis, "lattice-cells=16"});
    const BakeParameters parameters = parametersFor(cloud, settings);
    Warnings warnings;
    const IntegrationField field = buildField(cloud, settings.field, parameters.bake.method, warnings);
    SceneDust dust;
    dust.lattice = std::make_shared<const HarmonicLattice>(bakeLattice(cloud, field, settings.lobe, parameters));
    const auto exact = [&](Vec3 p, Vec3 l) { return std::exp(-parameters.extinction * float(reference->insideLength({p, l}, INFINITY))); };
    const Errors errors = errorsOf(box, lightThrough(dust, std::nullopt), exact);
    std::printf("dust in and around congestus, %s, 16 cells: rms of its light from exact chords %.3f, in full light %.3f\n", basis.c_str(),
                errors.by_lattice, errors.in_full_light);
    EXPECT_LT(errors.by_lattice, last);
    last = errors.by_lattice;
    EXPECT_LT(errors.by_lattice, 0.5 * errors.in_full_light);
  }
  EXPECT_LT(last, 0.04);
}

// A lattice that is placed with its cloud: a copy twice as large lets through the same at places twice as far, because σ shrinks with it;
// under a σ for all clouds it is thicker. A stretched one is thicker along its length.
TEST(Dust, ItsLatticeIsPlacedWithIt) {
  const auto lattice = std::make_shared<const HarmonicLattice>(ballLattice(3, 12));
  const auto lightOf = [&](const Affine& to_world, std::optional<float> extinction = {}) {
    return [dust = SceneDust{{}, lattice, to_world, {}}, extinction](Vec3 p, Vec3 l) { return lightThrough(dust, extinction)(p, l); };
  };
  const Vec3 p{0.3F, -0.6F, 0.2F}, l = *normalized(Vec3{0.2F, 1, -0.3F}), offset{5, -7, 2};
  const float plain = lightOf({})(p, l);
  EXPECT_NEAR(plain, latticeTransmittance(*lattice, p, l), 1e-5);
  EXPECT_NEAR(lightOf(placement(offset, {}, {2, 2, 2}))(offset + p * 2, l), plain, 1e-4);
  EXPECT_NEAR(lightOf(placement(offset, {}, {2, 2, 2}), kSigma)(offset + p * 2, l), plain * plain, 1e-3);
  EXPECT_NEAR(lightOf(placement(offset, {0, 90, 0}, {1, 1, 1}))(offset + Vec3{p.z, p.y, -p.x}, {l.z, l.y, -l.x}), plain, 1e-4);
  // Along the stretched axis the way through the cloud is four times as long.
  const LightAt stretched = lightOf(placement({}, {}, {1, 4, 1}), 0.3F);
  EXPECT_NEAR(stretched({0.9F, -5, 0}, {0, 1, 0}), std::pow(latticeTransmittance(*lattice, {0.9F, -1.25F, 0}, {0, 1, 0}), 0.3 * 4 / kSigma),
              1e-4);
  EXPECT_NEAR(stretched({-5, 3.6F, 0}, {1, 0, 0}), std::pow(latticeTransmittance(*lattice, {-5, 0.9F, 0}, {1, 0, 0}), 0.3 / kSigma), 1e-4);
}

}  // namespace
}  // namespace cloudbake
