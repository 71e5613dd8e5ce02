// The lobe formula alone: preview/mesh_clouds/render.cpp.

// The largest number of surfaces at any pixel. Each pass looks at blocks of 8 x 8 pixels.
function mostSurfaces({ gpu }) {
  const { gl } = gpu, most = new Float32Array(4);
  let counts = 'signs', { width, height } = gpu.size;
  for (let level = 0; level === 0 || width * height > 1; ++level) {
    [width, height] = [Math.ceil(width / 8), Math.ceil(height / 8)];
    const next = gpu.target(`most ${level}`, { width, height });
    gpu.fill([next], gpu.program('most.frag'), { counts });
    counts = next.name;
  }
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.FLOAT, most);
  return most[1];
}

// The sums of the signs of all surfaces, and their number, at each pixel.
function drawSigns({ gpu, vertices, view }, place) {
  const { gl } = gpu;
  gpu.clear([gpu.target('signs', gpu.size, gl.RGBA16F)], [0, 0, 0, 0]);
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.ONE, gl.ONE);
  vertices.draw('signs.frag', view, gpu.size, place);
  gl.disable(gl.BLEND);
}

// The clouds before the sky, at one sample of each pixel: their surfaces, or the volume inside them, left and right of the divider.
export function drawPlainSample(renderer, place) {
  const { gpu, view, volume } = renderer, offset = [place[0] - 0.5, 0.5 - place[1]];
  const sides = [view.light, view.against === 'none' ? view.light : view.against].map(name => name === 'volume' && volume ? 1 : 0);
  if (sides.includes(0)) drawSurfaces(renderer, place, offset);
  if (!sides.includes(1)) return;
  renderer.fillBox([gpu.target('sample')], gpu.program('volume.frag', ['light', 'sky', 'view', 'sky_uniforms', 'march']),
    { ...view, ...volume.values(view.density), sides, divider: view.split * gpu.size.width, offset });
}

// All surfaces, from the nearest to the farthest, and the light along the view through them.
function drawSurfaces(renderer, place, offset) {
  const { gpu, vertices, look, scene, view } = renderer, { gl, size } = gpu, { first_surface = false } = look;
  const view_extinction = look.view_extinction * scene.parts[0].extinction * view.density;
  const values = { ...view, signs: 'signs', surface: 'surface', own: 'own', view_extinction, first_surface };
  drawSigns(renderer, place);
  for (const name of ['color', 'entry', 'entry own']) for (const i of [0, 1]) gpu.target(`${name} ${i}`);
  const depths = [0, 1].map(i => gpu.target(`layer depth ${i}`, size, gl.DEPTH_COMPONENT32F));
  gpu.drawTo([], depths[1]);
  gl.clearBufferfv(gl.DEPTH, 0, [0]);
  const count = mostSurfaces(renderer);
  for (let i = 0; i < count; ++i) {
    const from = (i + 1) % 2, to = i % 2;
    gpu.drawNearest(['surface', 'own'].map(name => gpu.target(name)), depths[to],
      () => vertices.draw('surface.frag', view, size, place, { nearer: depths[from].name, has_own: renderer.hasOwnColors }));
    renderer.fillBox(['color', 'entry', 'entry own'].map(name => gpu.target(`${name} ${to}`)), gpu.program('layer.frag', ['light']), {
      ...values, sun_color: view.light_color, is_first: i === 0,
      colors: `color ${from}`, entries: `entry ${from}`, entry_owns: `entry own ${from}`,
    });
  }
  renderer.fillBox([gpu.target('sample')], gpu.program('plain_sample.frag', ['sky', 'view', 'sky_uniforms']),
    { ...values, color: `color ${(count + 1) % 2}`, is_empty: count === 0, offset });
}
