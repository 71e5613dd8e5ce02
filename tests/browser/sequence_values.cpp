// What the functions of shaders/engines/sequence.glsl must give: two keys of a picture, and what is between them.
#include "core/image.h"
#include "core/sequence.h"
#include "io/gltf/sequence/key_texture.h"
#include "io/gltf/sequence/sequence_file.h"
#include "tests/browser/glsl_values.h"

namespace cloudbake {

namespace {

constexpr int kBlocks = 4, kKeys = 2;

// A vertex in two keys, whose texels have random bytes, as both programs read them.
struct Blend {
  std::vector<Texel> inputs;  // four texels of each key, and the corners of the box with the largest d and the share
  SequenceKey between;
};

Blend blendOf(Draws& draw) {
  const KeyTexturePlace place{.first_row = 0, .keys = kKeys, .vertices = 1};
  Image picture = blankImage(kSequenceColumns, place.rows());
  const auto byte = [&] { return std::floor(draw.between(0, 256)) / 255; };
  Blend blend;
  for (int key = 0; key < kKeys; ++key)
    for (int block = 0; block < kBlocks; ++block) {
      Vec3& texel_of_key = picture.at(0, block * kKeys + key) = {byte(), byte(), byte()};
      blend.inputs.push_back(texel(texel_of_key));
    }
  KeyTextureScale scale;
  const Vec3 low{draw.between(-2, 2), draw.between(-2, 2), draw.between(-2, 2)};
  scale.box.add(low);
  scale.box.add(low + Vec3{draw.between(0, 3), draw.between(0, 3), draw.between(0, 3)});
  scale.densest = draw.between(0.1F, 3);
  const float share = draw.between(0, 1);
  blend.inputs.push_back(texel(scale.box.low, scale.densest));
  blend.inputs.push_back(texel(scale.box.high, share));
  const SequenceKey from = keyOfTexture(picture, place, 0, scale);
  SequenceKey to = keyOfTexture(picture, place, 1, scale);
  to.frame = 1;
  blend.between = blendedKey(from, to, share);
  return blend;
}

// Where a texel is: of vertex 0 of a row of them, and the same place in a picture whose texels have the numbers of their rows.
Point placeOf(Draws& draw) {
  const auto whole = [&](float below) { return std::floor(draw.between(0, below)); };
  const float column = whole(1024), row = whole(4), first_row = whole(4000), keys = whole(200) + 1, key = whole(keys), block = whole(4);
  return {{{column, row, block, key}, {first_row, 4, keys, 0}}, {column, first_row + (block * 4 + row) * keys + key, 0, 0}};
}

}  // namespace

std::vector<Function> sequenceFunctions() {
  const std::string share = "p[9].w";
  const auto bytes = [](int texel_of_key) { return "sequenceBytes(p[" + std::to_string(texel_of_key) + "].xyz)"; };
  const auto position = [&](const std::string& low) {
    const auto of = [&](int key) { return "sequencePosition(" + bytes(4 * key) + ", " + bytes(4 * key + 1) + ", " + low + ", p[9].xyz)"; };
    return "vec4(mix(" + of(0) + ", " + of(1) + ", " + share + "), 0.0)";
  };
  const auto normal = [&](const std::string& swizzle) {
    const auto of = [&](int key) { return "sequenceDirection(" + bytes(4 * key + 3) + swizzle + ")"; };
    return "vec4(blendedNormal(" + of(0) + ", " + of(1) + ", " + share + "), 0.0)";
  };
  const auto lobe = [&](const std::string& densest) {
    const auto of = [&](int key) { return "sequenceLobe(" + bytes(4 * key + 2) + ", " + bytes(4 * key + 3) + ", " + densest + ")"; };
    return "blendedLobe(" + of(0) + ", " + of(1) + ", " + share + ")";
  };
  const auto between = [](auto part) {
    return [part](Draws& draw) {
      const Blend blend = blendOf(draw);
      return Point{blend.inputs, part(blend.between)};
    };
  };
  std::vector<Function> functions{{"sequence", "sequenceTexel", "vec4(sequenceTexel(p[0].xy, p[1].xyz, p[0].z, p[0].w), 0.0, 0.0)",
                                   "vec4(sequenceTexel(p[0].xy, p[1].xyz, p[0].w, p[0].z), 0.0, 0.0)", 0, 0, placeOf},
                                  {"sequence", "sequenceBytes and sequencePosition", position("p[8].xyz"), position("p[8].zyx"), 1e-6, 1e-6,
                                   between([](const SequenceKey& key) { return texel(key.positions[0]); })},
                                  {"sequence", "sequenceDirection and blendedNormal", normal(".xy"), normal(".yx"), 3e-5, 0,
                                   between([](const SequenceKey& key) { return texel(key.normals[0]); })},
                                  {"sequence", "sequenceLobe and blendedLobe", lobe("p[8].w"), lobe("1.01 * p[8].w"), 3e-5, 0,
                                   between([](const SequenceKey& key) { return texel(key.lobes[0].direction, key.lobes[0].thickness); })}};
  for (Function& f : functions) f.uses = {"lobe"};
  return functions;
}

}  // namespace cloudbake
