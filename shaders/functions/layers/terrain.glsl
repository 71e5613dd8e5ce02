// The eroded terrain: preview/backdrop/terrain.h. It needs noise.glsl and shading.glsl. Lengths marked SC are in multiples of 'scale'.
// The members of a 'struct NAME;' are the keys of its settings there (preview/backdrop/glsl_structs.h).

struct Terrain;

// What a noise is for.
const uint GRAIN = 0x51ED270Bu;
const uint ROCK = 0x2545F491u;
const uint SNOW = 0x6C8E9CF5u;
const uint CLOUDS = 0x3C6EF372u;

// 0 to the power of 0 is 1.
float power(float base, float exponent) {
  if (exponent == 0.0) {
    return 1.0;
  }
  return base > 0.0 ? pow(base, exponent) : 0.0;
}

// Kept inside the range of cell numbers.
vec2 onLattice(vec2 p) {
  return clamp(p, vec2(-536870912.0), vec2(536870912.0));
}

vec2 turned(vec2 p, float factor) {
  return factor * vec2(0.8 * p.x - 0.6 * p.y, 0.6 * p.x + 0.8 * p.y);
}

float terrainFbm(vec2 p, uint seed, TerrainFbm fbm) {
  float sum = 0.0;
  float weight = fbm.gain;
  float weights = 0.0;
  for (int i = 0; i < 4; i++) {
    sum += weight * valueNoise2(onLattice(p), mixBits(seed), 0).x;
    weights += weight;
    if (i < 3) {
      p = turned(p, fbm.lacunarities[i]);
    }
    weight *= fbm.gain;
    seed += 0x632BE5ABu;
  }
  return sum / weights;
}

// Noise on a tile of 256 x 256 cells and side 1.
float pictureNoise(vec2 place, uint seed) {
  return valueNoise2(onLattice(256.0 * place), mixBits(seed), 256).x;
}

// The height of the ground over the (x, z) of place + offset, above the origin's. The sum would be rounded more coarsely than the ground's
// detail, so the two are added inside the cells of each octave: heights about one place then differ as they should.
float terrainHeight(vec2 place, vec2 offset, int octaves, Terrain terrain) {
  float per_unit = terrain.shape.frequency / terrain.scale;
  vec2 p = (place - terrain.origin.xz) * per_unit;
  vec2 q = offset * per_unit;
  float sum = 0.0;
  float weight = 1.0;
  vec2 slope = vec2(0.0);
  uint seed = terrain.seed;
  for (int i = 0; i < octaves; i++) {
    vec2 part = fract(p) + q;
    vec3 noise = valueNoiseInCell(onLattice(floor(p) + floor(part)), fract(part), mixBits(seed), 0);
    slope += noise.yz;
    sum += weight * noise.x / (1.0 + dot(slope, slope));
    p = turned(p, terrain.shape.lacunarity);
    q = turned(q, terrain.shape.lacunarity);
    weight *= terrain.shape.gain;
    seed += 0x632BE5ABu;
  }
  return terrain.scale * terrain.shape.amplitude * sum;
}

vec3 terrainNormal(vec2 place, float base, Terrain terrain) {
  int octaves = terrain.shape.normal_octaves;
  float left = terrainHeight(place, vec2(-base, 0.0), octaves, terrain);
  float right = terrainHeight(place, vec2(base, 0.0), octaves, terrain);
  float back = terrainHeight(place, vec2(0.0, -base), octaves, terrain);
  float front = terrainHeight(place, vec2(0.0, base), octaves, terrain);
  return normalize(vec3(left - right, 2.0 * base, back - front));
}

