// Few points that stand for many. The light of a volume changes over cells of the field and with the normal, so where a mesh has far more
// vertices than the field has cells, lobes that are fitted at some vertices are blended at the others.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/types.h"

namespace cloudbake {

class SparsePoints {
 public:
  /// At most one point per cell and range of normals. Nothing if the points are few, or if these would be more than a quarter of them.
  /// Which ones they are does not depend on the order of the points, unless two have the same position and normal, which is the same.
  static std::optional<SparsePoints> choose(const BakePoints& points, const CoverageField& field);
  /// Whether choose would ask for the normals and cells of so many points.
  static bool mayChoose(size_t points) { return points >= kLeastPoints; }

  /// Indices of the points that were chosen.
  const std::vector<size_t>& chosen() const { return chosen_; }
  /// The lobes at all points, from those at the chosen ones. The bytes are the same for any number of threads.
  std::vector<Lobe> blended(std::span<const Lobe> lobes) const;

 private:
  static constexpr size_t kLeastPoints = 1 << 17;
  BakePoints points_;
  std::array<int, 3> counts_{};       // cells per axis
  std::vector<Vec3> cells_;           // places of the points in cells
  std::vector<uint32_t> first_;       // per cell, of its points in order_
  std::vector<uint32_t> order_;       // points, cell by cell
  std::vector<uint32_t> used_cells_;  // those with points, in order
  std::vector<uint32_t> of_cell_;     // per used cell, of its points in chosen_
  std::vector<size_t> chosen_;
};

}  // namespace cloudbake
