// Clouds that change: meshes with lobes at a few frames, and what is between them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// The layout of sequences (docs/sequences.md).
inline constexpr const char* kSequenceLayout = "lobe-sequence";

/// A cloud at one frame.
struct SequenceKey {
  double frame = 0;
  std::vector<Vec3> positions, normals;  ///< #V
  std::vector<Lobe> lobes;               ///< #V
};

/// The frames from the first key to the last one, which have the same triangles.
struct SequenceSegment {
  std::vector<Triangle> triangles;
  std::vector<SequenceKey> keys;  ///< by frame, at least one
  double first() const { return keys.front().frame; }
  double last() const { return keys.back().frame; }
};

/// A cloud that changes. Segments follow each other, and neighbours share some frames, over which one fades into the other. The first one
/// begins at frame 0. If the sequence loops, the last one fades into the first frames.
struct CloudSequence {
  AssetInfo info;  ///< of all keys
  double frames_per_second = 24;
  bool loops = false;
  double period = 0;  ///< frames: of a loop, those after which it is at its beginning again; else the last frame
  std::vector<SequenceSegment> segments;
  int pixels = 0;    ///< that its longest side covers in pictures for which it is made; 0: unknown, as of a file
  std::string seal;  ///< of a file: what sealOf was when it was written; empty: the file has none
};

/// Of the positions of all keys.
Box boxOf(std::span<const SequenceSegment> segments);

/// The key between two of the same triangles: every number is blended, as a vertex shader does it, then normals and o are made unit again.
SequenceKey blendedKey(const SequenceKey& from, const SequenceKey& to, double frame);
/// The key at a frame, which is clamped to those of the segment.
SequenceKey keyAt(const SequenceSegment& segment, double frame);

/// A segment that is seen at a moment.
struct SeenSegment {
  size_t segment = 0;
  double frame = 0;
  float weight = 1;  ///< of its picture; the weights of a moment sum up to 1
};
/// One segment, or two while one fades into the other, the earlier one first. A sequence that does not loop stays at its last frame.
std::vector<SeenSegment> seenAt(const CloudSequence& sequence, double seconds);

/// A key of a segment as a mesh.
BakedMesh meshOf(const CloudSequence& sequence, const SequenceSegment& segment, SequenceKey key);
/// The mesh of a segment at a frame.
BakedMesh meshAt(const CloudSequence& sequence, const SeenSegment& seen);

}  // namespace cloudbake
