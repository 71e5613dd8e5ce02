// The picture of a scene with layers, from its layers to the canvas.

// All layers over the sky.
export function drawComposed({ renderer, ground, noiseClouds, samplesPerSide }) {
  const { gpu, scene, view, hasClouds } = renderer, given = (has, name) => has ? name : 'nothing';
  gpu.fill([gpu.target('composed')], gpu.program('compose.frag', ['light', 'view']), {
    ...view, background: 'background', has_clouds: hasClouds, has_ground: !!ground, noise_clouds: noiseClouds.length,
    samples_per_side: samplesPerSide,
    cloud_colors: given(hasClouds, 'cloud colors'), cloud_places: given(hasClouds, 'cloud places'),
    ground_colors: given(ground, 'ground colors'), ground_places: given(ground, 'ground places'),
    part_colors: 'part colors', part_places: 'part places', fog_density: scene.distance_fog * view.fog, fog_scatter: scene.fog_scatter,
  });
}

// What is done to the composed picture, up to the canvas.
export function drawGraded({ renderer: { gpu, view }, settings: { grade } }) {
  const values = { ...view, composed: 'composed', developed: 'developed', sqrt_gamma: grade.sqrt_gamma };
  gpu.fill([gpu.target('developed')], gpu.program('develop.frag', ['tone']), values);
  if (grade.motion_blur && view.was) {
    const { eye, right, up, forward } = view.was, { motion_taps, motion_limit } = grade.motion_blur;
    gpu.fill([gpu.target('blurred')], gpu.program('motion.frag', ['view']),
      { ...values, was_eye: eye, was_right: right, was_up: up, was_forward: forward, motion_taps, motion_limit });
    values.developed = 'blurred';
  }
  gpu.fill([], gpu.program('grade.frag', ['tone', 'grade']), {
    ...values, has_vignette: !!grade.vignette, vignette: grade.vignette ?? { vignette: 1, vignette_exponent: 1 },
    has_contrast: !!grade.contrast, contrast: grade.contrast ?? { contrast: 0, lift: [0, 0, 0] },
  });
}
