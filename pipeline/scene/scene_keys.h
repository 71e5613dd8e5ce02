// The keys of a scene file that each set one number, switch or colour of a renderer's settings: one table per struct, for reading, for
// docs/previewer.md and for the page of `view`.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "pipeline/scene/scene_file.h"

namespace cloudbake {

class TomlReader;  // core/text/toml.h

/// Limits of positions, world units, of colours and of seeds.
inline constexpr double kFar = 1e9, kBright = 1e4, kMostSeed = 2147483647;

/// A key, the field that it sets, and the limits of each of its numbers.
template <typename Settings>
struct SceneKey {
  const char* name;
  std::variant<float Settings::*, double Settings::*, int Settings::*, uint32_t Settings::*, bool Settings::*, Vec2 Settings::*,
               Vec3 Settings::*>
      field;
  double low = 0, high = 1;
  bool takes_one = false;  ///< of a Vec3: one number for all three will do
};

template <typename Settings>
using SceneKeys = std::vector<SceneKey<Settings>>;

/// The keys of the tables of a scene file. Those of [terrain.NAME] are named after the part of the terrain.
const SceneKeys<DiscSettings>& sunDiscKeys();
const SceneKeys<SmoothDiscSettings>& smoothDiscKeys();
const SceneKeys<SkySettings>& skyKeys();
const SceneKeys<MoonSettings>& moonKeys();
const SceneKeys<DiscSettings>& moonDiscKeys();
const SceneKeys<StarSettings>& starKeys();
const SceneKeys<LightSettings>& lightKeys();
const SceneKeys<ShadowSettings>& shadowKeys();
const SceneKeys<PhaseSettings>& phaseKeys();
const SceneKeys<CompositeSettings>& chainFogKeys();
const SceneKeys<PostSettings>& depthKeys();
const SceneKeys<DistortSettings>& distortKeys();
const SceneKeys<PaintedSteps>& paintedKeys();
const SceneKeys<SoftenSettings>& softenKeys();
const SceneKeys<ErodeSettings>& erodeKeys();
const SceneKeys<PublishedSteps>& publishedKeys();
const SceneKeys<ChannelSettings>& channelKeys();
const SceneKeys<BlurSettings>& blurKeys();
const SceneKeys<DepthBlurSettings>& depthBlurKeys();
const SceneKeys<SlabSettings>& slabKeys();
const SceneKeys<SlabTones>& slabToneKeys();
const SceneKeys<DistanceCloudSettings>& distanceCloudKeys();
const SceneKeys<DensityCloudSettings>& densityCloudKeys();
const SceneKeys<DustSettings>& dustKeys();
const SceneKeys<TerrainSettings>& terrainKeys();
const SceneKeys<TerrainShape>& terrainShapeKeys();
const SceneKeys<TerrainFbm>& terrainFbmKeys();
const SceneKeys<TerrainMarch>& terrainMarchKeys();
const SceneKeys<TerrainShadowSettings>& terrainShadowKeys();
const SceneKeys<TerrainGround>& terrainGroundKeys();
const SceneKeys<TerrainLight>& terrainLightKeys();
const SceneKeys<TerrainSkySettings>& terrainSkyKeys();
const SceneKeys<TerrainFog>& terrainFogKeys();
const SceneKeys<TerrainPathSettings>& terrainPathKeys();
const SceneKeys<MotionBlurSettings>& motionBlurKeys();
const SceneKeys<VignetteSettings>& vignetteKeys();
const SceneKeys<ContrastSettings>& contrastKeys();

/// Calls visit(table, keys, settings) for every table of keys of a terrain; tables of its parts are named "terrain.NAME".
template <typename Visit>
void visitTerrainKeys(const TerrainSettings& terrain, const Visit& visit) {
  visit("terrain", terrainKeys(), terrain);
  visit("terrain.shape", terrainShapeKeys(), terrain.shape);
  visit("terrain.fbm", terrainFbmKeys(), terrain.fbm);
  visit("terrain.march", terrainMarchKeys(), terrain.march);
  visit("terrain.shadow", terrainShadowKeys(), terrain.shadow);
  visit("terrain.ground", terrainGroundKeys(), terrain.ground);
  visit("terrain.light", terrainLightKeys(), terrain.light);
  visit("terrain.sky", terrainSkyKeys(), terrain.sky);
  visit("terrain.fog", terrainFogKeys(), terrain.fog);
  visit("terrain.path", terrainPathKeys(), terrain.path);
}

/// The value that a key sets.
using KeyValue = std::variant<float*, double*, int*, uint32_t*, bool*, Vec2*, Vec3*>;

/// Reads a key into a value if the table has it. Throws InputError with file, line and column.
void readKey(TomlReader& table, const char* name, double low, double high, bool takes_one, const KeyValue& value);

/// Reads those of the keys that the table has.
template <typename Settings>
void readKeys(TomlReader& table, const SceneKeys<Settings>& keys, Settings& settings) {
  for (const SceneKey<Settings>& key : keys) {
    const auto value = [&](auto field) -> KeyValue { return &(settings.*field); };
    readKey(table, key.name, key.low, key.high, key.takes_one, std::visit(value, key.field));
  }
}

/// A key with the value that a scene has, as it would stand in the file.
struct DescribedKey {
  std::string table;  ///< such as "terrain.ground", "marched by density"
  std::string name, value;
};

/// All keys of the tables that a scene has; of several slabs, and of several marched clouds of a kind, those of the first one.
std::vector<DescribedKey> describeKeys(const SceneFile& scene);

/// A line for each key: table and name, the default, and the value with as_published = true, separated by tabs. A key that only the
/// published or only the painted chain has "-" for the other value.
std::string listSceneKeys();

}  // namespace cloudbake
