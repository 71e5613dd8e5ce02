// Counted warnings. Everything that is dropped, repaired or undefined is counted here; nothing is ignored silently.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace cloudbake {

enum class WarningKind {
  kSphereTooSmall,      ///< a sphere with a radius under 1.5 voxels: the grid cannot represent it well
  kUndefinedDirection,  ///< a vertex without a mean occlusion direction; −normal was stored
  kUnseenVertex,        ///< a vertex that no view sees from outside: its lobe was fitted as if nothing were in front of it
  kOpenEdges,           ///< the sculpt is not closed
  kTurnedTriangles,     ///< neighbouring triangles have opposite winding
  kNonManifoldEdges,    ///< more than two triangles share an edge
  kDegenerateTriangle,  ///< a triangle without area
  kZeroNormal,          ///< a normal of length 0 was replaced by the normal of the surface
  kDuplicateTriangle,   ///< a triangle that appears more than once
  kUnreferencedVertex,  ///< a vertex that no triangle uses
  kCoarseCoordinates,   ///< the mesh is so far from the origin that float32 coordinates are coarse
  kVolumeMismatch,      ///< the level set's volume differs from the mesh's
  kInvertedMesh,        ///< the triangles face inwards
  kThinPart,            ///< vertices of parts that are thinner than a voxel
  kSelfIntersection,    ///< triangles that intersect each other
  kInnerShell,          ///< shells that lie inside others
  kHoleNotFilled,       ///< --repair fill left a hole
  kImageNotEmbedded,    ///< the asset refers to an image file beside the sculpt; the image was not embedded
  kGrammar,             ///< a rule does something that its author may not have intended
  kUnitsAssumed,        ///< a file does not state its unit or up axis
  kMissingUvSet,        ///< zeros were written because glTF allows no gap in TEXCOORD_n
  kKeepAlive,           ///< no free texture slot: an optimiser may drop the UV sets
  kPoseIgnored,         ///< morph targets, animation, or a skin without joints: the default pose was baked
  kJointFallback,       ///< a vertex without weights, or that its joints flatten: its lobe is stored in another space
  kOtherScene,          ///< a part that only another scene of the file draws: it gets no lobes
  kSingularTransform,   ///< a part under a scale of 0: it gets no lobes
  kHiddenPart,          ///< a part that its file hides: it gets no lobes and shades nothing
  kTransformGuessed,    ///< a transform whose rules have no agreed meaning, or that cannot be followed: the nearest was taken
  kPartIgnored,         ///< points or lines: not part of a surface
  kVertexBudget,        ///< borders or topology prevent a vertex budget as small as requested
  kPartKept,            ///< joints or morph targets move a part: its levels of detail are the part itself
  kFieldFallback,       ///< the requested integration field cannot be made; another was used
  kNoiseTooFine,        ///< bumps of the noise are too small for the grid
  kGridChosen,          ///< a file contains several volumes; one was chosen
  kVolumeRebuilt,       ///< distances of a volume were computed: its band is too narrow or not closed, or it is a fog volume
  kOutsideField,        ///< something lies outside the integration field
  kMaterialIgnored,     ///< a material library, or a value of a material, that the output does not hold
  kTextureIgnored,      ///< a texture that the output does not hold, or a colour that a picture does not show
  kCameraIgnored,       ///< a camera
  kLightIgnored,        ///< a light
  kCurveIgnored,        ///< a curve or a free-form surface
  kMissingColor,        ///< vertices without a colour in a file with colours; they became white
  kPartNotPacked,       ///< a part of a packed asset whose positions and normals stay floats: joints or morph targets move it
  kPartNotRefined,      ///< a part that --refine leaves as it is: it is skinned, morphed, or has values that cannot be blended
  kRefineTarget,        ///< --refine did not reach its target
  kHierarchyChanged,    ///< a node became a root: glTF cannot store its sheared transform
  kStaleLevel,          ///< beside the output is a level of detail of an earlier bake that had more of them
};

/// Short name of a kind, as reports show it, e.g. "open-edges".
std::string_view warningName(WarningKind kind);

/// The number of occurrences per kind, with the text of the first one.
class Warnings {
 public:
  struct Entry {
    uint64_t count = 0;
    std::string first;  ///< what happened first, and where
  };
  const std::map<WarningKind, Entry>& entries() const { return entries_; }
  bool empty() const { return entries_.empty(); }

  /// Adds `count` occurrences of one kind. `what` says what happened and where.
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
