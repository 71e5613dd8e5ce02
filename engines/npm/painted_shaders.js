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

// The clouds over the rest of the scene, in the colours of the screen or of the next pass. `head` declares the output gl_FragColor, and
// `float distanceBehind(ivec2 at)`, along the view's axis; `toScreen` are statements for tones of the engine.
export const compositeOf = ({ head = '', toScreen = '' }) => `
${head}
#include "light.glsl"
#include "noise.glsl"
#include "soft.glsl"
#include "view.glsl"
#include "channel_sum.glsl"
uniform vec3 to_sun, sun_color, ambient_sky, ambient_ground;
#include "composite.glsl"
#include "solid.glsl"
#include "tone.glsl"
uniform float exposure;
uniform highp sampler2D behind;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec3 color = behindClouds(texelFetch(behind, at, 0).rgb, visibleChannels(at, distanceBehind(at)), at);
  gl_FragColor = vec4(color, 1.0);
  #ifdef OWN_TONE
    gl_FragColor.rgb = toneMap(color, exposure) + ditherOffset(ivec2(at.x, int(picture.y) - 1 - at.y));
  #else
    ${toScreen}
  #endif
}
`;
