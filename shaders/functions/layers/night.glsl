// Moon, stars, aurora and smooth discs: preview/backdrop/moon.h, stars.h, aurora.h, disc.h. It needs noise.glsl, shading.glsl and sky.glsl.
// The members of a 'struct NAME;' are the keys of its settings there (preview/backdrop/glsl_structs.h).

struct Moon;
struct Stars;
struct SmoothDisc;
struct Aurora;

// What a sky has beside its gradient and the simple disc of the sun.
struct Night {
  bool has_smooth_disc, has_moon, has_smooth_moon, has_moon_picture, has_stars, has_aurora;
  SmoothDisc smooth_disc;
  Moon moon;
  Stars stars;
  Aurora aurora;
};

const int CRATERS = 24;

float smoothDiscSquare(vec3 view, vec3 towards, SmoothDisc disc) {
  return max(-dot(towards, view) * 0.5 + 0.5 - disc.smooth_radius * 0.01, disc.smooth_softness * 1e-4);
}

vec3 smoothDiscColor(vec3 view, vec3 towards, vec3 color, SmoothDisc disc) {
  vec3 root = color * (disc.smooth_gain / sqrt(smoothDiscSquare(view, towards, disc)));
  return root * root;
}

// --- The moon ---

// The brightness of the ground in full light; a crater is its centre and radius.
float moonAlbedo(vec3 place, vec4 craters[CRATERS]) {
  float plains = fbmValue3(place * 1.7 + vec3(5.0, 2.0, 9.0), 5, 0.5, 0u);
  float albedo = mix(0.95, 0.45, smoothStep(0.46, 0.58, plains));
  albedo *= 0.9 + 0.2 * fbmValue3(place * 9.0, 3, 0.5, 1u);
  for (int i = 0; i < CRATERS; i++) {
    float distance = length(place - craters[i].xyz) / craters[i].w;
    if (distance <= 1.4) {
      float wall = smoothStep(0.7, 0.95, distance) * smoothStep(1.4, 1.0, distance);
      albedo += 0.22 * wall - 0.12 * smoothStep(0.9, 0.6, distance);
    }
  }
  return clamp(albedo, 0.0, 1.0);
}

// Of the program: the colour of the moon's picture at (u, v), where u counts up; only called if there is one.
vec3 moonPicture(vec2 uv);

vec3 moonColor(vec3 view, Moon moon, bool has_picture, vec4 craters[CRATERS]) {
  float mask = discMask(view, moon.direction, moon.disc_exponent, moon.disc_gain);
  if (!(mask > 1e-4)) {
    return vec3(0.0);
  }
  vec3 y = normalize(cross(moon.direction, moon.up));
  vec3 x = cross(y, moon.direction);
  float cosine = min(1.0, pow(0.5 / moon.disc_gain, 1.0 / moon.disc_exponent));
  vec2 at = vec2(dot(x, view), dot(y, view)) / sqrt(max(1e-12, 1.0 - cosine * cosine));
  vec2 uv = 0.5 * at + 0.5;
  float square = dot(at, at);
  if (square > 1.0) {
    at /= sqrt(square);
  }
  vec3 place = vec3(at, sqrt(max(0.0, 1.0 - square)));
  float phase = radians(moon.phase);
  float lit = smoothStep(-0.02, 0.18, dot(place, vec3(0.0, sin(phase), cos(phase))));
  if (!(lit > 0.0)) {
    return vec3(0.0);
  }
  return moon.color * (has_picture ? moonPicture(uv) : vec3(moonAlbedo(place, craters))) * (mask * lit);
}

SmoothDisc smoothDiscOf(Moon moon) {
  return SmoothDisc(moon.smooth_radius, moon.smooth_softness, moon.smooth_gain);
}

// A moon with a smooth disc.
vec3 smoothMoonColor(vec3 view, Moon moon) {
  return smoothDiscColor(view, moon.direction, moon.color, smoothDiscOf(moon)) * (0.5 + 0.5 * cos(radians(moon.phase)));
}

// How much of the light of a star the moon hides.
float moonCover(vec3 view, Moon moon, bool is_smooth) {
  if (is_smooth) {
    return moon.smooth_softness * 1e-4 / smoothDiscSquare(view, moon.direction, smoothDiscOf(moon));
  }
  return discMask(view, moon.direction, moon.disc_exponent, moon.disc_gain);
}

// --- Stars ---

