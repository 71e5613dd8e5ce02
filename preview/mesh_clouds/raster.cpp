// M. Olano, T. Greer, "Triangle Scan Conversion using 2D Homogeneous Coordinates" (1997). In the space (X, Y, W) of homogeneous pixel
// coordinates a triangle has the edges N_i = V_j × V_k, and the pixel place p = (x, y, 1) sees it where every e_i = N_i·p has the sign of
// det = V_0·N_0. There the weights of the corners are e_i / Σe, correct in perspective, and the depth is W = det / Σe. Nothing is clipped:
// a triangle that reaches behind the camera is right as it is. N_i of a shared edge is exactly the negative in the other triangle, so that
// no sample falls between the two.
#include "preview/mesh_clouds/raster.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <vector>

#include "core/parallel.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

constexpr int kSamples = 16;  // of a pixel, at pixelPlaces(4)
constexpr int kTileWidth = 64, kTileHeight = 32;
constexpr uint32_t kNone = 0xffffffffU;

using Lanes = std::array<float, kSamples>;

struct Homogeneous {
  double x, y, w;
};

/// e(x, y) = a·x + b·y + c
struct Edge {
  double a, b, c;
  double at(double x, double y) const { return a * x + b * y + c; }
};

/// A triangle in the picture.
struct Face {
  std::array<Edge, 3> edges;     // ≥ 0 inside, opposite to each corner
  double per_depth;              // 1/W = Σe · per_depth
  float farthest, nearest;       // limits of 1/W
  int left, top, right, bottom;  // the pixels that it may cover, `right` and `bottom` included
  uint32_t triangle;
};

Edge edgeBetween(const Homogeneous& v, const Homogeneous& w) {
  return {v.y * w.w - v.w * w.y, v.w * w.x - v.x * w.w, v.x * w.y - v.y * w.x};
}

// Limits a place to the pixels 0 … last.
int pixelOf(double place, int last) { return place < 0 ? 0 : place > last ? last : int(place); }

std::optional<Face> faceOf(const std::array<Homogeneous, 3>& v, uint32_t triangle, int width, int height) {
  Face face{
      {edgeBetween(v[1], v[2]), edgeBetween(v[2], v[0]), edgeBetween(v[0], v[1])}, 0, 0, INFINITY, 0, 0, width - 1, height - 1, triangle};
  double determinant = v[0].x * face.edges[0].a + v[0].y * face.edges[0].b + v[0].w * face.edges[0].c;
  if (determinant < 0) {
    for (Edge& e : face.edges) e = {-e.a, -e.b, -e.c};
    determinant = -determinant;
  }
  face.per_depth = 1 / determinant;
  if (!std::isfinite(face.per_depth)) return std::nullopt;
  const auto [nearest, farthest] = std::minmax({v[0].w, v[1].w, v[2].w});
  if (!(farthest > 0)) return std::nullopt;
  if (nearest > 0) {
    const auto [left, right] = std::minmax({v[0].x / v[0].w, v[1].x / v[1].w, v[2].x / v[2].w});
    const auto [top, bottom] = std::minmax({v[0].y / v[0].w, v[1].y / v[1].w, v[2].y / v[2].w});
    if (!(right >= 0 && bottom >= 0 && left <= width && top <= height)) return std::nullopt;
    face.left = pixelOf(left, width - 1), face.right = pixelOf(right, width - 1);
    face.top = pixelOf(top, height - 1), face.bottom = pixelOf(bottom, height - 1);
    face.farthest = float(1 / farthest), face.nearest = float(1 / nearest);  // rounding at slivers stays between the corners
  }
  return face;
}

