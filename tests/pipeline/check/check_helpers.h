// Assets whose lobes are known in closed form, as files for `check`.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "core/random.h"
#include "io/file/write_file.h"
#include "io/gltf/asset/write.h"
#include "pipeline/check/report.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {

/// A mesh, its lobes and its metadata.
struct TestAsset {
  SurfaceMesh mesh;
  std::vector<Lobe> lobes;
  AssetInfo info;
};

/// The metadata of a bake of this mesh at default settings.
inline AssetInfo infoFor(const SurfaceMesh& mesh) {
  const Box box = boundingBox(mesh);
  AssetInfo info;
  info.extinction = 7 / box.longestSide();
  info.shape = {3, -0.003F * box.longestSide()};
  info.rays = 256;
  info.field = "coverage";
  info.sampler = "sobol";
  info.ray_length = box.diagonal();
  info.voxel_size = box.longestSide() / 100;
  return info;
}

/// A ball with the lobes that its vertices must carry.
inline TestAsset ballAsset(float radius = 1, int subdivisions = 2, Vec3 center = {}) {
  TestAsset asset;
  asset.mesh = ballMesh(radius, subdivisions, center);
  for (const Vec3& p : asset.mesh.positions) asset.lobes.push_back(ballLobe(p, center, radius));
  asset.info = infoFor(asset.mesh);
  return asset;
}

/// The ball after `change` of every lobe.
template <typename Change>
TestAsset changedBall(const Change& change) {
  TestAsset asset = ballAsset();
  for (size_t v = 0; v < asset.lobes.size(); ++v) asset.lobes[v] = change(asset.lobes[v], v);
  return asset;
}

/// The ball with every direction turned by this angle, each about another axis.
inline TestAsset tilted(double degrees) {
  return changedBall([&](Lobe lobe, size_t v) {
    const auto a = float(2 * kPi) * uniformFloat(hashDraw(3, uint32_t(v), 0));
    const Frame frame = frameAround(lobe.direction);
    const Vec3 across = frame.tangent * std::cos(a) + frame.bitangent * std::sin(a);
    return Lobe{*normalized(lobe.direction + across * float(std::tan(degrees * kPi / 180))), lobe.thickness};
  });
}

/// The assets as one GLB, each an object of its own. The metadata is that of the first one.
inline std::string glbOf(const std::vector<TestAsset>& assets, const std::vector<SculptMaterial>& materials = {}) {
  Sculpt sculpt;
  std::vector<std::vector<Lobe>> lobes;
  for (const TestAsset& asset : assets) {
    sculpt.parts.push_back(partOf(asset.mesh, "part" + std::to_string(lobes.size()), int(lobes.size())));
    lobes.push_back(asset.lobes);
  }
  sculpt.materials = materials;
  if (!materials.empty()) sculpt.parts[0].material = 0;
  Warnings warnings;
  GltfSettings settings;
  settings.keep_alive_texture = KeepAliveTexture::kOff;
  return encodeGlb(sculpt, lobes, assets[0].info, settings, warnings);
}
inline std::string glbOf(const TestAsset& asset) { return glbOf(std::vector<TestAsset>{asset}); }

/// The bytes with each `from` replaced by `to`, which is as long, so that the lengths in the GLB stay right.
inline std::string replaced(std::string bytes, const std::string& from, const std::string& to) {
  if (from.size() != to.size() || bytes.find(from) == std::string::npos) throw std::invalid_argument("cannot replace " + from);
  for (size_t at = bytes.find(from); at != std::string::npos; at = bytes.find(from, at + to.size())) bytes.replace(at, from.size(), to);
  return bytes;
}

/// The two UV sets under each other's names.
inline std::string withSwappedSets(const std::string& glb) {
  return replaced(replaced(replaced(glb, "TEXCOORD_0", "TEXCOORD_x"), "TEXCOORD_1", "TEXCOORD_0"), "TEXCOORD_x", "TEXCOORD_1");
}
/// Without any UV set.
inline std::string withoutSets(const std::string& glb) {
  return replaced(replaced(glb, "TEXCOORD_0", "_EXCOORD_0"), "TEXCOORD_1", "_EXCOORD_1");
}

/// The verdict in two words: its cause, and what is wrong.
inline std::string causeOf(const CheckReport& report) { return report.verdict ? report.verdict->cause : "sound"; }
inline std::string whatOf(const CheckReport& report) { return report.verdict ? report.verdict->what : ""; }

}  // namespace cloudbake
