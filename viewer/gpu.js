// The graphics card: programs and targets by their names, and drawing over whole targets.

import { linkedProgram, useProgram } from './programs.js';

export class Gpu {
  constructor(canvas, shaderText) {
    this.canvas = canvas;
    this.shaderText = shaderText;
    /** @type {WebGL2RenderingContext} */
    this.gl = canvas.getContext('webgl2', { alpha: false, antialias: false, depth: false, preserveDrawingBuffer: true });
    if (!this.gl) throw new Error('This browser has no WebGL2, or it is switched off.');
    this.colorFormat = this.gl.getExtension('EXT_color_buffer_float') ? this.gl.RGBA32F
      : this.gl.getExtension('EXT_color_buffer_half_float') ? this.gl.RGBA16F : null;
    if (!this.colorFormat) throw new Error('This graphics card cannot draw to textures of floats.');
    // Targets that are blended need more than colour buffers of floats.
    this.blendedFormat = this.gl.getExtension('EXT_float_blend') ? this.colorFormat : this.gl.RGBA16F;
    this.size = { width: canvas.width, height: canvas.height };  // of the picture; the canvas takes it once it is shown
    this.programs = {};
    /** @type {Record<string, Target>} */
    this.targets = {};
    this.framebuffer = this.gl.createFramebuffer();
    /** What is drawn to in place of the canvas. @type {Target | null} */
    this.screen = null;
  }

  // A program of `vertex` and `fragment` after the files of functions that they use. `kept`: a result of `vertex` that goes to a buffer.
  program(fragment, uses = [], vertex = 'screen.vert', vertexUses = [], kept = []) {
    const key = [vertex, ...uses, fragment].join(' '), textOf = files => files.map(this.shaderText).join('\n');
    return this.programs[key] ??= linkedProgram(this.gl,
      { vertex: textOf([...vertexUses, vertex]), fragment: textOf([...uses, fragment]), name: fragment, kept });
  }

  use(program, values) { useProgram(this.gl, program, values, this.targets); }

  // --- Targets ---

  /** A texture for drawing to, of the picture's size unless another is given. @param {number} format @returns {Target} */
  target(name, { width, height } = this.size, format = this.colorFormat) {
    const { gl } = this, known = this.targets[name];
    if (known && known.width === width && known.height === height) return known;
    const texture = this.newTexture(name, gl.TEXTURE_2D);
    gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
    return this.targets[name] = { name, texture, width, height };
  }