std::vector<Face> facesOf(const LitMesh& lit, const Camera& camera) {
  const CameraAxes axes = cameraAxes(camera);
  const Vec3 from = lit.toFrame(camera.look_from);
  const double pixels =
      0.5 * camera.height / std::tan(double(camera.vertical_fov_degrees) * kPi / 360);  // that a width of 1 has at distance 1
  const double center_x = 0.5 * camera.width, center_y = 0.5 * camera.height;
  std::vector<Homogeneous> places(lit.positions.size());
  const auto along = [](Vec3 axis, double x, double y, double z) { return axis.x * x + axis.y * y + axis.z * z; };
  parallelFor(places.size(), [&](size_t v) {
    const Vec3& p = lit.positions[v];
    const double x = double(p.x) - from.x, y = double(p.y) - from.y, z = double(p.z) - from.z, w = along(axes.forward, x, y, z);
    places[v] = {center_x * w + pixels * along(axes.right, x, y, z), center_y * w - pixels * along(axes.up, x, y, z), w};
  });
  constexpr size_t kTogether = 1 << 16;  // triangles of a group
  std::vector<std::vector<Face>> groups((lit.triangles.size() + kTogether - 1) / kTogether);
  parallelFor(groups.size(), [&](size_t g) {
    for (size_t t = g * kTogether; t < std::min((g + 1) * kTogether, lit.triangles.size()); ++t) {
      const auto& [a, b, c] = lit.triangles[t];
      if (const auto face = faceOf({places[a], places[b], places[c]}, uint32_t(t), camera.width, camera.height)) groups[g].push_back(*face);
    }
  });
  std::vector<Face> faces;
  for (std::vector<Face>& group : groups) {
    faces.insert(faces.end(), group.begin(), group.end());
    group = {};
  }
  return faces;
}

// Places of the samples in a pixel.
struct Places {
  Lanes x, y;
  Places() {
    const std::vector<Vec2> places = pixelPlaces(4);
    for (size_t i = 0; i < kSamples; ++i) x[i] = places[i].x, y[i] = places[i].y;
  }
};

// The samples for which it is true, as bits.
template <typename Predicate>
uint32_t samplesWhere(const Predicate& is_true) {
  uint32_t bits = 0;
  for (size_t i = 0; i < kSamples; ++i) bits |= is_true(i) ? 1U << i : 0U;
  return bits;
}

/// What the samples of a pixel see.
struct Seen {
  Lanes inverse_depth{};  // 0: nothing
  std::array<uint32_t, kSamples> face;
};

class Tile {
 public:
  Tile(int left, int top, int right, int bottom)
      : left_(left), top_(top), right_(right), bottom_(bottom), pixels_(size_t(right - left) * size_t(bottom - top)) {}

  void draw(const Face& face, uint32_t index, const Places& places) {
    std::array<Lanes, 3> offsets;
    std::array<float, 3> most;
    for (size_t e = 0; e < 3; ++e) {
      for (size_t i = 0; i < kSamples; ++i) offsets[e][i] = float(face.edges[e].a) * places.x[i] + float(face.edges[e].b) * places.y[i];
      most[e] = *std::max_element(offsets[e].begin(), offsets[e].end());
    }
    const auto per_depth = float(face.per_depth);
    for (int y = std::max(face.top, top_); y <= std::min(face.bottom, bottom_ - 1); ++y)
      for (int x = std::max(face.left, left_); x <= std::min(face.right, right_ - 1); ++x) {
        const std::array<float, 3> corner{float(face.edges[0].at(x, y)), float(face.edges[1].at(x, y)), float(face.edges[2].at(x, y))};
        if (corner[0] + most[0] < 0 || corner[1] + most[1] < 0 || corner[2] + most[2] < 0) continue;
        Seen& seen = pixels_[size_t(y - top_) * size_t(right_ - left_) + size_t(x - left_)];
        for (size_t i = 0; i < kSamples; ++i) {
          const float first = corner[0] + offsets[0][i], second = corner[1] + offsets[1][i], third = corner[2] + offsets[2][i];
          const float inverse = std::min(std::max((first + second + third) * per_depth, face.farthest), face.nearest);
          const bool wins = (first >= 0) & (second >= 0) & (third >= 0) & (inverse > seen.inverse_depth[i]);
          seen.inverse_depth[i] = wins ? inverse : seen.inverse_depth[i];
          seen.face[i] = wins ? index : seen.face[i];
        }
      }
  }

