// The record that a baked asset has of its mesh, lobes and constants, so that a change after the bake is noticed. docs/asset_format.md has
// the format and docs/check.md says how it is used.
#pragma once

#include <span>

#include "core/lobe_packing.h"
#include "core/sculpt.h"
#include "core/types.h"

namespace cloudbake {

/// Makes the seal of an asset, part by part. Parts, vertices and triangles may come in any order, and vertices may be split or welded: the
/// seal differs only by rounding in the last digits of its numbers.
class SealMaker {
 public:
  /// `uvs` are the lobes as they are stored, in the part's own space; `harmonics` are #V × coefficients, or empty.
  void add(const SculptPart& part, std::span<const LobeUvs> uvs, std::span<const float> harmonics = {});
  AssetSeal finished(const AssetInfo& info) const;

 private:
  struct Sums {
    uint64_t mesh = 0;
    double area = 0;
    std::array<double, 3> first{};   // Σ area · place, relative to the origin below
    std::array<double, 6> second{};  // Σ area · place · placeᵀ: xx, yy, zz, xy, xz, yz
    std::array<double, kSketchSize> lobes{}, harmonics{};
    void operator+=(const Sums& other);
  };
  template <class Add>
  void addInBlocks(size_t count, const Add& add);

  Sums sums_;
  std::array<double, 3> origin_{};  // a vertex, so that shapes far from the scene's origin keep their digits
  bool has_origin_ = false;
};

/// Whether JSON can hold it: the surface's size and the lobes are within float.
bool isFinite(const AssetSeal& seal);

/// How an asset differs from its seal.
struct SealDifference {
  bool mesh = false;       ///< a triangle has other corners, in its part's own space
  bool constants = false;  ///< the kind of lobe, k, b, σ, L or the target of the fit is not that of the bake
  double shape = 0;        ///< largest relative change of area and moments; moving and turning the whole asset changes none
  double form = 0;         ///< of the moments alone; scaling the whole asset does not change them either
  double lobes = 0;      ///< rms change of the vectors o·d relative to their rms, estimated within about a fifth; needs an unchanged mesh
  double harmonics = 0;  ///< likewise of the coefficients
  /// More than rounding does.
  bool isReshaped() const { return shape > kRounding; }
  bool isDeformed() const { return form > kRounding; }
  static constexpr double kRounding = 1e-4;
};
SealDifference differenceOf(const AssetSeal& recorded, const AssetSeal& found);

}  // namespace cloudbake
