// A point is inside where it is on the same side of the three edges (Pineda, "A parallel algorithm for polygon rasterization", SIGGRAPH
// 1988). Both triangles of an edge compute its side from the same end, so that no point is between them.
#include "preview/mesh_clouds/pixel_triangles.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/portable_math.h"

namespace cloudbake {

std::optional<PixelTriangles> PixelTriangles::of(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                                 const Camera& camera) {
  PixelTriangles found;
  found.width_ = camera.width;
  found.triangles_ = triangles;
  found.rows_.resize(size_t(camera.height));
  const CameraAxes axes = cameraAxes(camera);
  const double per_pixel = 2 * tanDegrees(double(camera.vertical_fov_degrees) / 2) / camera.height;
  for (const Vec3& position : positions) {
    const Vec3 from = position - camera.look_from;
    const double depth = dot(from, axes.forward) * per_pixel;
    if (!(depth > 0)) return std::nullopt;
    found.places_.push_back({camera.width / 2.0 + dot(from, axes.right) / depth, camera.height / 2.0 - dot(from, axes.up) / depth});
  }
  const auto pixelAt = [](double place, int count) { return int(std::clamp(place, 0.0, double(count - 1))); };
  for (uint32_t i = 0; i < triangles.size(); ++i) {
    const Place &a = found.places_[triangles[i][0]], &b = found.places_[triangles[i][1]], &c = found.places_[triangles[i][2]];
    const auto [left, right] = std::minmax({a.x, b.x, c.x});
    const auto [top, bottom] = std::minmax({a.y, b.y, c.y});
    const Span span{i, pixelAt(left - 1, camera.width), pixelAt(right + 1, camera.width)};
    for (int y = pixelAt(top - 1, camera.height); y <= pixelAt(bottom + 1, camera.height); ++y) found.rows_[size_t(y)].push_back(span);
  }
  return found;
}

PixelTriangles::Side PixelTriangles::sideOf(uint32_t from, uint32_t to, double y) const {
  const Place &a = places_[std::min(from, to)], &b = places_[std::max(from, to)];
  const double sense = from < to ? 1 : -1;
  return {sense * ((b.x - a.x) * (y - a.y)), sense * (b.y - a.y), a.x};
}

PixelTriangles::Row PixelTriangles::row(int y) const {
  Row row{std::vector<uint32_t>(size_t(width_) + 1), {}};
  std::vector<std::pair<int, uint32_t>> met;  // columns and triangles
  for (const auto& [triangle, first, last] : rows_[size_t(y)]) {
    const auto& [a, b, c] = triangles_[triangle];
    const Side sides[] = {sideOf(a, b, y + 0.5), sideOf(b, c, y + 0.5), sideOf(c, a, y + 0.5)};
    for (int x = first; x <= last; ++x) {
      const double one = sides[0].at(x + 0.5), two = sides[1].at(x + 0.5), three = sides[2].at(x + 0.5);
      if (!(one >= 0 && two >= 0 && three >= 0) && !(one <= 0 && two <= 0 && three <= 0)) continue;
      met.emplace_back(x, triangle);
      ++row.begin[size_t(x)];
    }
  }
  std::partial_sum(row.begin.begin(), row.begin.end(), row.begin.begin());  // the end of each column
  row.triangles.resize(met.size());
  for (size_t i = met.size(); i-- > 0;) row.triangles[--row.begin[size_t(met[i].first)]] = met[i].second;  // at last its beginning
  return row;
}

}  // namespace cloudbake
