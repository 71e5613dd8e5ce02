// The shaders of PaintedClouds: the steps of the painted look.

export const SCREEN = `
#include "screen.vert.glsl"
`;

// Each takes images and writes one.
export const STEPS = {
  accumulate: `
#include "accumulate.frag.glsl"
`,
  mean: `
#include "mean.frag.glsl"
`,
  weighted: `
#include "weighted.frag.glsl"
`,
  box: `
#include "box.frag.glsl"
`,
  spread: `
#include "spread.frag.glsl"
`,
  soft: `
#include "soft.frag.glsl"
`,
  distort: `
#include "noise.glsl"
#include "channel_sum.glsl"
#include "distort.frag.glsl"
`,
  erode: `
#include "noise.glsl"
#include "view.glsl"
#include "erode.frag.glsl"
`,
};

// The clouds over the rest of the scene, in the colours of the screen or of the next pass.
export const COMPOSITE = `
#include <packing>
#include "light.glsl"
#include "view.glsl"
#include "channel_sum.glsl"
uniform vec3 to_sun, sun_color, ambient_sky, ambient_ground;
#include "composite.glsl"
#include "tone.glsl"
uniform float exposure;
uniform highp sampler2D behind, behind_depth;
uniform vec2 clip;  // near and far plane

float distanceBehind(ivec2 at) {
  float depth = texelFetch(behind_depth, at, 0).r;
  #if defined(USE_LOGARITHMIC_DEPTH_BUFFER) || defined(USE_LOGDEPTHBUF)  // the name in older ones
    return exp2(depth * log2(clip.y + 1.0)) - 1.0;
  #else
    return -perspectiveDepthToViewZ(depth, clip.x, clip.y);
  #endif
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec3 color = texelFetch(behind, at, 0).rgb;
  if (distanceOf(channelsAt(channels, at), at) < distanceBehind(at)) {
    color = withClouds(color, at);
  }
  gl_FragColor = vec4(color, 1.0);
  #ifdef OWN_TONE
    gl_FragColor.rgb = toneMap(color, exposure) + ditherOffset(ivec2(at.x, int(picture.y) - 1 - at.y));
  #else
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
  #endif
}
`;
