// The operations of the passes that the page of `cloudbake view` draws: every pass is drawn a second time, with the twins of its shaders
// (counted_shader.mjs) and the same uniforms, to a texture whose pixels are added up.
import { countedFragment, countedVertex, VERTEX_COUNTS } from './counted_shader.mjs';

// In the page: notes the files of every program, and counts the passes whose twins are known.
function watch() {
  const { renderer, renderer: { gpu } } = window.viewer, { gl, program, use, shaderText } = gpu;
  const { drawArrays, drawElements, beginTransformFeedback } = gl;
  const twins = {}, framebuffer = gl.createFramebuffer();
  let drawn, feedback;
  window.counting = { twins, passes: {}, fragments: {}, vertices: {} };

  gpu.shaderText = name => twins[name] ?? shaderText(name);
  gpu.program = (fragment, uses = [], vertex = 'screen.vert', vertexUses = [], kept = []) => {
    const key = [...uses, fragment].join(' '), { fragments, vertices } = window.counting;
    fragments[key] ??= [...uses, fragment].map(shaderText);
    if (vertex !== 'screen.vert') vertices[vertex] ??= [...vertexUses, vertex].map(shaderText);
    return Object.assign(program.call(gpu, fragment, uses, vertex, vertexUses, kept), { key, vertex, vertexUses });
  };
  gpu.use = (made, values) => {
    drawn = { made, values };
    use.call(gpu, made, values);
  };

  // Adds what draw() leaves in a box of a texture to the counts of a pass; `count`: of its pixels or vertices.
  const add = (name, { width, height }, [left, bottom, across, upwards], has_depth, draw, count) => {
    const switches = [gl.SCISSOR_TEST, gl.BLEND, gl.DEPTH_TEST, gl.RASTERIZER_DISCARD].map(key => [key, gl.isEnabled(key)]);
    const before = gl.getParameter(gl.FRAMEBUFFER_BINDING), blend = [gl.BLEND_SRC_RGB, gl.BLEND_DST_RGB].map(key => gl.getParameter(key));
    const viewport = gl.getParameter(gl.VIEWPORT);
    const counts = gpu.target(`counts of ${name}`, { width, height }, gl.RGBA32F);
    const depth = has_depth && gpu.target('counted depth', { width, height }, gl.DEPTH_COMPONENT32F);
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, counts.texture, 0);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, depth ? depth.texture : null, 0);
    gl.viewport(0, 0, width, height);
    gl.disable(gl.RASTERIZER_DISCARD);
    gl.disable(gl.SCISSOR_TEST);
    gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
    if (depth) gl.clearBufferfv(gl.DEPTH, 0, [1]);
    if (switches[0][1]) gl.enable(gl.SCISSOR_TEST);
    gl.enable(gl.BLEND);  // surfaces that lie behind each other add up
    gl.blendFunc(gl.ONE, gl.ONE);
    draw();
    const found = new Float32Array(4 * across * upwards), pass = window.counting.passes[name] ??= { drawn: 0, sums: [0, 0, 0, 0] };
    gl.readPixels(left, bottom, across, upwards, gl.RGBA, gl.FLOAT, found);
    for (let i = 0; i < found.length; ++i) pass.sums[i % 4] += found[i];
    pass.drawn += count;
    for (const [key, is_on] of switches) gl[is_on ? 'enable' : 'disable'](key);
    gl.blendFunc(...blend);
    gl.bindFramebuffer(gl.FRAMEBUFFER, before);
    gl.viewport(...viewport);
  };

  // Counts the pixels of a draw, and its vertices if they are more than the corners of the screen.
  const count = (draw, first, vertices, has_pixels) => {
    const { made, values } = drawn, { key, vertex, vertexUses } = made, viewport = gl.getParameter(gl.VIEWPORT);
    if (twins[`counted ${key}`] && has_pixels) {
      const box = gl.isEnabled(gl.SCISSOR_TEST) ? gl.getParameter(gl.SCISSOR_BOX) : viewport;
      add(key, { width: viewport[2], height: viewport[3] }, box, gl.isEnabled(gl.DEPTH_TEST), () => {
        use.call(gpu, program.call(gpu, `counted ${key}`, [], vertex, vertexUses), values);
        draw();
      }, box[2] * box[3]);
    }
    if (twins[`counted ${vertex}`]) {
      const size = { width: 1024, height: Math.ceil((first + vertices) / 1024) };
      add(vertex, size, [0, 0, size.width, size.height], false, () => {
        for (const test of [gl.SCISSOR_TEST, gl.DEPTH_TEST]) gl.disable(test);
        use.call(gpu, program.call(gpu, 'vertex counts', [], `counted ${vertex}`),
          { ...values, counted_size: [size.width, size.height] });
        drawArrays.call(gl, gl.POINTS, first, vertices);
      }, vertices);
    }
    use.call(gpu, made, values);
  };
  gl.beginTransformFeedback = mode => { feedback = mode; };
  gl.drawArrays = (mode, first, number) => {
    count(() => drawArrays.call(gl, mode, first, number), first, number, feedback === undefined);
    if (feedback !== undefined) beginTransformFeedback.call(gl, feedback);
    feedback = undefined;
    drawArrays.call(gl, mode, first, number);
  };
  gl.drawElements = (...call) => {
    count(() => drawElements.apply(gl, call), 0, renderer.scene.arrays.positions.length / 3, true);
    drawElements.apply(gl, call);
  };
}

// The counts of every pass of draw(given), which the page runs twice, first to learn which programs there are: { drawn, sums } by the names
// of a pass's files, or by the name of a vertex shader. `drawn`: its pixels or vertices; `sums`: of floats, integers, special, fetches.
export async function countedPasses(page, draw, given) {
  if (!await page.evaluate(() => !!window.counting)) await page.evaluate(watch);
  await page.evaluate(draw, given);
  const { fragments, vertices } = await page.evaluate(() => window.counting), twins = { 'vertex counts': VERTEX_COUNTS };
  for (const [name, files] of Object.entries(fragments)) twins[`counted ${name}`] = countedFragment(files);
  for (const [name, files] of Object.entries(vertices)) twins[`counted ${name}`] = countedVertex(files);
  await page.evaluate(all => {
    Object.assign(window.counting.twins, all);
    window.counting.passes = {};
  }, twins);
  await page.evaluate(draw, given);
  return page.evaluate(() => {
    const error = window.viewer.renderer.gpu.gl.getError();
    if (error) throw new Error(`WebGL error ${error}`);
    return window.counting.passes;
  });
}
