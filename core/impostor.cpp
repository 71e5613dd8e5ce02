#include "core/impostor.h"

#include <algorithm>
#include <cmath>

#include "core/lobe_lighting.h"
#include "core/lobe_packing.h"

namespace cloudbake {

float texelLight(const TexelLobe& texel, Vec3 to_light, float exponent, float extinction) {
  return texel.lit * lobeTransmittance(texel.lobe, to_light, {exponent, 0}, extinction);
}

Impostor blankImpostor(const ImpostorInfo& info) {
  const Image image = blankImage(info.views * info.frame, info.views * info.frame);
  return {info, {image}, {image}};
}

void addMipLevels(Impostor& impostor) {
  for (std::vector<Image>* levels : {&impostor.lobe, &impostor.rest}) {
    levels->resize(1);
    for (int frame = impostor.info.frame; frame % 2 == 0 && frame / 2 >= kLeastFrame; frame /= 2) levels->push_back(halved(levels->back()));
  }
}

BakedMesh boxWithImpostor(Impostor impostor) {
  BakedMesh mesh;
  for (int corner = 0; corner < 8; ++corner) mesh.surface.positions.push_back(impostor.info.box.corner(corner));
  mesh.surface.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                            {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  mesh.lobes.resize(8, {{0, -1, 0}, 0});
  mesh.info.lobe = "fit";
  mesh.info.shape = {impostor.info.exponent, 0};
  mesh.info.extinction = impostor.info.extinction;
  mesh.info.input_hash = impostor.info.level > 0 ? impostor.info.level_of : impostor.info.input_hash;
  mesh.info.level = impostor.info.level;
  mesh.info.switch_pixels = impostor.info.switch_pixels;
  if (impostor.info.gains) mesh.info.volume.emplace();
  mesh.impostor = std::make_shared<const Impostor>(std::move(impostor));
  return mesh;
}

namespace {

// −1 … 1 along both axes.
Vec2 octahedral(Vec3 d) {
  const std::array<double, 2> place = octahedronPlace(d.x, d.y, d.z);
  return {float(place[0]), float(place[1])};
}
Vec3 fromOctahedral(Vec2 at) {
  const std::array<double, 3> point = octahedronPoint(at.x, at.y);
  const Vec3 d{float(point[0]), float(point[1]), float(point[2])};
  return d / length(d);
}

}  // namespace

Vec3 frameDirection(int i, int j, int views) {
  const Vec3 d = fromOctahedral({2 * float(i) / float(views - 1) - 1, 2 * float(j) / float(views - 1) - 1});
  return {d.x, d.z, d.y};
}

std::array<FrameWeight, 3> framesAround(Vec3 to_eye, int views) {
  const Vec2 at = octahedral({to_eye.x, to_eye.z, to_eye.y});
  const auto last = float(views - 1);
  const float x = std::clamp((at.x + 1) / 2 * last, 0.0F, last), y = std::clamp((at.y + 1) / 2 * last, 0.0F, last);
  const int i = std::min(int(x), views - 2), j = std::min(int(y), views - 2);
  const float u = x - float(i), v = y - float(j);
  // A cell is two triangles. Of its diagonals, the one along which the octahedron has an edge's length divides it: the other is √3 as long.
  if ((2 * i + 1 < views - 1) == (2 * j + 1 < views - 1)) {
    if (u + v < 1) return {{{i, j, 1 - u - v}, {i + 1, j, u}, {i, j + 1, v}}};
    return {{{i + 1, j + 1, u + v - 1}, {i + 1, j, 1 - v}, {i, j + 1, 1 - u}}};
  }
  const FrameWeight side = u > v ? FrameWeight{i + 1, j, u - v} : FrameWeight{i, j + 1, v - u};
  return {{{i, j, 1 - std::max(u, v)}, side, {i + 1, j + 1, std::min(u, v)}}};
}

FrameAxes frameAxes(Vec3 to_eye) {
  constexpr float kUpright = 0.9999F;  // beyond it the eye looks straight down or up
  Vec3 right{1, 0, 0};
  if (std::abs(to_eye.y) < kUpright) right = Vec3{to_eye.z, 0, -to_eye.x} / std::sqrt(to_eye.x * to_eye.x + to_eye.z * to_eye.z);
  return {right, cross(to_eye, right), to_eye};
}

Vec2 encodedDirection(Vec3 direction, const FrameAxes& axes) {
  const Vec3 own = inView(axes, direction);
  const Vec2 at = octahedral({own.x, own.y, -own.z});
  return {at.x * 0.5F + 0.5F, at.y * 0.5F + 0.5F};
}

Vec3 decodedDirection(Vec2 encoded, const FrameAxes& axes) {
  const Vec3 d = fromOctahedral({encoded.x * 2 - 1, encoded.y * 2 - 1});
  return axes.right * d.x + axes.up * d.y - axes.to_eye * d.z;
}

}  // namespace cloudbake
