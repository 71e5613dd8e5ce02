// Counted warnings: whatever is dropped, repaired or undefined is counted here, never passed over in silence.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace cloudbake {

enum class WarningKind {
  kSphereTooSmall,      ///< a sphere under 1.5 voxels: the grid cannot hold it faithfully
  kUndefinedDirection,  ///< a vertex without a mean occlusion direction; −normal was stored
  kOpenEdges,           ///< the sculpt is not closed
  kTurnedTriangles,     ///< neighbouring triangles are wound against each other
  kNonManifoldEdges,    ///< more than two triangles share an edge
  kDegenerateTriangle,  ///< a triangle without area
  kZeroNormal,          ///< a normal of length 0 was replaced by the surface's own
  kDuplicateTriangle,   ///< a triangle that is there more than once
  kUnreferencedVertex,  ///< a vertex that no triangle uses
  kCoarseCoordinates,   ///< float32 is coarse at this distance from the origin
  kVolumeMismatch,      ///< the level set's volume differs from the mesh's
  kInvertedMesh,        ///< the triangles face inwards
  kThinPart,            ///< vertices of parts that are thinner than a voxel
  kSelfIntersection,    ///< triangles that cut each other
  kInnerShell,          ///< shells that lie inside others
  kHoleNotFilled,       ///< --repair fill left a hole
  kImageNotEmbedded,    ///< an image beside the sculpt was left where it is
  kGrammar,             ///< a rule does something its writer may not want
  kUnitsAssumed,        ///< a file did not say its unit or up axis
  kMissingUvSet,        ///< zeros were written because glTF allows no gap in TEXCOORD_n
  kKeepAlive,           ///< no free texture slot: an optimiser may drop the UV sets
  kPoseIgnored,         ///< skin, morph or animation: the default pose was baked
  kPartIgnored,         ///< points or lines: not part of a surface
  kVertexBudget,        ///< borders or topology allow no vertex budget as small as asked for
  kFieldFallback,       ///< the asked-for integration field cannot be made; another was taken
  kNoiseTooFine,        ///< bumps of the noise are too small for the grid
  kGridChosen,          ///< a file holds several volumes; one was taken
  kVolumeRebuilt,       ///< distances of a volume were computed anew: its band is too narrow, or it is a fog volume of unknown surface
  kOutsideField,        ///< something lies outside the integration field
  kOldKey,              ///< a key of a file that has another name by now
};

/// Short name of a kind as it stands in reports, e.g. "open-edges".
std::string_view warningName(WarningKind kind);

/// Counts per kind, each with the text of its first occurrence.
class Warnings {
 public:
  struct Entry {
    uint64_t count = 0;
    std::string first;  ///< what was met first, and where
  };
  const std::map<WarningKind, Entry>& entries() const { return entries_; }
  bool empty() const { return entries_.empty(); }

  /// Adds `count` occurrences of one kind. `what` tells the reader what happened and where.
  void add(WarningKind kind, std::string_view what, uint64_t count = 1) {
    if (count == 0) return;
    Entry& entry = entries_[kind];
    if (entry.count == 0) entry.first = what;
    entry.count += count;
  }

 private:
  std::map<WarningKind, Entry> entries_;
};

}  // namespace cloudbake
