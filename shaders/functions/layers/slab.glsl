// The cartoon slab: preview/backdrop/slab_clouds.h. It needs noise.glsl, samples.glsl and shading.glsl.
// The members of a 'struct NAME;' are the keys of its settings there (preview/backdrop/glsl_structs.h).

struct Slab;

// The height noise at (x, z) and its gradient.
vec3 slabNoise(vec2 place, Slab s) {
  vec2 high_place = place / s.noise_scale - s.high_drift * s.time;
  vec2 low_place = place.yx / s.noise_scale - s.low_drift * s.time;
  if (!(all(lessThan(abs(high_place), vec2(1048576.0))) && all(lessThan(abs(low_place), vec2(1048576.0))))) {
    return vec3(0.0);
  }
  vec3 high = fbmValue2(high_place, s.octaves, 0.5, s.seed);
  vec3 low = fbmValue2(low_place, s.octaves, 0.5, s.seed + 1u);
  float mixed = mix(high.x, low.x, s.low_share);
  float range = s.smooth_high - s.smooth_low;
  float part = clamp((mixed - s.smooth_low) / range, 0.0, 1.0);
  float slope = 6.0 * part * (1.0 - part) / (range * s.noise_scale);
  return vec3(smoothStep(s.smooth_low, s.smooth_high, mixed), slope * mix(high.yz, low.zy, s.low_share));
}

// Lower and upper surface.
vec2 slabProfile(float noise, Slab s) {
  float v = (noise - s.threshold) / (1.0 - s.threshold);
  return vec2(s.center - v * (s.center - s.bottom), s.center + v * (s.top - s.center));
}

float slabThickening(float y, float distance, vec2 profile, float edge_width) {
  float outside = max(profile.x - y, y - profile.y);
  if (!(profile.x < profile.y) || outside >= edge_width) {
    return 0.0;
  }
  float inside = min(distance, profile.y - profile.x);
  return outside < 0.0 ? inside : inside * smoothStep(edge_width, 0.0, outside);
}

float slabOpacity(float thickness, float rise, Slab s) {
  return clamp(thickness / (s.opaque_widths * s.edge_width / rise), 0.0, 1.0);
}

float slabHorizonFade(float view_y, Slab s) {
  return clamp((view_y - s.horizon_start) * s.horizon_gain, 0.0, 1.0);
}

// What a ray meets before, between and behind its cuts.
struct SlabHits {
  vec3 thicknesses, distances;
  vec3 opacities;  // of each part with all parts before it
  vec3 dens, facings;
};

// Adds what the way from 'from' to 'end' has, of which the cloud begins at 'contact', to the parts between the cuts.
void addThickness(inout SlabHits hits, inout int part, Cuts cuts, float from, float end, float contact, float added) {
  for (int i = 0; i < 3; i++) {
    float cut = cutDistance(cuts, part);
    bool is_cut = part < cuts.count && cut < end;
    float share = 1.0;
    if (is_cut) {
      share = cut > contact ? max(0.0, (cut - from) / (end - from)) : 0.0;
    }
    if (added * share > 0.0) {
      if (hits.thicknesses[part] == 0.0) {
        hits.distances[part] = contact;
      }
      hits.thicknesses[part] += added * share;
    }
    if (!is_cut) {
      return;
    }
    added -= added * share;
    from = max(from, cut);
    contact = max(contact, cut);
    part++;
  }
}

float thickeningAt(vec3 origin, vec3 direction, float t, float distance, Slab s) {
  vec3 p = origin + direction * t;
  return slabThickening(p.y, distance, slabProfile(slabNoise(p.xz, s).x, s), s.edge_width);
}

SlabHits marchSlab(vec3 origin, vec3 direction, float jitter, Cuts cuts, Slab s) {
  SlabHits hits = SlabHits(vec3(0.0), vec3(NOWHERE), vec3(0.0), vec3(0.0), vec3(0.0));
  float rise = direction.y;
  if (!(rise > 0.0)) {
    return hits;
  }
  float enter = max(0.0, (s.bottom - origin.y) / rise);
  float leave = (s.top - origin.y) / rise;
  if (!(leave > enter) || leave > 1e29) {
    return hits;
  }
  float distance = (leave - enter) / float(s.samples);
  float opaque = s.opaque_widths * s.edge_width / rise;
  float total = 0.0;
  int part = 0;
  for (int i = 0; i < s.samples && total < opaque; i++) {
    float t = enter + distance * (float(i) + jitter);
    float added = thickeningAt(origin, direction, t, distance, s);
    if (added > 0.0) {
      float from = enter + distance * float(i);
      float contact = from;
      if (total == 0.0) {
        float clear = t - distance;
        float touching = t;
        for (int halving = 0; halving < (i == 0 ? 0 : 8); halving++) {
          float middle = 0.5 * (clear + touching);
          if (thickeningAt(origin, direction, middle, distance, s) > 0.0) {
            touching = middle;
          } else {
            clear = middle;
          }
        }
        contact = touching;
      }
      addThickness(hits, part, cuts, from, from + distance, contact, added);
      total += added;
    }
  }
  float thickness = 0.0;
  for (int i = 0; i < 3; i++) {
    thickness += hits.thicknesses[i];
    hits.opacities[i] = slabOpacity(thickness, rise, s);
    if (hits.thicknesses[i] > 0.0) {
      vec3 p = origin + direction * hits.distances[i];
      vec3 noise = slabNoise(p.xz, s);
      hits.dens[i] = clamp((slabProfile(noise.x, s).y - p.y) / (s.top - s.bottom), s.least_den, 1.0);
      float up = (s.top - s.center) / (1.0 - s.threshold);
      hits.facings[i] = -dot(normalize(vec3(noise.y * up, -1.0, noise.z * up)), direction);
    }
  }
  return hits;
}

// Rises from 0 to 1 about a limit.
float passed(float limit, float softness, float x) {
  if (softness > 0.0) {
    return smoothStep(limit - softness, limit + softness, x);
  }
  return x < limit ? 0.0 : 1.0;
}

vec3 slabTone(float den, float facing, Slab s) {
  vec3 brightest = mix(s.light, s.highlight, clamp(facing * s.bright, 0.0, 1.0));
  vec3 tone = mix(s.shadow, s.middle, passed(s.shadow_limit, s.tone_softness, den));
  tone = mix(tone, brightest, passed(s.middle_limit, s.tone_softness, den));
  return tone * mix(1.0, s.self_shadow, den * den * s.self_shadow_gain);
}