  const Seen& at(int x, int y) const { return pixels_[size_t(y - top_) * size_t(right_ - left_) + size_t(x - left_)]; }

 private:
  int left_, top_, right_, bottom_;
  std::vector<Seen> pixels_;
};

/// What is drawn, for all tiles.
struct Drawing {
  const LitMesh& lit;
  const DepthRange& range;
  const std::vector<Face>& faces;
  const Places places;

  // The channels of a face at a place of the picture. `inverse_depth` is 1/W there.
  Rgba channelsOf(const Face& face, double x, double y, float inverse_depth) const {
    const double p = face.edges[0].at(x, y), q = face.edges[1].at(x, y), r = face.edges[2].at(x, y);
    const auto second = float(q / (p + q + r)), third = float(r / (p + q + r));
    const auto& [a, b, c] = lit.triangles[face.triangle];
    const Shade &sa = lit.shades[a], &sb = lit.shades[b], &sc = lit.shades[c];
    return {sa.sun + second * (sb.sun - sa.sun) + third * (sc.sun - sa.sun),
            sa.sky + second * (sb.sky - sa.sky) + third * (sc.sky - sa.sky), 1,
            std::max(0.0F, (lit.size / inverse_depth - range.near) / (range.far - range.near))};
  }

  // The mean over the samples of a pixel. Those that see one face are taken together, at their centre.
  Rgba meanOf(const Seen& seen, int x, int y) const {
    uint32_t left = samplesWhere([&](size_t i) { return seen.inverse_depth[i] > 0; });
    if (left == 0) return kNoCloud;
    ChannelSum sum(ChannelMean::kCovered);
    sum.add(kNoCloud, float(kSamples - std::popcount(left)));
    while (left != 0) {
      const uint32_t face = seen.face[size_t(std::countr_zero(left))];
      const uint32_t together = left & samplesWhere([&](size_t i) { return seen.face[i] == face; });
      float at_x = 0, at_y = 0, inverse_depth = 0;
      for (uint32_t rest = together; rest != 0; rest &= rest - 1) {
        const auto i = size_t(std::countr_zero(rest));
        at_x += places.x[i], at_y += places.y[i], inverse_depth += seen.inverse_depth[i];
      }
      const auto count = float(std::popcount(together));
      sum.add(channelsOf(faces[face], x + double(at_x / count), y + double(at_y / count), inverse_depth / count), count);
      left &= ~together;
    }
    return sum.value();
  }
};

}  // namespace

Image4 rasterChannels(const LitMesh& lit, const Camera& camera, const DepthRange& range) {
  const std::vector<Face> faces = facesOf(lit, camera);
  const Drawing drawing{lit, range, faces, {}};
  const int across = (camera.width + kTileWidth - 1) / kTileWidth, down = (camera.height + kTileHeight - 1) / kTileHeight;
  std::vector<std::vector<uint32_t>> of_tile(size_t(across) * size_t(down));
  for (uint32_t i = 0; i < faces.size(); ++i)
    for (int row = faces[i].top / kTileHeight; row <= faces[i].bottom / kTileHeight; ++row)
      for (int column = faces[i].left / kTileWidth; column <= faces[i].right / kTileWidth; ++column)
        of_tile[size_t(row) * size_t(across) + size_t(column)].push_back(i);

  Image4 image = filledImage4(camera.width, camera.height, kNoCloud);
  parallelFor(of_tile.size(), [&](size_t t) {
    if (of_tile[t].empty()) return;
    const int left = int(t) % across * kTileWidth, top = int(t) / across * kTileHeight;
    const int right = std::min(left + kTileWidth, camera.width), bottom = std::min(top + kTileHeight, camera.height);
    Tile tile(left, top, right, bottom);
    for (const uint32_t i : of_tile[t]) tile.draw(faces[i], i, drawing.places);
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x) image.at(x, y) = drawing.meanOf(tile.at(x, y), x, y);
  });
  return image;
}

}  // namespace cloudbake
