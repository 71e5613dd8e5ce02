// Mountains behind the clouds: a marched, eroded height field with rock, grass and snow, and its own sky, fog and camera path.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/image.h"
#include "core/keys.h"
#include "core/types.h"
#include "preview/camera.h"
#include "preview/layer.h"
#include "preview/light_passage.h"

namespace cloudbake {

// Lengths marked "SC" are in multiples of TerrainSettings::scale, so that only the scale has to change for larger mountains. Colours are
// linear.

/// h = amplitude · Σ gainⁱ nᵢ/(1 + |Σ∇n|²) of value noise n in [0, 1], the gradients of octaves 0 … i summed, each in its own octave's
/// coordinates; from octave to octave the point is turned by arctan(3/4) and scaled by the lacunarity.
struct TerrainShape {
  float frequency = 0.003F;  ///< of the first octave, per SC, > 0
  float amplitude = 120;     ///< SC, ≥ 0; the ground stays between 0 and twice as much (gain 1/2)
  float gain = 0.5F;         ///< > 0
  float lacunarity = 2;      ///< > 0
  int camera_octaves = 3;    ///< under the camera's path; all octaves ≥ 0
  int march_octaves = 9;     ///< of hits and shadows
  int normal_octaves = 16;
};

/// The fbm of four octaves that varies ground, snow and clouds: from octave to octave the point is turned by arctan(3/4) and scaled.
struct TerrainFbm {
  Vec3 lacunarities{2.02F, 2.03F, 2.01F};  ///< > 0
  float gain = 0.5F;                       ///< > 0; weights ½, ¼, ⅛, ¹⁄₁₆, divided by their sum
};

struct TerrainMarch {
  float step = 0.4F;           ///< of the height above the ground, 0 < step ≤ 1
  int steps = 300;             ///< ≥ 0; if they run out, the ground is assumed to be there
  float tolerance = 0.0015F;   ///< of the distance: a hit is within that height of the ground, > 0
  float ceiling = 300;         ///< SC: there is no ground above, and the ray is clipped to the part below
  float nearest = 0.004F;      ///< SC: where a ray starts, > 0
  float farthest = 4000;       ///< SC: where a ray ends, > nearest. The fog leaves 0.03% visible there
  float normal_step = 0.001F;  ///< of the distance: half the base of the normal's differences, > 0
};

struct TerrainShadowSettings {
  float lift = 0.05F;        ///< SC along the light: where the shadow's ray starts, ≥ 0
  float sharpness = 16;      ///< the shadow is the least sharpness · height/distance on the way, > 0
  int steps = 80;            ///< ≥ 0, each as long as the height above the ground; if they run out, the rest of the way counts as free
  float darkest = 0.001F;    ///< a shadow under this ends the way, ≥ 0
  float ceiling = 200;       ///< SC: nothing above it casts a shadow
  Vec3 tint{0, 0.5F, 0.8F};  ///< share of s² in the shadow's red, green and blue, the rest is s: blue at its rim; 0 … 1
};

/// Rock, grass and snow. r is a noise of the ground; a brightness is plain + grain·r.
struct TerrainGround {
  Vec3 rock_dark{0.08F, 0.05F, 0.03F}, rock_light{0.10F, 0.09F, 0.08F};  ///< mixed by strata
  float strata_frequency = 0.00007F;                                     ///< of the strata along x, per SC and 256 cells
  float strata_upwards = 48;                                             ///< times finer upwards
  float rock_plain = 0.75F, rock_grain = 0.25F, rock_gain = 0.9F;
  float grain_frequency = 7;        ///< of r, cells per SC
  Vec3 grass{0.45F, 0.30F, 0.15F};  ///< · grass_gain · brightness
  float grass_gain = 0.2F, grass_plain = 0.5F, grass_grain = 0.5F;
  float grass_from = 0.7F, grass_to = 0.9F;  ///< by ss of the normal's height
  Vec3 meadow{0.30F, 0.30F, 0.10F};          ///< · meadow_gain · brightness
  float meadow_gain = 0.15F, meadow_plain = 0.25F, meadow_grain = 0.75F;
  float meadow_from = 0.95F, meadow_to = 1;     ///< by ss of the normal's height
  float coarse_grain = 1.25F, fine_grain = 10;  ///< fbms of the brightness, cells per SC: 0.005 and 0.04 per unit at SC = 250
  float light_plain = 0.1F, light_gain = 1.8F;  ///< all of it · (plain + gain·√(fine·coarse))
  Vec3 snow{0.62F, 0.65F, 0.70F};               ///< · snow_gain
  float snow_gain = 0.29F;
  float snow_low = 55, snow_high = 80;            ///< SC: none below (less noise), all above; low < high
  float snow_noise = 25, snow_frequency = 0.01F;  ///< SC, and cells per SC
  float snow_steep = 0.5F, snow_flat = 0.1F;      ///< e = ss(1 − steep·h, 1 − flat·h, n.y), h the share by height; steep > flat
  float snow_sunny = 0.3F, snow_shady = 0.7F;     ///< o = sunny + shady·ss(0, side_width, n·snow_side + h²)
  float snow_side_width = 0.1F;                   ///< > 0
  float snow_from = 0.1F, snow_to = 0.9F;         ///< the snow's colour by ss of its share
  Vec3 snow_side{1, 0, 0};                        ///< unit: slopes that face away from it have less, because the sun is there
};

struct TerrainLight {
  Vec3 sun{8 * 1.3F, 5 * 1.3F, 3 * 1.3F};
  Vec3 sky{0.4F * 1.2F, 0.6F * 1.2F, 1.2F};
  float sky_plain = 0.5F, sky_up = 0.5F;  ///< · (plain + up·n.y)
  Vec3 bounce{0.4F, 0.5F, 0.6F};
  float bounce_plain = 0.2F, bounce_facing = 0.8F;  ///< · (plain + facing · n·across), across the level direction away from the sun
  Vec3 specular{7, 5, 3};
  float gloss_exponent = 16;                          ///< of n·h
  float fresnel_plain = 0.04F, fresnel_gain = 0.96F;  ///< · (plain + gain·(1 + h·v)^exponent)
  float fresnel_exponent = 5;
  float gloss_plain = 0.7F, gloss_snow = 0.3F;  ///< · (plain + snow · share of snow)
  Vec3 snow_rim{0.65F * 0.3F, 0.65F * 0.5F, 0.65F * 0.6F};
  float rim_exponent = 4;  ///< of 1 + n·v
  float rim_to = 0.6F;     ///< · ss(0, rim_to, reflected y)
};

struct TerrainSkySettings {
  Vec3 color{0.3F, 0.5F, 0.85F};
  float darkening = 0.5F;                                 ///< · y², less in every channel, not under 0
  Vec3 haze{0.85F * 0.7F, 0.85F * 0.75F, 0.85F * 0.85F};  ///< by (1 − max(y, 0))^haze_exponent
  float haze_exponent = 4;
  Vec3 wide_lobe{0.25F * 1, 0.25F * 0.7F, 0.25F * 0.4F};  ///< · s^exponent, s the cosine of the angle to the sun, not under 0
  Vec3 middle_lobe{0.25F * 1, 0.25F * 0.8F, 0.25F * 0.6F};
  Vec3 narrow_lobe{0.2F * 1, 0.2F * 0.8F, 0.2F * 0.6F};
  float wide_exponent = 5, middle_exponent = 64, narrow_exponent = 512;
  Vec3 cloud{1, 0.95F, 1};                                       ///< cloud_share of it at most
  float cloud_share = 0.5F, cloud_from = 0.5F, cloud_to = 0.8F;  ///< by share · ss(from, to, fbm)
  float cloud_height = 1000;                                     ///< SC: of the plane of clouds
  float cloud_frequency = 0.0005F;                               ///< of the clouds' first octave, per SC, > 0
  Vec3 horizon{0.68F * 0.4F, 0.68F * 0.65F, 0.68F};              ///< by (1 − max(y, 0))^horizon_exponent
  float horizon_exponent = 16;
};

/// 1 − exp(−(density·t)^exponent), t in SC.
struct TerrainFog {
  float density = 0.001F;  ///< ≥ 0
  float exponent = 1.5F;   ///< > 0
  Vec3 color{0.65F * 0.4F, 0.65F * 0.65F, 0.65F};
  Vec3 scatter{0.3F * 1, 0.3F * 0.7F, 0.3F * 0.3F};  ///< · s^scatter_exponent, added to ground and sky
  float scatter_exponent = 8;
};

/// radius · (cos(x_rate·t), 0, cos(z_phase + z_rate·t)) with t = time_factor · seconds, above the ground of few octaves.
struct TerrainPathSettings {
  double time_factor = 0.1;
  float radius = 1100;                                 ///< SC
  double x_rate = 0.23, z_rate = 0.21, z_phase = 1.5;  ///< radians
  float clearance = 22;                                ///< SC above the ground
  float sink = 20;                                     ///< SC: how far the target, on the path at t + look_ahead, is below the camera
  double look_ahead = 3;                               ///< of t
  float roll = 0.2F;                                   ///< radians · cos(roll_rate·t)
  double roll_rate = 0.1;
  float focal_length = 3;  ///< in half heights of the picture, > 0
};

struct TerrainSettings {
  /// SC: world units per unit of the terrain, > 0. A mountain is about 100 SC high and about 300 SC wide.
  float scale = 250;
  Vec3 origin;        ///< place of the terrain's (0, 0, 0) in the world
  uint32_t seed = 0;  ///< selects other mountains
  TerrainShape shape;
  TerrainFbm fbm;
  TerrainMarch march;
  TerrainShadowSettings shadow;
  TerrainGround ground;
  TerrainLight light;
  TerrainSkySettings sky;
  TerrainFog fog;
  bool use_own_fog = true;      ///< false: no fog on the ground, for the scene's own fog, which uses the layer's distances
  bool use_sun_scatter = true;  ///< false: neither the ground nor the sky has fog.scatter
  TerrainPathSettings path;
  int samples_per_side = 1;  ///< n·n samples per pixel, ≥ 1
};

/// The keys of a scene file.
const Keys<TerrainSettings>& terrainKeys();
const Keys<TerrainShape>& terrainShapeKeys();
const Keys<TerrainFbm>& terrainFbmKeys();
const Keys<TerrainMarch>& terrainMarchKeys();
const Keys<TerrainShadowSettings>& terrainShadowKeys();
const Keys<TerrainGround>& terrainGroundKeys();
const Keys<TerrainLight>& terrainLightKeys();
const Keys<TerrainSkySettings>& terrainSkyKeys();
const Keys<TerrainFog>& terrainFogKeys();
const Keys<TerrainPathSettings>& terrainPathKeys();

/// Calls visit(table, keys, settings) for every table of keys of a terrain; tables of its parts are named "terrain.NAME".
template <typename Terrain, typename Visit>
void visitTerrainKeys(Terrain& terrain, const Visit& visit) {
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

/// (½n(p₀) + ¼n(p₁) + ⅛n(p₂) + ¹⁄₁₆n(p₃))/(15/16) of value noise n, in [0, 1]: pᵢ₊₁ = pᵢ turned by arctan(3/4) and scaled by 2.02, 2.03,
/// 2.01. The fbm of preview/backdrop/noise.h doubles without a turn and has the same weights, 8/15 … 1/15.
float terrainFbm(Vec2 p, uint32_t seed, const TerrainFbm& fbm = {});

/// Height of the ground over a world point, world units: origin.y … origin.y + 2·amplitude. Finite x and z; beyond 10⁶ SC from the
/// origin the ground loses its detail.
double terrainHeight(double x, double z, int octaves, const TerrainSettings& settings);

/// Unit normal by central differences over ±`step` world units, of the octaves of normals.
Vec3 terrainNormal(double x, double z, double step, const TerrainSettings& settings);

struct TerrainHit {
  double distance = 0;  ///< along the ray, world units
  Vec3 position;        ///< world
};

/// Where a ray meets the ground of march_octaves. Its direction has unit length. A ray that starts under the ground hits at once.
std::optional<TerrainHit> marchTerrain(const Ray& ray, const TerrainSettings& settings);

/// The fraction of the sun that reaches a point, 0 … 1. `to_sun` has unit length.
float terrainShadow(Vec3 point, Vec3 to_sun, const TerrainSettings& settings);

struct TerrainMaterial {
  Vec3 albedo;
  float snow = 0;  ///< 0 … 1
};

TerrainMaterial terrainMaterial(Vec3 point, Vec3 normal, const TerrainSettings& settings);

/// The colour that a ray along the unit vector `view` sees at its hit: lit ground, with fog and scattering as in the settings. Finite, ≥ 0.
Vec3 terrainColor(const TerrainHit& hit, Vec3 view, Vec3 to_sun, const TerrainSettings& settings);

/// The fraction of the fog's colour at a distance in world units, 0 … 1.
float terrainFog(double distance, const TerrainSettings& settings);

/// The terrain's own sky from a world position along the unit vector `view`: finite, ≥ 0.
Vec3 terrainSky(Vec3 position, Vec3 view, Vec3 to_sun, const TerrainSettings& settings);

/// The same for many points: what comes past the ground. A sun below the horizon counts as one at the horizon, as high clouds see it
/// longer.
void passTerrain(std::span<const Vec3> points, Vec3 to_sun, const TerrainSettings& settings, std::span<float> shares);

/// The ground as a camera sees it: a sample is opaque if it hits. `passage`, if any: how much of the sun's light reaches the ground past
/// other things. The bytes are the same for any number of threads.
Layer renderTerrain(const Camera& camera, Vec3 to_sun, const TerrainSettings& settings, const LightPassage& passage = {});

/// The terrain's own sky as a camera sees it.
Image renderTerrainSky(const Camera& camera, Vec3 to_sun, const TerrainSettings& settings);

/// The camera at a moment of the path, world units.
struct TerrainCamera {
  Vec3 position, target;
  float roll_radians = 0;
  float focal_length = 3;  ///< in half heights of the picture
};

/// The camera at any finite time.
TerrainCamera terrainPath(double time_seconds, const TerrainSettings& settings);

/// The same as a camera for rendering.
Camera cameraOf(const TerrainCamera& camera, int width, int height);

}  // namespace cloudbake