vec3 starLight(vec3 view, float sun_height, Stars stars) {
  float night = smoothStep(stars.high_height, stars.low_height, sun_height);
  if (!(night > 0.0) || view.y <= 0.0) {
    return vec3(0.0);
  }
  float angle = -radians(stars.turn + stars.day_turn);
  vec3 own = view * cos(angle) + cross(stars.pole, view) * sin(angle) + stars.pole * (dot(stars.pole, view) * (1.0 - cos(angle)));

  // The cell of a cube around the viewer.
  vec3 size = abs(own);
  int axis = 2;
  if (size.x >= size.y && size.x >= size.z) {
    axis = 0;
  } else if (size.y >= size.z) {
    axis = 1;
  }
  float side = own[axis] > 0.0 ? 1.0 : -1.0;
  uint face = uint(2 * axis) + (side > 0.0 ? 0u : 1u);
  vec2 at = vec2(own[(axis + 1) % 3], own[(axis + 2) % 3]) / size[axis];
  int n = int(max(1.0, sqrt(float(stars.count) / 3.14159265)));
  ivec2 index = clamp(ivec2((at + 1.0) * 0.5 * float(n)), ivec2(0), ivec2(n - 1));
  uint cell = hashAlong(hashAlong(hashAlong(mixBits(stars.seed), int(face)), index.y), index.x);

  // Its star.
  vec2 share = vec2(unitFloat(hashAlong(cell, 0)), unitFloat(hashAlong(cell, 1)));
  vec2 star = 2.0 * (vec2(index) + mix(vec2(0.15), vec2(0.85), share)) / float(n) - 1.0;
  float square = 1.0 + dot(star, star);
  if (unitFloat(hashAlong(cell, 2)) > 1.0 / (square * sqrt(square))) {
    return vec3(0.0);
  }
  vec3 direction;
  direction[axis] = side;
  direction[(axis + 1) % 3] = star.x;
  direction[(axis + 2) % 3] = star.y;
  vec3 offset = own - direction / length(direction);
  float flux = min(1.0, 0.02 * pow(max(unitFloat(hashAlong(cell, 3)), 1e-6), -2.0 / 3.0));
  float width = stars.size * (3.14159265 / 360.0) / 0.8325546;
  float light = flux * exp(-dot(offset, offset) / (width * width));
  float draw = unitFloat(hashAlong(cell, 4));
  vec3 color = draw < 0.5 ? mix(vec3(1.0, 0.72, 0.46), vec3(1.0), 2.0 * draw) : mix(vec3(1.0), vec3(0.66, 0.78, 1.0), 2.0 * draw - 1.0);
  return mix(vec3(1.0), color, stars.tint) * (stars.brightness * night * smoothStep(0.0, 0.15, view.y) * light);
}

// --- The aurora ---

// A noise of its own, 0 to 1, for each use of a curtain.
float auroraNoise(int use, int curtain, vec3 around, float rate, float scale, int octaves, Aurora aurora) {
  vec3 place = around * (aurora.scale * scale) + vec3(0.0, rate * (0.04 * aurora.speed * aurora.time), 0.0);
  return fbmValue3(place, octaves, 0.5, aurora.seed + uint(16 * curtain + use));
}

vec3 auroraLight(vec3 view, float sun_height, Aurora aurora) {
  float night = smoothStep(aurora.high_height, aurora.low_height, sun_height);
  float low = sin(radians(aurora.bottom));
  float high = sin(radians(aurora.top));
  float across = length(view.xz);
  float height = (view.y - low) / (high - low);
  if (!(night > 0.0) || !(height > 0.0) || height >= 1.0 || !(across > 1e-4)) {
    return vec3(0.0);
  }
  vec3 around = vec3(view.x / across, 0.0, view.z / across);
  vec3 light = vec3(0.0);
  for (int curtain = 0; curtain < 3; curtain++) {
    float fold = auroraNoise(0, curtain, around, 1.0, 1.0, 3, aurora);
    float patch_here = smoothStep(0.36, 0.62, auroraNoise(1, curtain, around, 0.7, 0.7, 2, aurora));
    if (patch_here > 0.0) {
      float border = 0.08 + 0.16 * float(curtain) + 0.5 * (fold - 0.25);
      float ray = auroraNoise(2, curtain, around, 2.0, aurora.ray_scale, 2, aurora);
      float rise = 0.16 + 0.5 * auroraNoise(3, curtain, around, 1.3, 0.25 * aurora.ray_scale, 2, aurora) * ray;
      float x = (height - border) / rise;
      float edge = smoothStep(-0.12, 0.1, x) * exp(-2.2 * max(0.0, x));
      float bright = patch_here * edge * (0.25 + 1.5 * ray * ray) * (1.0 - 0.25 * float(curtain));
      light += mix(aurora.low_color, aurora.high_color, smoothStep(0.05, 0.8, x)) * bright;
    }
  }
  float rim = smoothStep(0.0, 0.08, height) * smoothStep(1.0, 0.6, height);
  return light * (aurora.strength * night * rim);
}

// --- The whole sky ---

// A sky with a smooth disc has neither a simple disc nor the glow of one: its disc.yz are 0.
vec3 nightSkyColor(vec3 view, Sky sky, Night night, vec4 craters[CRATERS]) {
  vec3 color = skyColor(view, sky);
  bool is_above = view.y + horizonDip(sky.viewer_height) >= 0.0;
  bool has_smooth_moon = night.has_moon && night.has_smooth_moon;
  if (night.has_smooth_disc || has_smooth_moon) {
    vec3 level = is_above ? view : atHorizon(view, sky.viewer_height);
    float line = is_above ? 1.0 : horizonLine(view.y, sky.horizon_exponent, sky.viewer_height);
    if (night.has_smooth_disc) {
      color += smoothDiscColor(level, sky.to_sun, sky.sun_color, night.smooth_disc) * line;
    }
    if (has_smooth_moon) {
      color += smoothMoonColor(level, night.moon) * line;
    }
  }
  if (is_above && night.has_stars) {
    float covered = night.has_moon ? moonCover(view, night.moon, night.has_smooth_moon) : 0.0;
    color += starLight(view, sky.to_sun.y, night.stars) * (1.0 - covered);
  }
  if (is_above && night.has_moon && !night.has_smooth_moon) {
    color += moonColor(view, night.moon, night.has_moon_picture, craters);
  }
  if (is_above && night.has_aurora) {
    color += auroraLight(view, sky.to_sun.y, night.aurora);
  }
  return color;
}