// The distance at which a ray meets the ground; under 0 if it does not.
float marchTerrain(vec3 origin, vec3 direction, Terrain terrain) {
  TerrainMarch march = terrain.march;
  float first = march.nearest * terrain.scale;
  float last = march.farthest * terrain.scale;
  float below_ceiling = terrain.origin.y + march.ceiling * terrain.scale - origin.y;
  if (below_ceiling < 0.0) {
    if (direction.y >= 0.0) {
      return -1.0;
    }
    first = max(first, below_ceiling / direction.y);
  } else if (direction.y > 0.0) {
    last = min(last, below_ceiling / direction.y);
  }
  float t = first;
  for (int i = 0; i < march.steps && t <= last; i++) {
    float above_origin = origin.y - terrain.origin.y + direction.y * t;
    float height = above_origin - terrainHeight(origin.xz, direction.xz * t, terrain.shape.march_octaves, terrain);
    if (abs(height) < march.tolerance * t || (height < 0.0 && t <= first)) {
      break;
    }
    t = max(first, t + march.step * height);
  }
  return t > last ? -1.0 : t;
}

// The share of the sun that comes past the ground.
float terrainShadow(vec3 point, vec3 to_sun, Terrain terrain) {
  TerrainShadow shadow = terrain.shadow;
  float lift = shadow.lift * terrain.scale;
  float t = 1e-6 * terrain.scale;
  float least = 1.0;
  for (int i = 0; i < shadow.steps && least >= shadow.darkest; i++) {
    float above_origin = point.y - terrain.origin.y + to_sun.y * (lift + t);
    if (above_origin > shadow.ceiling * terrain.scale) {
      break;
    }
    float height = above_origin - terrainHeight(point.xz, to_sun.xz * (lift + t), terrain.shape.march_octaves, terrain);
    least = min(least, shadow.sharpness * height / t);
    t += height;
  }
  return clamp(least, 0.0, 1.0);
}

// What the ground leaves of a light at a point of the world.
float passTerrain(vec3 point, vec3 to_light, Terrain terrain) {
  if (point.y > terrain.origin.y + terrain.shadow.ceiling * terrain.scale) {
    return 1.0;
  }
  if (to_light.y < 0.0) {
    to_light = dot(to_light.xz, to_light.xz) > 0.0 ? normalize(vec3(to_light.x, 0.0, to_light.z)) : vec3(1.0, 0.0, 0.0);
  }
  return terrainShadow(point, to_light, terrain);
}

// There is snow at height, on gentle slopes, and less of it on the sunny side.
float snowShare(vec3 own, vec3 normal, Terrain terrain) {
  TerrainGround ground = terrain.ground;
  float noise = terrainFbm(ground.snow_frequency * own.xz, terrain.seed + SNOW, terrain.fbm);
  float high = smoothStep(ground.snow_low, ground.snow_high, own.y + ground.snow_noise * noise);
  if (high < 1e-4) {
    return 0.0;
  }
  float gentle = smoothStep(1.0 - ground.snow_steep * high, 1.0 - ground.snow_flat * high, normal.y);
  float side = dot(normal, ground.snow_side) + high * high;
  float shady = ground.snow_sunny + ground.snow_shady * smoothStep(0.0, ground.snow_side_width, side);
  return high * gentle * shady;
}

// Albedo, and the share of snow.
vec4 terrainMaterial(vec3 point, vec3 normal, Terrain terrain) {
  TerrainGround ground = terrain.ground;
  vec3 own = (point - terrain.origin) / terrain.scale;
  float grain = pictureNoise(ground.grain_frequency / 256.0 * own.xz, terrain.seed + ROCK);
  float stratum = pictureNoise(ground.strata_frequency * vec2(own.x, ground.strata_upwards * own.y), terrain.seed + ROCK);
  vec3 albedo = mix(ground.rock_dark, ground.rock_light, stratum) * ((ground.rock_plain + ground.rock_grain * grain) * ground.rock_gain);
  vec3 grass = ground.grass * (ground.grass_gain * (ground.grass_plain + ground.grass_grain * grain));
  albedo = mix(albedo, grass, smoothStep(ground.grass_from, ground.grass_to, normal.y));
  vec3 meadow = ground.meadow * (ground.meadow_gain * (ground.meadow_plain + ground.meadow_grain * grain));
  albedo = mix(albedo, meadow, smoothStep(ground.meadow_from, ground.meadow_to, normal.y));
  float fine = terrainFbm(ground.fine_grain * own.xz, terrain.seed + GRAIN, terrain.fbm);
  float coarse = terrainFbm(ground.coarse_grain * own.xz, terrain.seed + GRAIN, terrain.fbm);
  albedo *= ground.light_plain + ground.light_gain * sqrt(fine * coarse);
  float snow = snowShare(own, normal, terrain);
  return vec4(mix(albedo, ground.snow * ground.snow_gain, smoothStep(ground.snow_from, ground.snow_to, snow)), snow);
}

