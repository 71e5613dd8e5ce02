// The looks of `preview` in WebGL2. A picture is drawn sample by sample and is final once every pixel has all of them. The passes of the
// painted look and of the chain as published are the steps of preview/mesh_clouds/, in their order.
'use strict';

// What light.vert and cloud.vert read, by the locations of their attributes.
const LIT_BY = [['normals', 'normal', 3], ['lobes', 'lobe', 4], ['compared', 'compared', 4], ['lengths', 'lengths', 2], ['shares', 'sun_share', 1]];
const LOCATIONS = { position: 0, light: 1, ...Object.fromEntries([...LIT_BY.map(([, name]) => name), ...[0, 1, 2, 3].map(i => `harmonics_${i}`)].map((name, index) => [name, index])) };
const LIGHTS = ['lobe', 'compared', 'harmonics', 'exact'];  // their numbers in light.vert
const CHANNELS = ['sun', 'sky', 'opacity', 'depth'];

// The steps after drawing, with their names in `preview --steps`.
const STEPS = {
  painted: { depth_spread: 'spreadDepth', softened: 'soften', distorted: 'distort', eroded: 'erode' },
  published: { downsampled: 'downsample', blurred: 'blur', depth_blurred: 'blurDepth', distorted: 'distort' },
  plain: {},
};

// The part whose values the sliders show; that of a scene without mesh clouds has none.
const firstPart = ({ parts }) => parts[0] ?? { shape: [3, 0], lobe: 'mean', extinction: 1 };

// A function that mixes rows of numbers, one for each height: by the parabola through the rows at an hour, at the next one and half way.
function parabolaAt(heights, height) {
  const next = heights.findIndex((other, i) => i && i % 2 === 0 && (other > height || i === heights.length - 1));
  const t = clamp((height - heights[next - 2]) / (heights[next] - heights[next - 2]), 0, 1), weights = [(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)];
  return rows => rows[0].map((_, channel) => weights.reduce((sum, weight, i) => sum + weight * rows[next - 2 + i][channel], 0));
}

class Renderer {
  constructor(canvas, shaderText) {
    this.canvas = canvas;
    this.shaderText = shaderText;
    this.gl = canvas.getContext('webgl2', { alpha: false, antialias: false, depth: false, preserveDrawingBuffer: true });
    if (!this.gl) throw new Error('This browser has no WebGL2, or it is switched off.');
    this.colorFormat = this.gl.getExtension('EXT_color_buffer_float') ? this.gl.RGBA32F
      : this.gl.getExtension('EXT_color_buffer_half_float') ? this.gl.RGBA16F : null;
    if (!this.colorFormat) throw new Error('This graphics card cannot draw to textures of floats.');
    this.size = { width: canvas.width, height: canvas.height };  // of the picture; the canvas takes it once it is shown
    // Targets that are blended need more than colour buffers of floats.
    this.blendedFormat = this.gl.getExtension('EXT_float_blend') ? this.colorFormat : this.gl.RGBA16F;
    this.programs = {};
    this.targets = {};
    this.draws = 0;  // pictures since the page was opened
    this.framebuffer = this.gl.createFramebuffer();
  }

  // --- What is drawn ---

  // `scene`: what the program wrote about it, with `arrays`.
  setScene(scene) {
    const { gl } = this, { arrays } = scene, vertices = arrays.positions.length / 3;
    this.scene = scene;
    this.layers = scene.layers ? new SceneLayers(this) : null;
    this.forget();
    this.shares = null;
    for (const buffer of this.buffers ?? []) gl.deleteBuffer(buffer);
    for (const object of [this.lit, this.drawn]) gl.deleteVertexArray(object ?? null);
    this.buffers = [];
    const newBuffer = () => this.buffers[this.buffers.push(gl.createBuffer()) - 1];

    this.lit = gl.createVertexArray();
    gl.bindVertexArray(this.lit);
    for (const [key, name, size] of LIT_BY) if (arrays[key]?.length) this.setAttribute(newBuffer(), LOCATIONS[name], size, 0, 0, arrays[key]);
    for (let i = 0; i < 4; ++i) gl.vertexAttrib4f(LIT_BY.length + i, 0, 0, 0, 0);  // of coefficients that there are not
    gl.vertexAttrib1f(LOCATIONS.sun_share, 1);  // of clouds in nobody's shadow
    if (arrays.harmonicsPerVertex) {
      const buffer = newBuffer();
      for (let i = 0; i < arrays.harmonicsPerVertex / 4; ++i)
        this.setAttribute(buffer, LIT_BY.length + i, 4, 4 * arrays.harmonicsPerVertex, 16 * i, i ? null : arrays.harmonics);
    }

    this.drawn = gl.createVertexArray();
    gl.bindVertexArray(this.drawn);
    this.setAttribute(newBuffer(), LOCATIONS.position, 3, 0, 0, arrays.positions);
    this.lights = newBuffer();
    this.setAttribute(this.lights, LOCATIONS.light, 4, 0, 0, new Float32Array(4 * vertices));
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, newBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, arrays.triangles, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
  }

