// Noise on the integer lattice: the same hashes, and but for rounding the same values, as preview/backdrop/noise.h.

uint mixBits(uint x) {
  x ^= x >> 16u;
  x *= 0x7feb352du;
  x ^= x >> 15u;
  x *= 0x846ca68bu;
  return x ^ (x >> 16u);
}

uint hashAlong(uint hash, int coordinate) {
  return mixBits(hash ^ (uint(coordinate) * 0x9E3779B9u + 0x7F4A7C15u));
}

float unitFloat(uint hash) {
  return float(hash >> 8u) * 5.9604644775390625e-8;
}

// The blend to the next lattice point, and its slope.
vec2 quintic(float t) {
  return vec2(t * t * t * (t * (6.0 * t - 15.0) + 10.0), 30.0 * t * t * (t - 1.0) * (t - 1.0));
}

// The lattice points about a coordinate; they repeat after 'period' cells if that is over 0.
ivec2 latticePoints(float x, int period) {
  int cell = int(floor(x));
  if (period > 0) {
    cell = ((cell % period) + period) % period;
    int next = cell + 1;
    if (next == period) {
      next = 0;
    }
    return ivec2(cell, next);
  }
  return ivec2(cell, cell + 1);
}

float valueFace(uint hash, ivec2 along_x, ivec2 along_y, float weight_x, float weight_y) {
  uint low = hashAlong(hash, along_y.x);
  uint high = hashAlong(hash, along_y.y);
  float h00 = unitFloat(hashAlong(low, along_x.x));
  float h10 = unitFloat(hashAlong(low, along_x.y));
  float h01 = unitFloat(hashAlong(high, along_x.x));
  float h11 = unitFloat(hashAlong(high, along_x.y));
  return h00 + (h10 - h00) * weight_x + (h01 - h00) * weight_y + (h00 - h10 - h01 + h11) * weight_x * weight_y;
}

// Value noise, 0 to 1; 'seed' has gone through mixBits.
float valueNoise3(vec3 p, uint seed, int period) {
  ivec2 along_x = latticePoints(p.x, period);
  ivec2 along_y = latticePoints(p.y, period);
  ivec2 along_z = latticePoints(p.z, period);
  float weight_x = quintic(fract(p.x)).x;
  float weight_y = quintic(fract(p.y)).x;
  float low = valueFace(hashAlong(seed, along_z.x), along_x, along_y, weight_x, weight_y);
  float high = valueFace(hashAlong(seed, along_z.y), along_x, along_y, weight_x, weight_y);
  return low + (high - low) * quintic(fract(p.z)).x;
}

// Octaves: sum of gain^i n(2^i p + shift) over the sum of gain^i.
float fbmValue3(vec3 p, int octaves, float gain, uint seed) {
  float sum = 0.0;
  float total = 0.0;
  float weight = 1.0;
  float frequency = 1.0;
  for (int i = 0; i < octaves; i++) {
    float shift = float(i * i) * 0.3125;
    sum += weight * valueNoise3(p * frequency + vec3(shift, shift, shift), mixBits(seed + uint(i) * 0x632BE5ABu), 0);
    total += weight;
    weight *= gain;
    frequency *= 2.0;
  }
  return sum / total;
}

// A unit vector from a hash: a point on a square's rim, projected to the circle.
vec2 unitVector(uint hash) {
  float along = unitFloat(hash) * 4.0;
  float side = floor(along);
  float a = 2.0 * (along - side) - 1.0;
  vec2 on_rim = vec2(1.0, a);
  if (side == 1.0) {
    on_rim = vec2(-a, 1.0);
  } else if (side == 2.0) {
    on_rim = vec2(-1.0, -a);
  } else if (side == 3.0) {
    on_rim = vec2(a, -1.0);
  }
  return on_rim * (1.0 / sqrt(1.0 + a * a));
}

