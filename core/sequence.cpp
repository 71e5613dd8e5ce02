#include "core/sequence.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/lobe_packing.h"

namespace cloudbake {

Box boxOf(std::span<const SequenceSegment> segments) {
  Box box;
  for (const SequenceSegment& segment : segments)
    for (const SequenceKey& key : segment.keys)
      for (const Vec3& p : key.positions) box.add(p);
  return box;
}

SequenceKey blendedKey(const SequenceKey& from, const SequenceKey& to, double frame) {
  const double length = to.frame - from.frame;
  const float t = length > 0 ? float(std::clamp((frame - from.frame) / length, 0.0, 1.0)) : 0;
  if (t == 0) return from;
  if (t == 1) return to;
  const auto mixed = [t](Vec3 a, Vec3 b) { return a + (b - a) * t; };
  SequenceKey key{frame, {}, {}, {}};
  const size_t count = from.positions.size();
  key.positions.reserve(count), key.normals.reserve(count), key.lobes.reserve(count);
  for (size_t v = 0; v < count; ++v) {
    key.positions.push_back(mixed(from.positions[v], to.positions[v]));
    key.normals.push_back(normalized(mixed(from.normals[v], to.normals[v])).value_or(from.normals[v]));
    const Lobe &a = from.lobes[v], &b = to.lobes[v];
    key.lobes.push_back(mappedLobe({mixed(a.direction, b.direction), a.thickness + (b.thickness - a.thickness) * t}, {}));
  }
  return key;
}

SequenceKey keyAt(const SequenceSegment& segment, double frame) {
  const auto after = std::find_if(segment.keys.begin(), segment.keys.end(), [&](const SequenceKey& key) { return key.frame >= frame; });
  if (after == segment.keys.end()) return segment.keys.back();
  if (after == segment.keys.begin()) return segment.keys.front();
  return blendedKey(*(after - 1), *after, frame);
}

std::vector<SeenSegment> seenAt(const CloudSequence& sequence, double seconds) {
  const std::vector<SequenceSegment>& segments = sequence.segments;
  double frame = std::max(0.0, seconds * sequence.frames_per_second);
  frame = sequence.loops && sequence.period > 0 ? std::fmod(frame, sequence.period) : std::min(frame, segments.back().last());
  // The segment that began last, counting the last one of a loop, which reaches into the first frames.
  size_t now = 0;
  while (now + 1 < segments.size() && segments[now + 1].first() <= frame) ++now;
  std::optional<SeenSegment> before;
  if (now > 0 && segments[now - 1].last() > frame)
    before = {now - 1, frame, 0};
  else if (now == 0 && sequence.loops && segments.back().last() - sequence.period > frame)
    before = {segments.size() - 1, frame + sequence.period, 0};
  if (!before) return {{now, frame, 1}};
  const SequenceSegment& earlier = segments[before->segment];
  const double begin = now > 0 ? segments[now].first() : sequence.period;
  const auto weight = float((before->frame - begin) / (earlier.last() - begin));
  before->weight = 1 - weight;
  return {*before, {now, frame, weight}};
}

BakedMesh meshOf(const CloudSequence& sequence, const SequenceSegment& segment, SequenceKey key) {
  BakedMesh mesh;
  mesh.surface = {std::move(key.positions), std::move(key.normals), segment.triangles};
  mesh.lobes = std::move(key.lobes);
  mesh.info = sequence.info;
  return mesh;
}

BakedMesh meshAt(const CloudSequence& sequence, const SeenSegment& seen) {
  const SequenceSegment& segment = sequence.segments[seen.segment];
  return meshOf(sequence, segment, keyAt(segment, seen.frame));
}

}  // namespace cloudbake
