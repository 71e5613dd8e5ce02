// Counter-based random numbers: the same bits as core/random.h. A number of 64 bits is a uvec2, the low half first.

uvec2 wideProduct(uint a, uint b) {
  uint a0 = a & 0xffffu;
  uint a1 = a >> 16u;
  uint b0 = b & 0xffffu;
  uint b1 = b >> 16u;
  uint low = a0 * b0;
  uint across = a0 * b1;
  uint aside = a1 * b0;
  uint middle = (low >> 16u) + (across & 0xffffu) + (aside & 0xffffu);
  return uvec2((low & 0xffffu) | (middle << 16u), a1 * b1 + (across >> 16u) + (aside >> 16u) + (middle >> 16u));
}

uvec2 product64(uvec2 a, uvec2 b) {
  uvec2 low = wideProduct(a.x, b.x);
  return uvec2(low.x, low.y + a.x * b.y + a.y * b.x);
}

uvec2 sum64(uvec2 a, uvec2 b) {
  uint low = a.x + b.x;
  return uvec2(low, a.y + b.y + (low < a.x ? 1u : 0u));
}

// z ^ (z >> bits), bits under 32.
uvec2 folded64(uvec2 z, uint bits) {
  return z ^ uvec2((z.x >> bits) | (z.y << (32u - bits)), z.y >> bits);
}

uvec2 mix64(uvec2 z) {
  z = product64(folded64(z, 30u), uvec2(0x1CE4E5B9u, 0xBF58476Du));
  z = product64(folded64(z, 27u), uvec2(0x133111EBu, 0x94D049BBu));
  return folded64(z, 31u);
}

const uvec2 GOLDEN = uvec2(0x7F4A7C15u, 0x9E3779B9u);

uvec2 hashDraw(uvec2 stream, uint ray, uint dimension) {
  uint next = ray + 1u;
  return mix64(sum64(stream, product64(uvec2(next, dimension + (next == 0u ? 1u : 0u)), GOLDEN)));
}

// The stream of a layer's pixels.
uvec2 pixelStream(uint seed) {
  return mix64(sum64(uvec2(seed, 0u), GOLDEN));
}

float uniformFloat(uvec2 hash) {
  return float(hash.y >> 8u) * 5.9604644775390625e-8;
}