  /** A texture of layers, each a target of its own. @returns {Target} */
  arrayTarget(name, depth, { width, height }) {
    const { gl } = this, known = this.targets[name];
    if (known && known.width === width && known.height === height && known.depth === depth) return known;
    const texture = this.newTexture(name, gl.TEXTURE_2D_ARRAY);
    gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, this.colorFormat, width, height, depth);
    const layers = Array.from({ length: depth }, (_, layer) => ({ name, texture, width, height, layer }));
    return this.targets[name] = { name, texture, width, height, depth, layers };
  }

  // A texture of numbers that were computed here, of layers if it has a depth.
  upload(name, { width, height, depth = 0 }, format, components, numbers) {
    const { gl } = this, kind = depth ? gl.TEXTURE_2D_ARRAY : gl.TEXTURE_2D, texture = this.newTexture(name, kind);
    if (depth) gl.texImage3D(kind, 0, format, width, height, depth, 0, components, gl.FLOAT, numbers);
    else gl.texImage2D(kind, 0, format, width, height, 0, components, gl.FLOAT, numbers);
    this.targets[name] = { name, texture, width, height };
  }

  // A texture of four numbers per place in space, or one, which is read between them: half floats.
  uploadSpace(name, [width, height, depth], numbers, format = /** @type {number} */ (this.gl.RGBA16F),
    components = /** @type {number} */ (this.gl.RGBA)) {
    const { gl } = this, kind = gl.TEXTURE_3D, texture = this.newTexture(name, kind);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(kind, filter, gl.LINEAR);
    for (const edge of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R]) gl.texParameteri(kind, edge, gl.CLAMP_TO_EDGE);
    gl.texImage3D(kind, 0, format, width, height, depth, 0, components, gl.FLOAT, numbers);
    this.targets[name] = { name, texture, width, height };
  }

  // Shares of the light in space.
  uploadShares(name, size, numbers) { this.uploadSpace(name, size, numbers, this.gl.R16F, this.gl.RED); }

  // In place of the one that had the name.
  newTexture(name, kind) {
    const { gl } = this, texture = gl.createTexture();
    if (this.targets[name]) gl.deleteTexture(this.targets[name].texture);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(kind, texture);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(kind, filter, gl.NEAREST);
    return texture;
  }

  // --- Drawing ---

  // From here on everything is drawn to these targets, or to the canvas if there are none.
  drawTo(targets, depth = null) {
    if (this.screen && !targets.length && !depth) targets = [this.screen];
    const { gl } = this, { width, height } = targets[0] ?? depth ?? this.size;
    if (targets.length || depth) this.attach(targets, depth);
    else this.showCanvas(width, height);
    gl.viewport(0, 0, width, height);
  }

  attach(targets, depth) {
    const { gl } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
    for (let i = 0; i < 4; ++i) {
      const { texture, layer } = targets[i] ?? { texture: null };
      if (layer === undefined) gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + i, gl.TEXTURE_2D, texture, 0);
      else gl.framebufferTextureLayer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + i, texture, 0, layer);
    }
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, depth?.texture ?? null, 0);
    gl.drawBuffers(targets.map((_, i) => gl.COLOR_ATTACHMENT0 + i));
  }

  showCanvas(width, height) {
    this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, null);
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
  }

  // Makes targets of one colour.
  clear(targets, color) {
    this.drawTo(targets);
    targets.forEach((_, i) => this.gl.clearBufferfv(this.gl.COLOR, i, color));
  }

  // Draws over the whole of targets.
  fill(targets, program, values) {
    this.drawTo(targets);
    this.use(program, values);
    this.gl.drawArrays(this.gl.TRIANGLES, 0, 3);
  }

  // Multiplies what a target has.
  multiply(targets, program, values) {
    const { gl } = this;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ZERO, gl.SRC_COLOR);
    this.fill(targets, program, values);
    gl.disable(gl.BLEND);
  }

  // As fill, but only within a box; the rest gets the value `other`. Targets of another size than the picture's are filled.
  fillBox(box, targets, program, values, other = [0, 0, 0, 1]) {
    const key = `${box} ${other}`;
    const is_whole = targets.some(({ width, height }) => width !== this.size.width || height !== this.size.height);
    for (const target of targets) {
      if (is_whole || target.box === key) continue;
      this.clear([target], other);
      target.box = key;
    }
    if (is_whole) this.fill(targets, program, values);
    else this.fillPart(box, targets, program, values);
  }

  // As fill, but only within a box of the targets' pixels; the rest stays.
  fillPart(box, targets, program, values) {
    const { gl } = this, [left, bottom, right, top] = box;
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(left, bottom, right - left, top - bottom);
    this.fill(targets, program, values);
    gl.disable(gl.SCISSOR_TEST);
  }

  // Copies what a box of a target has to another one.
  copyPart(box, from, to) {
    const { gl } = this, [left, bottom, right, top] = box;
    this.drawTo([from]);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, to.texture);
    gl.copyTexSubImage2D(gl.TEXTURE_2D, 0, left, bottom, left, bottom, right - left, top - bottom);
  }

  // Makes targets of one colour with a buffer of depths, in which the nearest surface is kept of what draw() draws.
  drawNearest(targets, depth, draw) {
    const { gl } = this;
    this.drawTo(targets, depth);
    targets.forEach((_, i) => gl.clearBufferfv(gl.COLOR, i, [0, 0, 0, 0]));
    gl.clearBufferfv(gl.DEPTH, 0, [1]);
    gl.enable(gl.DEPTH_TEST);
    draw();
    gl.disable(gl.DEPTH_TEST);
  }

  // finish() does not wait in browsers that draw in another process; reading a pixel does.
  waitForPicture() {
    const { gl } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }
}
