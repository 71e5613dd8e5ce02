// What each ray meets of a slab: opacities, distances, and den and facing where it begins, of three parts.
uniform Slab slab;
uniform int samples_per_side;
uniform float fewer;  // 1, or more while something moves
layout(location = 0) out vec4 opacities;
layout(location = 1) out vec4 distances;
layout(location = 2) out vec4 dens;
layout(location = 3) out vec4 facings;

void main() {
  Slab drawn = slab;
  drawn.samples = max(1, int(float(slab.samples) / fewer));
  ivec2 at = ivec2(gl_FragCoord.x, picture.y * float(samples_per_side) - gl_FragCoord.y);
  vec3 view = viewDirection(gl_FragCoord.xy / float(samples_per_side));
  opacities = vec4(0.0);
  distances = vec4(NOWHERE);
  dens = facings = vec4(0.0);
  if (slabHorizonFade(view.y, slab) > 0.0) {
    float jitter = slab.dither * uniformFloat(hashDraw(pixelStream(slab.seed), uint(at.x), uint(at.y)));
    SlabHits hits = marchSlab(eye, view, jitter, cutsAt(ivec2(gl_FragCoord.xy), samples_per_side), drawn);
    opacities = vec4(hits.opacities, 0.0);
    distances = vec4(hits.distances, NOWHERE);
    dens = vec4(hits.dens, 0.0);
    facings = vec4(hits.facings, 0.0);
  }
}