// The gradient of gradient noise.
vec2 gradientNoiseSlope(vec2 p, uint seed, int period) {
  ivec2 along_x = latticePoints(p.x, period);
  ivec2 along_y = latticePoints(p.y, period);
  uint low = hashAlong(seed, along_y.x);
  uint high = hashAlong(seed, along_y.y);
  vec2 g00 = unitVector(hashAlong(low, along_x.x));
  vec2 g10 = unitVector(hashAlong(low, along_x.y));
  vec2 g01 = unitVector(hashAlong(high, along_x.x));
  vec2 g11 = unitVector(hashAlong(high, along_x.y));
  vec2 part = fract(p);
  vec2 x = quintic(part.x);
  vec2 y = quintic(part.y);
  float h00 = dot(g00, part);
  float h10 = dot(g10, part - vec2(1.0, 0.0));
  float h01 = dot(g01, part - vec2(0.0, 1.0));
  float h11 = dot(g11, part - vec2(1.0, 1.0));
  float twist = h00 - h10 - h01 + h11;
  vec2 of_weights = vec2(x.y * (h10 - h00 + twist * y.x), y.y * (h01 - h00 + twist * x.x));
  vec2 of_corners = g00 + (g10 - g00) * x.x + (g01 - g00) * y.x + (g00 - g10 - g01 + g11) * x.x * y.x;
  return 1.41421356 * (of_weights + of_corners);
}

// The gradient of octaves of gradient noise, which repeats after 'period' cells if that is over 0.
vec2 fbmGradientSlope(vec2 p, int octaves, float gain, uint seed, int period) {
  vec2 sum = vec2(0.0, 0.0);
  float total = 0.0;
  float weight = 1.0;
  float frequency = 1.0;
  int cells = period;
  for (int i = 0; i < octaves; i++) {
    float shift = float(i * i) * 0.3125;
    sum += gradientNoiseSlope(p * frequency + vec2(shift, shift), mixBits(seed + uint(i) * 0x632BE5ABu), cells) * (weight * frequency);
    total += weight;
    weight *= gain;
    frequency *= 2.0;
    cells *= 2;
  }
  return sum / total;
}

// Value noise and its gradient at a place in a cell, 0 to 1 along each side; 'seed' has gone through mixBits.
vec3 valueNoiseInCell(vec2 cell, vec2 part, uint seed, int period) {
  ivec2 along_x = latticePoints(cell.x, period);
  ivec2 along_y = latticePoints(cell.y, period);
  uint low = hashAlong(seed, along_y.x);
  uint high = hashAlong(seed, along_y.y);
  float h00 = unitFloat(hashAlong(low, along_x.x));
  float b = unitFloat(hashAlong(low, along_x.y)) - h00;
  float h01 = unitFloat(hashAlong(high, along_x.x));
  float c = h01 - h00;
  float d = h00 - (b + h00) - h01 + unitFloat(hashAlong(high, along_x.y));
  vec2 x = quintic(part.x);
  vec2 y = quintic(part.y);
  return vec3(h00 + b * x.x + c * y.x + d * x.x * y.x, x.y * (b + d * y.x), y.y * (c + d * x.x));
}

vec3 valueNoise2(vec2 p, uint seed, int period) {
  return valueNoiseInCell(floor(p), fract(p), seed, period);
}

// Octaves of value noise and their gradient.
vec3 fbmValue2(vec2 p, int octaves, float gain, uint seed) {
  vec3 sum = vec3(0.0, 0.0, 0.0);
  float total = 0.0;
  float weight = 1.0;
  float frequency = 1.0;
  for (int i = 0; i < octaves; i++) {
    float shift = float(i * i) * 0.3125;
    vec3 octave = valueNoise2(p * frequency + vec2(shift, shift), mixBits(seed + uint(i) * 0x632BE5ABu), 0);
    sum += octave * (weight * vec3(1.0, frequency, frequency));
    total += weight;
    weight *= gain;
    frequency *= 2.0;
  }
  return sum / total;
}

// As fbmValue3, but once the octaves so far rule out a value under 'limit', the rest is left out.
float fbmValueUnder3(vec3 p, int octaves, float gain, uint seed, float limit) {
  float total = 0.0;
  float weight = 1.0;
  for (int i = 0; i < octaves; i++) {
    total += weight;
    weight *= gain;
  }
  float sum = 0.0;
  float frequency = 1.0;
  weight = 1.0;
  for (int i = 0; i < octaves; i++) {
    float shift = float(i * i) * 0.3125;
    sum += weight * valueNoise3(p * frequency + vec3(shift, shift, shift), mixBits(seed + uint(i) * 0x632BE5ABu), 0);
    if (sum / total >= limit) {
      break;
    }
    weight *= gain;
    frequency *= 2.0;
  }
  return sum / total;
}
