// The tones and the outline of a slab that slab_march.frag has met.
uniform Slab slab;
uniform highp sampler2D march_0, march_1, march_2, march_3;  // opacities, distances, den, facing
uniform int samples_per_side;
layout(location = 0) out vec4 color_0;
layout(location = 1) out vec4 color_1;
layout(location = 2) out vec4 color_2;
layout(location = 3) out vec4 places;

// Of all parts. Beyond the rim the outermost sample counts.
float opacityAt(ivec2 at) {
  return texelFetch(march_0, clamp(at, ivec2(0), textureSize(march_0, 0) - 1), 0).z;
}

// Length of Sobel's gradient, per sample.
float gradientAt(ivec2 at) {
  vec2 slope;
  for (int axis = 0; axis < 2; axis++) {
    ivec2 along = axis == 0 ? ivec2(1, 0) : ivec2(0, 1);
    ivec2 across = along.yx;
    float ahead = opacityAt(at + along - across) + 2.0 * opacityAt(at + along) + opacityAt(at + along + across);
    float back = opacityAt(at - along - across) + 2.0 * opacityAt(at - along) + opacityAt(at - along + across);
    slope[axis] = (ahead - back) / 8.0;
  }
  return length(slope);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 opacities = texelFetch(march_0, at, 0);
  vec4 colors[3];
  vec4 met = vec4(NOWHERE);
  for (int part = 0; part < 3; part++) {
    colors[part] = vec4(0.0);
  }
  if (opacities.z > 0.0) {
    vec4 distances = texelFetch(march_1, at, 0);
    vec4 dens = texelFetch(march_2, at, 0);
    vec4 facings = texelFetch(march_3, at, 0);
    vec3 view = viewDirection(gl_FragCoord.xy / float(samples_per_side));
    float fade = slabHorizonFade(view.y, slab);
    float degrees = 2.0 * atan(0.5 * picture.y * per_pixel) * 57.29577951;
    float samples_per_degree = picture.y * float(samples_per_side) / degrees;
    float edge = smoothStep(slab.outline_start, slab.outline_full, gradientAt(at) * samples_per_degree);
    float before = 0.0;
    for (int part = 0; part < 3; part++) {
      float so_far = opacities[part] * fade;
      if (so_far > before) {
        vec3 color = mix(slabTone(dens[part], facings[part], slab), slab.outline, slab.outline_strength * edge);
        colors[part] = vec4(color, (so_far - before) / (1.0 - before));
        met[part] = distances[part];
      }
      before = so_far;
    }
  }
  places = met;
  color_0 = colors[0];
  color_1 = colors[1];
  color_2 = colors[2];
}