vec3 sunScatter(vec3 view, vec3 to_sun, Terrain terrain) {
  return terrain.sun_scatter ? terrain.fog.scatter * power(dot(view, to_sun), terrain.fog.scatter_exponent) : vec3(0.0);
}

float terrainFog(float distance, Terrain terrain) {
  return 1.0 - exp(-power(terrain.fog.density * distance / terrain.scale, terrain.fog.exponent));
}

// The colour of a hit with this normal; 'sun' is the share of the sun's light that comes there.
vec3 terrainColor(vec3 point, float distance, vec3 n, float sun, vec3 view, vec3 to_sun, Terrain terrain) {
  TerrainLight light = terrain.light;
  vec4 material = terrainMaterial(point, n, terrain);
  float facing = clamp(dot(n, to_sun), 0.0, 1.0);
  vec3 shadow = vec3(sun) + terrain.shadow.tint * (sun * sun - sun);
  vec3 across = vec3(-to_sun.x, 0.0, to_sun.z);
  across = dot(across, across) > 0.0 ? normalize(across) : vec3(0.0);
  vec3 lit = light.sun * shadow * facing;
  lit += light.sky * (light.sky_plain + light.sky_up * n.y);
  lit += light.bounce * clamp(light.bounce_plain + light.bounce_facing * dot(n, across), 0.0, 1.0);
  vec3 color = material.rgb * lit;

  // Gloss, and a rim of sky on snow.
  vec3 middle = to_sun - view;
  middle = dot(middle, middle) > 0.0 ? normalize(middle) : n;
  float fresnel = light.fresnel_plain + light.fresnel_gain * power(1.0 + dot(middle, view), light.fresnel_exponent);
  float gloss = light.gloss_plain + light.gloss_snow * material.a;
  color += light.specular * (facing * sun * power(dot(n, middle), light.gloss_exponent) * fresnel * gloss);
  float reflected_y = view.y - 2.0 * dot(view, n) * n.y;
  float rim = power(clamp(1.0 + dot(n, view), 0.0, 1.0), light.rim_exponent);
  color += light.snow_rim * (material.a * rim * smoothStep(0.0, light.rim_to, reflected_y));

  if (terrain.own_fog) {
    color = mix(color, terrain.fog.color, terrainFog(distance, terrain));
  }
  return color + sunScatter(view, to_sun, terrain);
}

// The terrain's own sky.
vec3 terrainSky(vec3 position, vec3 view, vec3 to_sun, Terrain terrain) {
  TerrainSky sky = terrain.sky;
  float y = max(0.0, view.y);
  float s = dot(view, to_sun);
  vec3 color = mix(sky.color - vec3(sky.darkening * view.y * view.y), sky.haze, power(1.0 - y, sky.haze_exponent));
  color += sky.wide_lobe * power(s, sky.wide_exponent) + sky.middle_lobe * power(s, sky.middle_exponent)
    + sky.narrow_lobe * power(s, sky.narrow_exponent);
  float up = terrain.origin.y + sky.cloud_height * terrain.scale - position.y;
  if (view.y > 0.0 && up > 0.0) {
    vec3 p = position + view * (up / max(1e-3, view.y));
    float clouds = terrainFbm((p.xz - terrain.origin.xz) * (sky.cloud_frequency / terrain.scale), terrain.seed + CLOUDS, terrain.fbm);
    color = mix(color, sky.cloud, sky.cloud_share * smoothStep(sky.cloud_from, sky.cloud_to, clouds));
  }
  color = mix(color, sky.horizon, power(1.0 - y, sky.horizon_exponent));
  return max(vec3(0.0), color + sunScatter(view, to_sun, terrain));
}
