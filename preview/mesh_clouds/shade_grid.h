// How many clouds shade each other and the ground at once: a grid of the optical depth of the sky along the light.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/affine.h"
#include "core/vec3.h"
#include "preview/mesh_clouds/cloud_shadow.h"

namespace cloudbake {

/// How fine a grid is.
struct ShadeGridSettings {
  int cells = 384;           ///< across the light, along the longer side, at most; 8 … 1024
  int slices = 16;           ///< along the light, at most; 4 … 256
  int cells_per_cloud = 16;  ///< no cell is smaller than this part of `cloud_size`
  float cloud_size = 1;      ///< the mean longest side of the clouds, world units, > 0
  Vec3 wind{};               ///< how far the clouds have drifted: the cells drift with them
};

/// Where the nodes of a grid are. A node's first two coordinates are the same along the light, and the third grows away from it.
struct ShadeFrame {
  std::array<std::array<double, 4>, 3> to_grid{};  ///< rows that take a point of the world, with 1 as fourth, to coordinates of nodes
  std::array<int, 3> nodes{2, 2, 2};               ///< at whole coordinates 0 … nodes − 1

  std::array<double, 3> place(double x, double y, double z) const;
  std::array<double, 3> place(Vec3 p) const { return place(double(p.x), double(p.y), double(p.z)); }
};

/// The frame in which a box of the world fits, under a light with a direction of unit length.
ShadeFrame shadeFrame(const Box& box, Vec3 to_light, const ShadeGridSettings& settings);

/// The shares of the light at some of the nodes of a grid.
struct ShadeBlock {
  std::array<int, 3> first{}, nodes{};  ///< `nodes` of the grid's nodes from `first` on
  std::vector<float> shares;            ///< first coordinate fastest

  /// Between the nodes by the eight around a place of the grid, beyond them that of the nearest.
  float shareAt(const std::array<double, 3>& place) const;
};

/// What all clouds let through of a light. The optical depth at a node is a sum of whole numbers, so that a cloud that is taken out of it
/// leaves exactly what is there without it, and the order of clouds changes nothing.
class ShadeGrid {
 public:
  static constexpr int kPerDepth = 4096;  ///< steps per unit of optical depth
  ShadeGrid() = default;
  /// `shadows` of clouds that are within the box of the frame.
  ShadeGrid(const ShadeFrame& frame, std::span<const CloudShadow> shadows, Vec3 to_light);

  const ShadeFrame& frame() const { return frame_; }
  /// What comes to the nodes around a cloud past all other clouds.
  ShadeBlock pastOthers(size_t cloud) const;
  /// The same past all clouds, everywhere.
  const ShadeBlock& pastAll() const { return all_; }

 private:
  struct Columns {  // of a cloud: nodes across the light, and the optical depth that the light has at its lower end
    std::array<int, 2> first{}, count{};
    std::vector<float> depths;
    std::array<double, 3> enters{}, leaves{};  // third coordinates: value at the first node, change per node
    std::array<int, 2> slices{};               // the nodes along the light from which and to which the cloud's vertices may be
  };
  static int stepsAt(const Columns& columns, int i, int j, int slice);
  Columns columnsOf(const CloudShadow& shadow, Vec3 to_light) const;

  ShadeFrame frame_;
  std::vector<Columns> columns_;  // by cloud
  std::vector<int32_t> steps_;    // at each node, past all clouds
  ShadeBlock all_;
};

}  // namespace cloudbake
