// Dust as a layer, in parts before, between and behind surfaces. latticeTransmittance of core/harmonic_lattice.h: the light of a cell in
// the two directions is computed once (viewer/layers/dust.js), because it is mixed between cells as the coefficients are.
uniform Dust dust;
uniform highp sampler2DArray lattice;  // of each cell, T towards the light and towards the sky, not limited to 0 to 1
uniform vec4 ball_x, ball_y, ball_z;  // rows of the way to the unit ball
uniform vec4 cell_x, cell_y, cell_z;  // and to the cells
uniform vec2 powers;                  // of T, by direction
uniform float longest;
uniform vec3 to_light, light_color, ambient_sky;
uniform float fewer;  // 1, or more while something moves

vec3 byRows(vec4 x, vec4 y, vec4 z, vec4 p) {
  return vec3(dot(x, p), dot(y, p), dot(z, p));
}

vec2 latticeAt(vec3 at) {
  ivec3 cells = textureSize(lattice, 0);
  vec3 inside = clamp(at, vec3(0.0), vec3(cells - 1));
  ivec3 low = ivec3(inside);
  ivec3 high = min(low + 1, cells - 1);
  vec3 part = inside - vec3(low);
  vec2 sum = vec2(0.0);
  for (int corner = 0; corner < 8; corner++) {
    bvec3 is_high = bvec3((corner & 1) != 0, (corner & 2) != 0, (corner & 4) != 0);
    vec3 weight = mix(1.0 - part, part, is_high);
    ivec3 cell = ivec3(is_high.x ? high.x : low.x, is_high.y ? high.y : low.y, is_high.z ? high.z : low.z);
    sum += texelFetch(lattice, cell, 0).xy * (weight.x * weight.y * weight.z);
  }
  return sum;
}

// The way from a point to where it enters the box of the cells; negative if it does not.
float wayIntoBox(vec3 from, vec3 along) {
  vec3 last = vec3(textureSize(lattice, 0) - 1);
  float enter = 0.0;
  float leave = NOWHERE;
  for (int axis = 0; axis < 3; axis++) {
    if (along[axis] == 0.0) {
      if (from[axis] < 0.0 || from[axis] > last[axis]) {
        return -1.0;
      }
    } else {
      float a = -from[axis] / along[axis];
      float b = (last[axis] - from[axis]) / along[axis];
      enter = max(enter, min(a, b));
      leave = min(leave, max(a, b));
    }
  }
  return enter <= leave ? enter : -1.0;
}

float shareTowards(vec3 from, vec3 direction, int index) {
  vec3 along = byRows(cell_x, cell_y, cell_z, vec4(direction, 0.0));
  float way = wayIntoBox(from, along);
  if (way < 0.0) {
    return 1.0;
  }
  float through = clamp(latticeAt(from + along * way)[index], 0.0, 1.0);
  return abs(powers[index] - 1.0) < 1e-5 ? through : pow(through, powers[index]);
}

vec2 dustLight(vec3 point) {
  vec3 at = byRows(cell_x, cell_y, cell_z, vec4(point, 1.0));
  return vec2(shareTowards(at, to_light, 0), shareTowards(at, vec3(0.0, 1.0, 0.0), 1));
}

void main() {
  Dust drawn = dust;
  drawn.samples = max(1, int(float(dust.samples) / fewer));
  Cuts cuts = cutsAt(ivec2(gl_FragCoord.xy), samples_per_side);
  vec3 view = viewDirection(samplePlace(gl_FragCoord.xy, samples_per_side));
  float jitter = dust.dither * (jitterAt(dust.seed) - 0.5);
  mat4 ball = mat4(ball_x, ball_y, ball_z, vec4(0.0));
  writeParts(marchDust(eye, view, ball, longest, to_light, light_color, ambient_sky, jitter, cuts, drawn), cuts, 1.0);
}
