// The march of the volume inside a mesh: preview/compare/volume.cpp. Lengths are in cells, and the centre of cell (i, j, k) is (i, j, k).
uniform highp sampler3D volume;  // of each cell: the share that is inside, how much cloud is between its centre and the sun and the sky
uniform vec3 volume_origin;      // of the centre of the first cell, in the world
uniform float cell_size;         // world units
uniform vec3 extent_low, extent_high;  // there is no cloud outside
uniform float volume_side;             // the longest side of the cells with cloud
uniform vec2 extinctions;              // per cell: towards the light, along the view
uniform ivec2 march_steps;             // along the longest side; octaves beyond the first
uniform vec4 octaves;                  // an octave's share of the one before in extinction, weight and asymmetry; the first one's asymmetry
uniform vec3 to_light;

const float OPAQUE = 1e-5;

// The light behind a length of cloud. 'of_sun': it is scattered by the angle whose cosine is given; light of the sky evenly.
float lightBehind(float inside, bool of_sun, float cosine) {
  float weight = 1.0, extinction = extinctions.x, asymmetry = octaves.w, sum = 0.0, weights = 0.0;
  for (int i = 0; i <= march_steps.y; i++) {
    sum += weight * (of_sun ? henyeyGreenstein(cosine, asymmetry) : 1.0) * exp(-extinction * inside);
    weights += weight;
    extinction *= octaves.x;
    weight *= octaves.y;
    asymmetry *= octaves.z;
  }
  return sum / weights;
}

vec2 lightsBehind(vec2 inside, float cosine) {
  return vec2(lightBehind(inside.x, true, cosine), lightBehind(inside.y, false, cosine));
}

vec4 volumeAt(vec3 place) {
  return textureLod(volume, (place + 0.5) / vec3(textureSize(volume, 0)), 0.0);
}

// The opacity along a ray of the world, and the light of sun and sky that comes back, divided by it; without cloud those of its start.
vec3 lightAlong(vec3 start, vec3 direction) {
  vec3 from = (start - volume_origin) / cell_size;
  vec3 one = (extent_low - from) / direction;
  vec3 other = (extent_high - from) / direction;
  vec3 nearer = min(one, other);
  vec3 farther = max(one, other);
  float enter = max(0.0, max(nearer.x, max(nearer.y, nearer.z)));
  float way = min(farther.x, min(farther.y, farther.z)) - enter;
  float cosine = dot(direction, to_light);
  float count = max(1.0, ceil(way * float(march_steps.x) / volume_side));
  float size = way / count;
  vec2 sum = vec2(0.0);
  float through = 1.0;
  for (float i = 0.5; i < count && way > 0.0 && through > OPAQUE; i++) {
    vec4 here = volumeAt(from + direction * (enter + i * size));
    if (here.x > 0.0) {
      float passed = exp(-extinctions.y * here.x * size);
      sum += through * (1.0 - passed) * lightsBehind(here.yz, cosine);
      through *= passed;
    }
  }
  float opacity = 1.0 - through;
  return opacity > 0.0 ? vec3(opacity, sum / opacity) : vec3(0.0, lightsBehind(volumeAt(from).yz, cosine));
}