  // Settings have changed: light, shadows and sky are to be drawn anew.
  forget() { this.lightsKey = this.sharesKey = this.cloudSharesKey = this.skyKey = null; }

  setAttribute(buffer, index, size, stride, offset, data) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    if (data) gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(index);
    gl.vertexAttribPointer(index, size, gl.FLOAT, false, stride, offset);
    gl.bindBuffer(gl.ARRAY_BUFFER, null);
  }

  // Exact lengths from every vertex to sun and sky, two floats each.
  setLengths(lengths) {
    const { gl } = this;
    this.lightsKey = null;
    gl.bindVertexArray(this.lit);
    if (this.lengths) gl.deleteBuffer(this.lengths);
    this.lengths = gl.createBuffer();
    this.setAttribute(this.lengths, LOCATIONS.lengths, 2, 0, 0, lengths);
    gl.bindVertexArray(null);
  }

  // What comes of the light to each vertex past other things.
  castShadows() {
    const { gl, scene, view: { to_light, density, time } } = this, clouds_key = JSON.stringify([to_light, density]);
    if (!(scene.casters.length || scene.layers)) return;
    if (clouds_key !== this.cloudSharesKey) {
      const shadows = shadowsOf(scene, to_light, density);
      this.cloudShares = sharesOfLight(scene, shadows);
      this.layers?.uploadShadows(shadows);
    }
    this.cloudSharesKey = clouds_key;
    const key = JSON.stringify([to_light, density, this.layers && [time, this.layers.settings]]);
    if (key === this.sharesKey) return;
    this.sharesKey = key;
    const others = this.layers?.sharesOfVertices(scene.arrays.positions);
    gl.bindVertexArray(this.lit);
    this.setAttribute(this.shares ??= this.buffers[this.buffers.push(gl.createBuffer()) - 1], LOCATIONS.sun_share, 1, 0, 0, others ? this.cloudShares.map((share, v) => share * others[v]) : this.cloudShares);
    gl.bindVertexArray(null);
  }

  // --- Programs and targets ---

  // A program of `vertex` and `fragment` after the files of functions that they use. `kept`: a result of `vertex` that goes to a buffer.
  program(fragment, uses = [], vertex = 'screen.vert', vertexUses = [], kept = []) {
    const key = [vertex, ...uses, fragment].join(' ');
    if (this.programs[key]) return this.programs[key];
    const gl = this.gl, program = gl.createProgram();
    const attach = (type, files) => {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, `#version 300 es\nprecision highp float;\nprecision highp int;\n${files.map(this.shaderText).join('\n')}`);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) throw new Error(`This browser cannot compile a shader, ${fragment}: ${gl.getShaderInfoLog(shader)}`);
      gl.attachShader(program, shader);
    };
    attach(gl.VERTEX_SHADER, [...vertexUses, vertex]);
    attach(gl.FRAGMENT_SHADER, [...uses, fragment]);
    for (const [name, index] of Object.entries(LOCATIONS)) gl.bindAttribLocation(program, index, name);
    if (kept.length) gl.transformFeedbackVaryings(program, kept, gl.INTERLEAVED_ATTRIBS);
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(`This browser cannot link a shader, ${fragment}: ${gl.getProgramInfoLog(program)}`);
    const types = {};
    for (let i = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i-- > 0;) {
      const { name: uniform, type } = gl.getActiveUniform(program, i);
      types[uniform.replace('[0]', '')] = { type, location: gl.getUniformLocation(program, uniform) };
    }
    return this.programs[key] = { program, types };
  }

  // Sets the uniforms that the program has; textures are given as the names of targets.
  use({ program, types }, values) {
    const gl = this.gl;
    gl.useProgram(program);
    let unit = 0;
    for (const [name, { type, location }] of Object.entries(types)) {
      const value = name.split('.').reduce((found, part) => found?.[part], values);  // settings are tables of tables
      if (value === undefined) throw new Error(`the uniform ${name} has no value`);
      switch (type) {
        case gl.SAMPLER_2D: case gl.SAMPLER_2D_ARRAY:
          gl.activeTexture(gl.TEXTURE0 + unit);
          gl.bindTexture(type === gl.SAMPLER_2D ? gl.TEXTURE_2D : gl.TEXTURE_2D_ARRAY, this.targets[value].texture);
          gl.uniform1i(location, unit++);
          break;
        case gl.FLOAT: gl.uniform1f(location, value); break;
        case gl.FLOAT_VEC2: gl.uniform2fv(location, value.flat()); break;
        case gl.FLOAT_VEC3: gl.uniform3fv(location, value); break;
        case gl.FLOAT_VEC4: gl.uniform4fv(location, value.flat()); break;
        case gl.FLOAT_MAT3: gl.uniformMatrix3fv(location, false, value); break;
        case gl.INT: case gl.BOOL: gl.uniform1i(location, value); break;
        case gl.INT_VEC2: gl.uniform2iv(location, value); break;
        case gl.INT_VEC4: gl.uniform4iv(location, value); break;
        case gl.UNSIGNED_INT: gl.uniform1ui(location, value); break;
        default: throw new Error(`the uniform ${name} is of an unknown type`);
      }
    }
  }

  // A texture for drawing to, of the picture's size unless another is given.
  target(name, { width, height } = this.size, format = this.colorFormat) {
    const gl = this.gl, known = this.targets[name];
    if (known && known.width === width && known.height === height) return known;
    if (known) gl.deleteTexture(known.texture);
    const texture = this.newTexture(gl.TEXTURE_2D);
    gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
    return this.targets[name] = { name, texture, width, height };
  }

  // A texture of layers, each a target of its own.
  arrayTarget(name, depth, { width, height }) {
    const { gl } = this, known = this.targets[name];
    if (known && known.width === width && known.height === height && known.depth === depth) return known;
    if (known) gl.deleteTexture(known.texture);
    const texture = this.newTexture(gl.TEXTURE_2D_ARRAY);
    gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, this.colorFormat, width, height, depth);
    const layers = Array.from({ length: depth }, (_, layer) => ({ name, texture, width, height, layer }));
    return this.targets[name] = { name, texture, width, height, depth, layers };
  }

  // A texture of numbers that were computed here.
  upload(name, kind, { width, height, depth }, format, components, numbers) {
    const { gl } = this;
    if (this.targets[name]) gl.deleteTexture(this.targets[name].texture);
    const texture = this.newTexture(kind);
    if (kind === gl.TEXTURE_2D_ARRAY) gl.texImage3D(kind, 0, format, width, height, depth, 0, components, gl.FLOAT, numbers);
    else gl.texImage2D(kind, 0, format, width, height, 0, components, gl.FLOAT, numbers);
    return this.targets[name] = { name, texture, width, height };
  }

  newTexture(kind) {
    const { gl } = this, texture = gl.createTexture();
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(kind, texture);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(kind, filter, gl.NEAREST);
    return texture;
  }

  // From here on everything is drawn to these targets, or to the canvas if there are none.
  drawTo(targets, depth = null) {
    const gl = this.gl, { width, height } = targets[0] ?? depth ?? this.size, is_canvas = !targets.length && !depth;
    gl.bindFramebuffer(gl.FRAMEBUFFER, is_canvas ? null : this.framebuffer);
    if (is_canvas) {
      if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
    } else {
      for (let i = 0; i < 4; ++i) {
        const { texture, layer } = targets[i] ?? { texture: null };
        if (layer === undefined) gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + i, gl.TEXTURE_2D, texture, 0);
        else gl.framebufferTextureLayer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + i, texture, 0, layer);
      }
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, depth?.texture ?? null, 0);
      gl.drawBuffers(targets.map((_, i) => gl.COLOR_ATTACHMENT0 + i));
    }
    gl.viewport(0, 0, width, height);
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

  // As fill, but only where the picture may have clouds; the rest gets the value `other`. Targets of another size are filled.
  fillBox(targets, program, values, other = [0, 0, 0, 1]) {
    const { gl, box: [left, bottom, right, top] } = this;
    const is_whole = targets.some(({ width, height }) => width !== this.size.width || height !== this.size.height), key = `${this.box} ${other}`;
    for (const target of targets) {
      if (is_whole || target.box === key) continue;
      this.drawTo([target]);
      gl.clearBufferfv(gl.COLOR, 0, other);
      target.box = key;
    }
    if (!is_whole) gl.enable(gl.SCISSOR_TEST);
    gl.scissor(left, bottom, right - left, top - bottom);
    this.fill(targets, program, values);
    gl.disable(gl.SCISSOR_TEST);
  }

  // k and b of a part, moved as those of the first part were.
  shapeOf({ shape: [k, b] }) {
    const { scene, view } = this, first = firstPart(scene);
    return [k + view.k - first.shape[0], b + view.b - first.shape[1]];
  }

  // Computes the light that reaches each vertex, left and right of the divider, where anything of it has changed.
  lightVertices() {
    this.castShadows();
    const { gl, scene, view, look } = this, program = this.program('depth.frag', [], 'light.vert', ['lobe', 'harmonics'], ['shade']);
    const { to_light, light, against, density, k, b, show } = view, of_error = show === 'error';
    const key = JSON.stringify([to_light, this.sharesKey, light, against, density, k, b, look.half_lambert, of_error]);
    if (key === this.lightsKey) return;
    this.lightsKey = key;
    gl.bindVertexArray(this.lit);
    gl.enable(gl.RASTERIZER_DISCARD);
    for (const part of scene.parts) {
      const numberOf = name => name === 'exact' || part[name] ? LIGHTS.indexOf(name) : 0;
      this.use(program, {
        ...view, to_sun: to_light, of_error, half_lambert: look.half_lambert, lights: [numberOf(light), numberOf(against === 'none' ? light : against)],
        shape: this.shapeOf(part), compared_shape: part.compared?.shape ?? part.shape,
        extinction: part.extinction * density, own_extinction: part.harmonics?.extinction ?? 1, to_own: part.harmonics?.to_own ?? [1, 0, 0, 0, 1, 0, 0, 0, 1],
      });
      gl.bindBufferRange(gl.TRANSFORM_FEEDBACK_BUFFER, 0, this.lights, 16 * part.first_vertex, 16 * part.vertices);
      gl.beginTransformFeedback(gl.POINTS);
      gl.drawArrays(gl.POINTS, part.first_vertex, part.vertices);
      gl.endTransformFeedback();
    }
    gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, null);
    gl.disable(gl.RASTERIZER_DISCARD);
    gl.bindVertexArray(null);
  }

  // The clouds as triangles; `place`: of the sample in the pixel.
  drawClouds(fragment, { width, height }, [x, y], values = {}) {
    const { gl, scene, view } = this, { triangles } = scene.arrays;
    this.use(this.program(fragment, ['channels'], 'cloud.vert'), { ...view, ...values, place: [(2 * x - 1) / width, (1 - 2 * y) / height], divider: view.split * width });
    gl.bindVertexArray(this.drawn);
    gl.drawElements(gl.TRIANGLES, triangles.length, triangles.BYTES_PER_ELEMENT === 4 ? gl.UNSIGNED_INT : gl.UNSIGNED_SHORT, 0);
    gl.bindVertexArray(null);
  }

  // --- A picture ---

  // The pixels in which there may be clouds, also after the steps of the chain: left, bottom, right and top.
  cloudBox() {
    const { width, height } = this.size, { eye, right, up, forward, scale } = this.view, box = [width, height, 0, 0], more = this.reach();
    if (!this.scene.corners.length) return [0, 0, 0, 0];
    for (const corner of this.scene.corners) {
      const offset = add(corner, eye, -1), w = dot(offset, forward);
      if (!(w > 0)) return [0, 0, width, height];
      const x = (dot(offset, right) * scale[0] / w + 1) / 2 * width, y = (dot(offset, up) * scale[1] / w + 1) / 2 * height;
      box[0] = Math.min(box[0], Math.floor(x) - more), box[1] = Math.min(box[1], Math.floor(y) - more);
      box[2] = Math.max(box[2], Math.ceil(x) + more), box[3] = Math.max(box[3], Math.ceil(y) + more);
    }
    return [clamp(box[0], 0, width), clamp(box[1], 0, height), clamp(box[2], 0, width), clamp(box[3], 0, height)];
  }

  // How many pixels the painted chain moves and widens clouds at most.
  reach() {
    const { chain, kind } = this.look;
    if (kind !== 'painted') return 1;
    const { swirl_strength, far_strength } = chain.distort, longest_flow = 4;
    const softened = 2 * this.view.softness * Math.max(chain.soften.near_width, chain.soften.far_width);
    return Math.ceil(this.size.height * (chain.depth_spread + softened + longest_flow * this.view.swirl * swirl_strength * Math.max(1, far_strength))) + 4;
  }

  // Everything that follows from what the viewer chose. The camera: from, at, vertical field of view in degrees.
  frame({ camera, sun, time, ...chosen }) {
    const { width, height } = this.size, { scene, look } = this;
    const forward = normalize(add(camera.at, camera.from, -1));
    const level = Math.hypot(forward[0], forward[2]);
    const level_right = level > 0 ? [-forward[2] / level, 0, forward[0] / level] : [1, 0, 0], level_up = cross(level_right, forward);
    const roll = camera.roll ?? scene.camera.roll * Math.PI / 180, [c, s] = [Math.cos(roll), Math.sin(roll)];
    const right = level_right.map((x, i) => c * x - s * level_up[i]), up = level_up.map((y, i) => c * y + s * level_right[i]);
    const half = Math.tan(camera.fov * Math.PI / 360);
    const distances = scene.corners.map(corner => dot(add(corner, camera.from, -1), forward));
    const nearest = Math.max(0, Math.min(...distances, 1e30)), farthest = Math.max(...distances, 1e-6);
    const far = Math.max(1e-6, farthest) * 1.01, near = Math.max(nearest, 1e-3 * far) * 0.99;
    const toSun = directionFromAngles(sun[0], sun[1]), colors = this.colors(toSun[1]);
    const cycles = time * (look.chain?.distort.swirl_speed ?? 0), first = cycles - Math.floor(cycles);
    return {
      ...chosen, time, horizon_color: colors.horizon, ...scene.sky, ...colors, fog_color: scene.fog_color ?? colors.horizon, to_sun: toSun,
      ...(this.layers?.light(toSun, colors) ?? { to_light: toSun, light_color: colors.sun_color }),
      eye: camera.from, right, up, forward, picture: [width, height], per_pixel: 2 * half / height,
      scale: [height / (half * width), 1 / half], clip: [(far + near) / (far - near), -2 * far * near / (far - near)], depth_range: scene.depth_range,
      mean_all: look.chain?.mean_all ?? false, phases: [first, (first + 0.5) % 1, Math.abs(2 * first - 1)],
    };
  }

  // The colours at a height of the sun.
  colors(sunHeight) {
    const { heights, colors } = this.look.colors, mix = parabolaAt(heights, sunHeight);
    return Object.fromEntries(Object.entries(colors).map(([name, rows]) => [name, mix(rows)]));
  }

  // Begins a new picture.
  start(look, chosen) {
    const { scene } = this;
    this.look = look;
    this.layers?.setMoment(chosen);
    this.view = this.frame(chosen);
    this.view.was = this.layers?.wasAt(chosen);
    this.box = this.cloudBox();
    this.samples = 0;
    this.work = null;
    if (this.layers) this.layers.isComposed = false;
    this.lightVertices();
    const { to_sun, forward, picture, per_pixel } = this.view, key = JSON.stringify([look.kind, to_sun, forward, picture, per_pixel, this.layers && [this.view.eye, this.view.fewer, this.layers.settings]]);
    if (key !== this.skyKey) this.drawSky();
    this.skyKey = key;
    this.drawTo([this.target('sums 0', this.drawnSize)]);
    this.gl.clearBufferfv(this.gl.COLOR, 0, [0, 0, 0, 0]);
  }

  // The sky changes with camera and sun alone.
  drawSky() {
    const { layers } = this.scene;
    if (layers?.terrain_sky) {
      this.fill([this.target('background')], this.program('terrain_sky.frag', [...NOISE, 'terrain', 'view']), this.layers.values);
      return;
    }
    const sky = layers ? SKY_FILES : ['sky', 'view', 'sky_uniforms', 'plain_sky'], { sky_places, samples, kind } = this.look, places = kind === 'plain' ? samples : sky_places;
    const values = { ...this.view, centers: 'centers', places, count: places.length, everywhere: kind !== 'painted' };
    this.fill([this.target('centers')], this.program('sky.frag', sky), values);
    this.fill([this.target('background')], this.program('sky_edges.frag', sky), values);
  }

  // Whether the picture is composed of layers; single channels and the error are of the clouds alone.
  get isLayered() { return !!this.scene.layers && this.view.show !== 'error' && !CHANNELS.includes(this.view.show); }

  get hasClouds() { return this.scene.parts.some(part => part.count); }

  get complete() { return this.samples === this.look.samples.length && (!this.isLayered || this.layers.isComposed); }

  // A piece of work towards the complete picture: so many samples, or a step of the layers, which need all samples.
  advance(samples) {
    if (this.samples < this.look.samples.length) this.drawSamples(samples);
    else if (!this.complete) (this.work ??= this.drawScene()).next();
  }

  *drawScene() {
    if (this.hasClouds) this.drawMean();
    yield* this.layers.draw();
  }

  // How many times larger the picture is than the picture that is drawn first.
  get divisor() { return this.look.chain?.draw_divisor ?? 1; }

  // Of the picture that is drawn first, before any step.
  get drawnSize() {
    const { size: { width, height }, divisor } = this;
    return { width: Math.ceil(width / divisor), height: Math.ceil(height / divisor) };
  }

  // So many pixels to a side are drawn for each pixel of a sample, of which one is used. Graphics cards move vertices to 1/256 of a pixel; in a
  // picture that is drawn smaller than the canvas this is much, and each sample that it moves off the cloud's rim leaves a blot.
  get fineness() {
    const { drawnSize: { width, height }, divisor } = this, pixels = 1 << 22;
    return divisor === 1 ? 1 : Math.max(divisor, Math.floor(Math.sqrt(pixels / (width * height))));
  }

  // Draws `count` more samples of the clouds.
  drawSamples(count) {
    const { look, fineness } = this, all = look.samples.length, size = this.drawnSize;
    if (!this.hasClouds) this.samples = all;
    for (const end = Math.min(all, this.samples + count); this.samples < end; ++this.samples) {
      const place = look.samples[this.samples].map(x => x * fineness), pixel = place.map(Math.floor), in_pixel = place.map((x, i) => x - pixel[i]);
      const from = `sums ${this.samples % 2}`, to = `sums ${(this.samples + 1) % 2}`;
      if (look.kind === 'plain') this.drawLayers(in_pixel);
      else this.drawSurface(in_pixel, { width: size.width * fineness, height: size.height * fineness });
      this.fillBox([this.target(to, size)], this.program('accumulate.frag'),
        { sums: from, samples: 'sample', share: 1 / all, fineness, pixel: [pixel[0], fineness - 1 - pixel[1]] }, [0, 0, 0, 0]);
    }
  }

  // Draws the picture of the samples so far.
  show() {
    ++this.draws;
    if (this.look.kind === 'plain') {
      const values = { sums: `sums ${this.samples % 2}`, share: this.samples / this.look.samples.length };
      this.fill([], this.program('plain.frag', ['tone']), { ...this.view, ...values, background: 'background', box: this.box });
      return;
    }
    if (!this.isLayered) {
      this.drawMean();
      return;
    }
    if (!this.layers.isComposed) for (const piece of this.drawScene());  // of the samples so far
    this.layers.show();
  }

  // The mean of the samples so far, and the chain.
  drawMean() {
    const values = { sums: `sums ${this.samples % 2}`, share: this.samples / this.look.samples.length };
    this.fillBox([this.target('drawn', this.drawnSize)], this.program('mean.frag'), values);
    this.paint();
  }

  // The nearest surface at one sample of each pixel.
  drawSurface(place, size) {
    const { gl } = this, sample = this.target('sample', size), depth = this.target('depth 0', size, gl.DEPTH_COMPONENT32F);
    this.drawTo([sample], depth);
    gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.clearBufferfv(gl.DEPTH, 0, [1]);
    gl.enable(gl.DEPTH_TEST);
    this.drawClouds('cloud.frag', size, place);
    gl.disable(gl.DEPTH_TEST);
  }

  // finish() does not wait in browsers that draw in another process; reading a pixel does.
  waitForPicture() {
    const { gl } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  // --- The lobe formula alone: preview/mesh_clouds/render.cpp ---

  // All surfaces at one sample of each pixel, from the nearest to the farthest, and the light along the view through them.
  drawLayers(place) {
    const { gl, size } = this, [first] = this.scene.parts, surface = this.target('surface');
    const values = { ...this.view, signs: 'signs', surface: 'surface', view_extinction: this.look.view_extinction * first.extinction * this.view.density };
    this.drawTo([this.target('signs', size, gl.RGBA16F)]);
    gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE);
    this.drawClouds('signs.frag', size, place);
    gl.disable(gl.BLEND);
    for (const name of ['color 0', 'color 1', 'entry 0', 'entry 1']) this.target(name);
    const depths = [0, 1].map(i => this.target(`layer depth ${i}`, size, gl.DEPTH_COMPONENT32F));
    this.drawTo([], depths[1]);
    gl.clearBufferfv(gl.DEPTH, 0, [0]);
    const count = this.mostSurfaces();
    for (let i = 0; i < count; ++i) {
      const from = (i + 1) % 2, to = i % 2;
      this.drawTo([surface], depths[to]);
      gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
      gl.clearBufferfv(gl.DEPTH, 0, [1]);
      gl.enable(gl.DEPTH_TEST);
      this.drawClouds('surface.frag', size, place, { nearer: depths[from].name });
      gl.disable(gl.DEPTH_TEST);
      this.fillBox([this.target(`color ${to}`), this.target(`entry ${to}`)], this.program('layer.frag', ['light']),
        { ...values, colors: `color ${from}`, entries: `entry ${from}`, is_first: i === 0 });
    }
    this.fillBox([this.target('sample')], this.program('plain_sample.frag', ['sky', 'view', 'sky_uniforms']),
      { ...values, color: `color ${(count + 1) % 2}`, is_empty: count === 0, offset: [place[0] - 0.5, 0.5 - place[1]] });
  }

  // The largest number of surfaces at any pixel. Each pass looks at blocks of 8 x 8 pixels.
  mostSurfaces() {
    const { gl } = this, most = new Float32Array(4);
    let counts = 'signs', { width, height } = this.size;
    for (let level = 0; level === 0 || width * height > 1; ++level) {
      [width, height] = [Math.ceil(width / 8), Math.ceil(height / 8)];
      const next = this.target(`most ${level}`, { width, height });
      this.fill([next], this.program('most.frag'), { counts });
      counts = next.name;
    }
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.FLOAT, most);
    return most[1];
  }

  // --- The chains ---

  // The steps of the look, from what was drawn to the canvas.
  paint() {
    const { look, view } = this;
    let channels = 'drawn', shown = 'drawn';
    for (const [name, step] of Object.entries(STEPS[look.kind])) {
      this[step](channels, name);
      channels = name;
      if (view.show === 'picture' || view.show === name) shown = name;
    }
    const channel = CHANNELS.indexOf(view.show);
    if (channel >= 0) {
      this.fill([], this.program('channel.frag'), { ...view, channels: 'drawn', channel });
      return;
    }
    if (view.show === 'error') {
      this.fill([], this.program('error.frag'), { ...view, channels: 'drawn' });
      return;
    }
    const { fog_density, phase: [share, ...phase] } = look.chain.composite, { fog, shine, to_light, light_color } = view, distance_fog = this.scene.distance_fog * fog;
    const values = { ...view, to_sun: to_light, sun_color: light_color, fog_density: fog_density * fog, distance_fog, phase: [clamp(share * shine, 0, 1), ...phase], channels: shown, drawn: 'drawn' };
    const files = ['light', 'sky', 'view', 'sky_uniforms', 'channel_sum', 'composite'];
    if (!this.scene.layers) this.fill([], this.program('composite.frag', ['tone', ...files]), { ...values, background: 'background' });
    else this.fill(['cloud colors', 'cloud places'].map(name => this.target(name)), this.program('cloud_layer.frag', files), { ...values, fog_density: distance_fog > 0 ? 0 : fog_density * fog });
  }

  // Two boxes, along rows and along columns.
  boxes(from, channels, near, far) {
    const program = this.program('box.frag'), { height } = this.size;
    const widths = { channels, near_half: near * height, far_half: far * height };
    this.fillBox([this.target('rows')], program, { ...widths, image: from, axis: [1, 0] }, [0, 0, 0, 0]);
    this.fillBox([this.target('boxes')], program, { ...widths, image: 'rows', axis: [0, 1] }, [0, 0, 0, 0]);
  }

  spreadDepth(channels, to) {
    const { depth_spread } = this.look.chain;
    this.fillBox([this.target('weighted')], this.program('weighted.frag'), { channels, of_depth: 1 }, [0, 0, 0, 0]);
    this.boxes('weighted', channels, depth_spread, depth_spread);
    this.fillBox([this.target(to)], this.program('spread.frag'), { channels, weighted: 'boxes' });
  }

  soften(channels, to) {
    const { near_width, far_width } = this.look.chain.soften, [near, far] = [near_width, far_width].map(width => width * this.view.softness);
    this.fillBox([this.target('weighted')], this.program('weighted.frag'), { channels, of_depth: 0 }, [0, 0, 0, 0]);
    this.boxes('weighted', channels, near, far);
    this.boxes('boxes', channels, near, far);
    this.fillBox([this.target(to)], this.program('soft.frag'), { channels, weighted: 'boxes' });
  }

  distort(channels, to) {
    const { distort } = this.look.chain, swirl_strength = distort.swirl_strength * this.view.swirl;
    this.fillBox([this.target(to, this.targets[channels])], this.program('distort.frag', ['noise', 'channel_sum']), { ...this.view, ...distort, swirl_strength, channels });
  }

  erode(channels, to) {
    const { erode, distort: { seed } } = this.look.chain, shrink = clamp(erode.shrink * this.view.erosion, 0, 0.99);
    const { origin, longest, share } = this.scene.noise, noise = { noise_origin: origin, noise_size: longest * share };
    this.fillBox([this.target(to)], this.program('erode.frag', ['noise', 'view']), { ...this.view, ...noise, ...erode, seed, shrink, channels });
  }

  downsample(channels, to) {
    const { width, height } = this.size, { divisor } = this.look.chain, size = { width: Math.ceil(width / divisor), height: Math.ceil(height / divisor) };
    this.fill([this.target(to, size)], this.program('downsample.frag', ['channel_sum']), { ...this.view, channels, size: [size.width, size.height] });
  }

  blur(channels, to) {
    const program = this.program('blur.frag', ['channel_sum']), size = this.targets[channels], { blur } = this.look.chain;
    this.fill([this.target('blurred rows', size)], program, { ...this.view, ...blur, channels, axis: [1, 0] });
    this.fill([this.target(to, size)], program, { ...this.view, ...blur, channels: 'blurred rows', axis: [0, 1] });
  }

  blurDepth(channels, to) {
    const program = this.program('depth_blur.frag'), size = this.targets[channels], values = { ...this.view, ...this.look.chain.depth_blur, channels };
    this.fill([this.target('depth rows', size)], program, { ...values, sums: channels, of_rows: 1 });
    this.fill([this.target(to, size)], program, { ...values, sums: 'depth rows', of_rows: 0 });
  }
}
