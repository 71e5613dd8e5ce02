// Depth textures of three.js.

// The distance along the view's axis of a texel of a depth texture, for near and far plane.
export const SOLID_DISTANCE = `
#include <packing>

float solidDistance(highp sampler2D image, ivec2 at, vec2 clip) {
  float depth = texelFetch(image, at, 0).r;
  #if defined(USE_LOGARITHMIC_DEPTH_BUFFER) || defined(USE_LOGDEPTHBUF)  // the name in older ones
    return exp2(depth * log2(clip.y + 1.0)) - 1.0;
  #else
    return -perspectiveDepthToViewZ(depth, clip.x, clip.y);
  #endif
}
`;
