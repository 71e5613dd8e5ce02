// Which triangles the rays through the centres of pixels meet, found from the triangles: one after the other is projected, as graphics
// cards do it. For one ray per pixel this takes a fraction of the time of rays that look for triangles.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/types.h"
#include "preview/camera.h"

namespace cloudbake {

class PixelTriangles {
 public:
  /// The triangles of a row of pixels.
  struct Row {
    std::span<const uint32_t> at(int x) const {
      return std::span(triangles).subspan(begin[size_t(x)], begin[size_t(x) + 1] - begin[size_t(x)]);
    }
    std::vector<uint32_t> begin;  ///< of each pixel's triangles, and the end of the last one's
    std::vector<uint32_t> triangles;
  };

  /// Nothing if a vertex is not in front of the camera.
  static std::optional<PixelTriangles> of(std::span<const Vec3> positions, std::span<const Triangle> triangles, const Camera& camera);

  /// Those that the rays of row `y` meet, in the order of the mesh. A ray through an edge meets both triangles of the edge.
  Row row(int y) const;

 private:
  struct Place {
    double x = 0, y = 0;
  };
  struct Span {
    uint32_t triangle;
    int first, last;  // columns
  };
  // On which side of an edge the points of a row are: where the value is above 0 or below.
  struct Side {
    double of_row, slope, from_x;
    double at(double x) const { return of_row - slope * (x - from_x); }
  };
  Side sideOf(uint32_t from, uint32_t to, double y) const;

  int width_ = 0;
  std::span<const Triangle> triangles_;
  std::vector<Place> places_;            // of the vertices, in pixels
  std::vector<std::vector<Span>> rows_;  // the triangles whose boxes touch each row
};

}  // namespace cloudbake
