// What the passes use of GLSL: images without a filter.
float4 texelFetch(Texture2D<float4> image, int2 at, int level) {
  return image.Load(int3(at, level));
}

int2 textureSize(Texture2D<float4> image, int level) {
  uint width, height;
  image.GetDimensions(width, height);
  return int2(width, height);
}

bool2 equal(float2 a, float2 b) {
  return a == b;
}

