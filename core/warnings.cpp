#include "core/warnings.h"

namespace cloudbake {

std::string_view warningName(WarningKind kind) {
  switch (kind) {
    case WarningKind::kSphereTooSmall: return "sphere-too-small";
    case WarningKind::kUndefinedDirection: return "undefined-direction";
    case WarningKind::kUnseenVertex: return "unseen-vertex";
    case WarningKind::kOpenEdges: return "open-edges";
    case WarningKind::kTurnedTriangles: return "turned-triangles";
    case WarningKind::kNonManifoldEdges: return "non-manifold-edges";
    case WarningKind::kDegenerateTriangle: return "degenerate-triangle";
    case WarningKind::kZeroNormal: return "zero-normal";
    case WarningKind::kDuplicateTriangle: return "duplicate-triangle";
    case WarningKind::kUnreferencedVertex: return "unreferenced-vertex";
    case WarningKind::kCoarseCoordinates: return "coarse-coordinates";
    case WarningKind::kVolumeMismatch: return "volume-mismatch";
    case WarningKind::kInvertedMesh: return "inverted-mesh";
    case WarningKind::kThinPart: return "thin-part";
    case WarningKind::kSelfIntersection: return "self-intersection";
    case WarningKind::kInnerShell: return "inner-shell";
    case WarningKind::kHoleNotFilled: return "hole-not-filled";
    case WarningKind::kImageNotEmbedded: return "image-not-embedded";
    case WarningKind::kGrammar: return "grammar";
    case WarningKind::kUnitsAssumed: return "units-assumed";
    case WarningKind::kMissingUvSet: return "missing-uv-set";
    case WarningKind::kKeepAlive: return "keep-alive";
    case WarningKind::kPoseIgnored: return "pose-ignored";
    case WarningKind::kJointFallback: return "joint-fallback";
    case WarningKind::kOtherScene: return "other-scene";
    case WarningKind::kSingularTransform: return "singular-transform";
    case WarningKind::kHiddenPart: return "hidden-part";
    case WarningKind::kTransformGuessed: return "transform-guessed";
    case WarningKind::kPartIgnored: return "part-ignored";
    case WarningKind::kVertexBudget: return "vertex-budget";
    case WarningKind::kPartKept: return "part-kept";
    case WarningKind::kFieldFallback: return "field-fallback";
    case WarningKind::kNoiseTooFine: return "noise-too-fine";
    case WarningKind::kGridChosen: return "grid-chosen";
    case WarningKind::kVolumeRebuilt: return "volume-rebuilt";
    case WarningKind::kOutsideField: return "outside-field";
    case WarningKind::kMaterialIgnored: return "material-ignored";
    case WarningKind::kTextureIgnored: return "texture-ignored";
    case WarningKind::kCameraIgnored: return "camera-ignored";
    case WarningKind::kLightIgnored: return "light-ignored";
    case WarningKind::kCurveIgnored: return "curve-ignored";
    case WarningKind::kMissingColor: return "missing-color";
    case WarningKind::kPartNotPacked: return "part-not-packed";
    case WarningKind::kPartNotRefined: return "part-not-refined";
    case WarningKind::kRefineTarget: return "refine-target";
    case WarningKind::kHierarchyChanged: return "hierarchy-changed";
    case WarningKind::kStaleLevel: return "stale-level";
  }
  return "unknown";
}

}  // namespace cloudbake
