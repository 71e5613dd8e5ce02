// Clouds that are marched: preview/backdrop/marched_clouds.h. It needs noise.glsl, random.glsl, samples.glsl and shading.glsl.
// The members of a 'struct NAME;' are the keys of its settings there (preview/backdrop/glsl_structs.h).

struct DistanceClouds;
struct DensityClouds;

// Octaves of noise; 1 where float has no precision left between the lattice's points.
float cloudNoise(vec3 p, vec3 wind, float time, float frequency, int octaves, uint seed, float limit) {
  vec3 place = (p - wind * time) * frequency;
  if (!all(lessThan(abs(place), vec3(1048576.0)))) {
    return 1.0;
  }
  return fbmValueUnder3(place, octaves, 0.5, seed, limit);
}

// The part of a ray whose heights lie within 'radius' of a plane: from x to y; x is NOWHERE if there is none.
vec2 stretchAbout(vec3 origin, vec3 direction, float height, float radius) {
  float from = height - radius - origin.y;
  float to = height + radius - origin.y;
  float rise = direction.y;
  if (rise == 0.0) {
    return from <= 0.0 && to >= 0.0 ? vec2(0.0, NOWHERE) : vec2(NOWHERE, 0.0);
  }
  float enter = max(0.0, min(from / rise, to / rise));
  float leave = max(from / rise, to / rise);
  return leave >= enter && enter < NOWHERE ? vec2(enter, leave) : vec2(NOWHERE, 0.0);
}

// --- The distance-like field ---

float distanceDensity(vec3 p, DistanceClouds s) {
  float limit = s.noise_offset - abs(p.y - s.cloud_height) * s.flatness;
  if (limit <= 0.0) {
    return 0.0;
  }
  float noise = cloudNoise(p, s.wind, s.time, s.noise_frequency, s.octaves, s.seed, limit + 1e-4);
  return clamp(-(abs(p.y - s.cloud_height) * s.flatness + noise - s.noise_offset), 0.0, 1.0);
}

// Where the samples begin; NOWHERE if there is no cloud.
float findDistanceCloud(vec3 origin, vec3 direction, vec2 stretch, float hidden_from, DistanceClouds s) {
  float t = stretch.x;
  float distance = s.first_step;
  for (int i = 0; i < s.search_steps && abs(distance) >= s.contact; i++) {
    t += distance;
    if (t > s.search_farthest || t - s.step_back > hidden_from) {
      return NOWHERE;
    }
    float field = NOWHERE;
    if (t <= stretch.y) {
      vec3 p = origin + direction * t;
      float noise = cloudNoise(p, s.wind, s.time, s.noise_frequency, s.octaves, s.seed, NOWHERE);
      field = abs(p.y - s.cloud_height) * s.flatness + noise - s.noise_offset;
    }
    distance = s.step_factor * field;
  }
  return t > s.search_farthest ? NOWHERE : max(0.0, t - s.step_back);
}

// Marches from 'origin', units of the method. shadowAt(point) of the program: the factor of a colour at a point, units.
vec3 shadowAt(vec3 point);

SampleSum marchDistanceCloud(vec3 origin, vec3 direction, vec3 to_light, float jitter, Cuts cuts, DistanceClouds s) {
  SampleSum sum = startSamples(0.0, 0, s.stop_opacity, cuts);
  vec2 stretch = stretchAbout(origin, direction, s.cloud_height, (s.noise_offset + s.contact / s.step_factor) / s.flatness);
  float hidden_from = hiddenFrom(cuts);
  if (stretch.x >= NOWHERE || stretch.x > min(min(s.search_farthest, s.farthest), hidden_from)) {
    return sum;
  }
  float first = findDistanceCloud(origin, direction, stretch, hidden_from, s);
  if (first >= NOWHERE) {
    return sum;
  }
  sum.t = first + jitter * s.least_step;
  sum.left = s.samples;
  while (moreSamples(sum)) {
    float t = sum.t;
    vec3 p = origin + direction * t;
    float density = distanceDensity(p, s);
    float to_light_density = density > 0.0 ? distanceDensity(p + to_light * s.shadow_distance, s) : 0.0;
    float shadow = smoothStep(s.shadow_start + s.shadow_slope * s.shadow_tuning, 0.0, to_light_density) * s.shadow_range + s.shadow_floor;
    float near = s.fade_start < 1.0 ? smoothStep(s.farthest, s.fade_start * s.farthest, t) : 1.0;
    vec3 color = mix(s.thin_color, s.dense_color, density) * shadow * s.tint;
    float opacity = clamp(density * shadow * s.opacity_factor * near, 0.0, 1.0);
    if (opacity > 0.0) {
      color *= shadowAt(p);
    }
    float distance = max(s.least_step, (s.step_base - s.step_density * density) * t * s.step_growth);
    if (t > stretch.y || t > s.farthest) {
      distance = NOWHERE;
    }
    takeSample(sum, color, opacity, distance);
  }
  endSamples(sum);
  return sum;
}

// --- The summed density ---

float densityDensity(vec3 p, DensityClouds s) {
  float layer = 1.0 - s.flatness * abs(s.cloud_height - p.y);
  if (!(layer > 0.0)) {
    return 0.0;
  }
  float limit = NOWHERE;
  if (s.noise_strength > layer && s.noise_contrast > 0.0) {
    limit = 0.5 + (layer / s.noise_strength - 0.5) / s.noise_contrast + 1e-4;
  }
  float noise = cloudNoise(p, s.wind, s.time, s.noise_frequency, s.octaves, s.seed, limit);
  return clamp(layer - s.noise_strength * clamp(0.5 + s.noise_contrast * (noise - 0.5), 0.0, 1.0), 0.0, 1.0);
}

// A published step, divided: the length, and the number of parts.
vec2 densityStep(float t, DensityClouds s) {
  float whole = max(s.least_step, s.step_growth * t);
  float parts = max(1.0, floor(min(whole / s.part_length, float(s.parts))));
  return vec2(whole / parts, parts);
}

SampleSum marchDensityCloud(vec3 origin, vec3 direction, vec3 to_light, vec3 sky, float jitter, Cuts cuts, DensityClouds s) {
  SampleSum sum = startSamples(s.first_t + jitter * s.part_length, 0, s.stop_opacity, cuts);
  vec2 stretch = stretchAbout(origin, direction, s.cloud_height, 1.0 / s.flatness);
  if (stretch.x >= NOWHERE || stretch.x > hiddenFrom(cuts)) {
    return sum;
  }
  float glow = s.glow_strength * pow(max(0.0, dot(direction, to_light)), s.glow_exponent);
  sum.left = s.samples * s.parts;
  while (moreSamples(sum)) {
    float t = sum.t;
    if (t > stretch.y) {
      break;
    }
    vec3 p = origin + direction * t;
    float density = t >= stretch.x ? densityDensity(p, s) : 0.0;
    vec2 divided = densityStep(t, s);
    vec3 color = sky;
    float opacity = 0.0;
    if (density > 0.0) {
      color = mix(s.thin_color, s.dense_color, density) * s.color_factor + s.glow_color * (glow * (1.0 - density));
      color = mix(color * s.tint * shadowAt(p), sky, 1.0 - exp(-s.fade_density * t * t));
      opacity = shareOfOpacity(density * s.opacity_factor, 1.0 / divided.y);
    }
    takeSample(sum, color, opacity, divided.x);
  }
  endSamples(sum);
  return sum;
}
