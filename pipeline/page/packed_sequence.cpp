#include "pipeline/page/packed_sequence.h"

#include <nlohmann/json.hpp>

#include "core/portable_math.h"
#include "io/gltf/sequence/key_texture.h"
#include "pipeline/page/live_layers.h"

namespace cloudbake {

Json packedSequence(const CloudSequence& sequence, MeshPacker& packer) {
  const KeyTextureScale scale = scaleOfTexture(sequence);
  Json json = {{"frames_per_second", sequence.frames_per_second},
               {"loops", sequence.loops},
               {"period", sequence.period},
               {"box", {jsonOf(scale.box.low), jsonOf(scale.box.high)}},
               {"density_max", shortest(scale.densest)},
               {"segments", Json::array()}};
  for (const SequenceSegment& segment : sequence.segments) {
    std::vector<uint32_t> triangles, positions, roots, directions;
    Json frames = Json::array();
    for (const Triangle& t : segment.triangles) triangles.insert(triangles.end(), t.begin(), t.end());
    for (const SequenceKey& key : segment.keys) {
      frames.push_back(key.frame);
      for (const auto& [position, root, lobe, normal] : numbersOfKey(key, scale)) {
        positions.insert(positions.end(), position.begin(), position.end());
        roots.push_back(root);
        directions.insert(directions.end(), {lobe[0], lobe[1], normal[0], normal[1]});
      }
    }
    const size_t vertices = segment.keys.front().positions.size();
    packer.addTriangles(triangles);
    packer.addWhole(positions, 3 * vertices);
    packer.addWhole(roots, vertices);
    packer.addWhole(directions, 4 * vertices);
    json["segments"].push_back({{"frames", std::move(frames)}, {"vertices", vertices}, {"corners", triangles.size()}});
  }
  return json;
}

}  // namespace cloudbake
