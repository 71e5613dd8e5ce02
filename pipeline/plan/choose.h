// Chooses how the clouds of many pictures are drawn: which of the ways to draw an asset are kept, and up to which size each of them is
// drawn. Nothing here draws.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "preview/compare/popping.h"

namespace cloudbake {

/// A way to draw an asset: its mesh, a level of detail, or an impostor.
struct DrawnWay {
  size_t vertices = 0;
  uint64_t bytes = 0;               ///< of its file
  std::vector<SizeChange> changes;  ///< against the full asset, as of Popping; empty: none
  bool is_picture = false;          ///< an impostor, which casts no shadow: an asset has a mesh beside it
};

/// Sizes of clouds, in pixels along the longest side (preview/mesh_clouds/levels.h), are counted in steps of a fourth of an octave
/// from 8 on.
inline constexpr size_t kSizeSteps = 38;
/// The largest size of a step; infinite for the last one, in which only the finest way is drawn.
float sizeOfStep(size_t step);
/// The step of a size.
size_t stepOfSize(float pixels);

/// How many clouds of an asset have each size in a picture.
using SizeCounts = std::array<uint32_t, kSizeSteps>;
/// One per asset.
using ViewCounts = std::vector<SizeCounts>;

/// Limits of a plan. Those of cost hold for the picture in which it is largest.
struct PlanBudget {
  double change = 2;  ///< rms of the 8-bit values over the pixels that show clouds
  std::optional<double> vertices, bytes, draws;
};

/// What pictures cost: the most vertices and draws of one of them, each asset's way in a picture being one draw of all its instances, and
/// the bytes of all files.
struct PlanCost {
  double vertices = 0, draws = 0, bytes = 0;
};

/// What is weighed against each other: a draw costs as much as so many vertices, and so do so many bytes. A draw takes microseconds of a
/// processor, in which a graphics card transforms some thousands of vertices.
inline constexpr double kVerticesPerDraw = 1000, kBytesPerVertex = 100;

/// A plan. switch_pixels[a][w]: the most pixels at which way w of asset a is drawn, falling with w; 0: never. The finest way with a size
/// is drawn at all larger ones too, and its file is needed wherever the cloud is.
struct PlannedWays {
  std::vector<std::vector<int>> switch_pixels;
  PlanCost cost;
  PlanCost mean;                ///< over the pictures
  double change = 0;            ///< in the worst picture, as the changes of the ways say
  std::vector<double> changes;  ///< of each picture
};

/// The ways that are drawn, from fine to coarse. The first one is drawn at all sizes above those of the others.
std::vector<size_t> usedWays(std::span<const int> switch_pixels);
/// The way that is drawn at a size.
size_t wayAt(std::span<const int> switch_pixels, float pixels);

/// The cheapest plan whose pictures all change by `budget.change` at most. `assets`: the ways of each, from fine to coarse; the first one
/// is the full asset. `correction`: the factor from what the ways' changes say to what the pictures show. `picture_pixels`: of a picture,
/// which a near cloud covers at most. Limits of cost are tried for, and may still be exceeded.
PlannedWays chooseWays(std::span<const std::vector<DrawnWay>> assets, std::span<const ViewCounts> views, const PlanBudget& budget,
                       double picture_pixels, double correction = 1);

/// What the full assets cost.
PlanCost costOfFull(std::span<const std::vector<DrawnWay>> assets, std::span<const ViewCounts> views);

}  // namespace cloudbake
