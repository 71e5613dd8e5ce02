// The painted look in WebGL2: the passes of preview/mesh_clouds/, in their order. A picture is drawn sample by sample and is final once
// every pixel has all of them.
'use strict';

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const add = (a, b, factor = 1) => a.map((x, i) => x + factor * b[i]);
const normalize = a => a.map(x => x / Math.hypot(...a));

// Azimuth from +Z towards +X and elevation, in degrees.
function directionFromAngles(azimuth, elevation) {
  const a = azimuth * Math.PI / 180, e = elevation * Math.PI / 180;
  return [Math.cos(e) * Math.sin(a), Math.sin(e), Math.cos(e) * Math.cos(a)];
}

class Renderer {
  // `page`: what the program wrote about the scene and the look; `mesh`: its vertices and triangles.
  constructor(canvas, page, mesh, shaderText) {
    this.canvas = canvas;
    this.page = page;
    this.gl = canvas.getContext('webgl2', { alpha: false, antialias: false, depth: false, preserveDrawingBuffer: true });
    if (!this.gl) throw new Error('This browser has no WebGL2, or it is switched off.');
    if (!this.gl.getExtension('EXT_color_buffer_float')) throw new Error('This graphics card cannot draw to textures of floats.');
    this.shaderText = shaderText;
    this.programs = {};
    this.targets = {};
    this.samples = 0;
    this.draws = 0;  // pictures since the page was opened
    this.upload(mesh);
    this.framebuffer = this.gl.createFramebuffer();
  }

  upload({ positions, normals, lobes, triangles }) {
    const gl = this.gl;
    this.indexType = triangles instanceof Uint16Array ? gl.UNSIGNED_SHORT : gl.UNSIGNED_INT;
    this.vertices = gl.createVertexArray();
    gl.bindVertexArray(this.vertices);
    [[positions, 3], [normals, 3], [lobes, 4]].forEach(([data, size], index) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(index);
      gl.vertexAttribPointer(index, size, gl.FLOAT, false, 0, 0);
    });
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
  }

  // A program of `vertex` and `fragment` after the files of functions that they use.
  program(name, fragment, uses, vertex = 'screen.vert', vertexUses = []) {
    if (this.programs[name]) return this.programs[name];
    const gl = this.gl, program = gl.createProgram();
    const attach = (type, files) => {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, `#version 300 es\nprecision highp float;\nprecision highp int;\n${files.map(this.shaderText).join('\n')}`);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(`${name}: ${gl.getShaderInfoLog(shader)}`);
      gl.attachShader(program, shader);
    };
    attach(gl.VERTEX_SHADER, [...vertexUses, vertex]);
    attach(gl.FRAGMENT_SHADER, [...uses, fragment]);
    ['position', 'normal', 'lobe'].forEach((attribute, index) => gl.bindAttribLocation(program, index, attribute));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(`${name}: ${gl.getProgramInfoLog(program)}`);
    const types = {};
    for (let i = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i-- > 0;) {
      const { name: uniform, type } = gl.getActiveUniform(program, i);
      types[uniform.replace('[0]', '')] = { type, location: gl.getUniformLocation(program, uniform) };
    }
    return this.programs[name] = { program, types };
  }

  // Sets the uniforms that the program has; textures are given as the names of targets.
  use({ program, types }, values) {
    const gl = this.gl;
    gl.useProgram(program);
    let unit = 0;
    for (const [name, { type, location }] of Object.entries(types)) {
      const value = values[name];
      if (value === undefined) throw new Error(`the uniform ${name} has no value`);
      switch (type) {
        case gl.SAMPLER_2D:
          gl.activeTexture(gl.TEXTURE0 + unit);
          gl.bindTexture(gl.TEXTURE_2D, this.targets[value].texture);
          gl.uniform1i(location, unit++);
          break;
        case gl.FLOAT: gl.uniform1f(location, value); break;
        case gl.FLOAT_VEC2: gl.uniform2fv(location, value.flat()); break;
        case gl.FLOAT_VEC3: gl.uniform3fv(location, value); break;
        case gl.INT: case gl.BOOL: gl.uniform1i(location, value); break;
        case gl.INT_VEC2: gl.uniform2iv(location, value); break;
        case gl.UNSIGNED_INT: gl.uniform1ui(location, value); break;
        default: throw new Error(`the uniform ${name} is of an unknown type`);
      }
    }
  }

  // A texture of floats of the canvas's size.
  target(name) {
    const gl = this.gl, { width, height } = this.canvas;
    const known = this.targets[name];
    if (known && known.width === width && known.height === height) return known.texture;
    if (known) gl.deleteTexture(known.texture);
    const texture = gl.createTexture();
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, width, height);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    this.targets[name] = { texture, width, height };
    return texture;
  }

  // Draws over the whole of a target, or of the canvas if there is none.
  fill(target, program, values) {
    const gl = this.gl;
    if (target) {
      const texture = this.target(target);
      gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    } else {
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    }
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    this.use(program, values);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  // Everything that follows from camera and sun. The camera: from, at, vertical field of view in degrees. The sun: azimuth, elevation.
  frame({ camera, sun, exposure, density, k, time }) {
    const { width, height } = this.canvas, { page } = this;
    const forward = normalize(add(camera.at, camera.from, -1));
    const level = Math.hypot(forward[0], forward[2]);
    const right = level > 0 ? [-forward[2] / level, 0, forward[0] / level] : [1, 0, 0];
    const half = Math.tan(camera.fov * Math.PI / 360);
    const distances = page.corners.map(corner => dot(add(corner, camera.from, -1), forward));
    const nearest = Math.max(0, Math.min(...distances)), farthest = Math.max(...distances);
    const range = page.depth_range ?? (farthest > nearest ? [nearest, farthest] : [0, 1]);
    const far = Math.max(1e-6, farthest) * 1.01, near = Math.max(nearest, 1e-3 * far) * 0.99;
    const toSun = directionFromAngles(sun.azimuth, sun.elevation), cycles = time * page.distort.swirl_speed, first = cycles - Math.floor(cycles);
    const colors = this.colors(toSun[1]);
    return {
      ...page.sky, ...colors, fog_color: page.fog_color ?? colors.horizon, to_sun: toSun, exposure,
      eye: camera.from, right, up: cross(right, forward), forward, picture: [width, height], per_pixel: 2 * half / height,
      scale: [height / (half * width), 1 / half], clip: [(far + near) / (far - near), -2 * far * near / (far - near)], depth_range: range,
      density, k,
      phases: [first, (first + 0.5) % 1, Math.abs(2 * first - 1)],
    };
  }

  // Between the entries of the table, which go from the lowest sun to the highest.
  colors(sunHeight) {
    const { names, rows } = this.page.colors, place = (sunHeight + 1) / 2 * (rows.length - 1);
    const low = Math.min(Math.floor(place), rows.length - 2), part = place - low;
    return Object.fromEntries(names.map((name, n) => [name, rows[low][n].map((x, i) => x + part * (rows[low + 1][n][i] - x))]));
  }

  // Begins a new picture.
  start(view) {
    this.view = this.frame(view);
    this.samples = 0;
    const skyKey = JSON.stringify([this.view.to_sun, this.view.forward, this.view.picture, this.view.per_pixel]);
    if (skyKey !== this.skyKey) this.drawSky();
    this.skyKey = skyKey;
  }

  drawSky() {
    const sky = ['sky', 'view', 'sky_uniforms'], values = { ...this.view, centers: 'centers', places: this.page.sky_places };
    this.fill('centers', this.program('sky', 'sky.frag', sky), values);
    this.fill('background', this.program('sky edges', 'sky_edges.frag', sky), values);
  }

  get complete() { return this.samples === this.page.samples.length; }

  // Draws `count` more samples of the clouds.
  drawSamples(count) {
    const gl = this.gl, { page, view, canvas } = this;
    for (const end = Math.min(page.samples.length, this.samples + count); this.samples < end; ++this.samples) {
      const [x, y] = page.samples[this.samples], sums = ['sums 0', 'sums 1'];
      if (this.samples % 2) sums.reverse();
      gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.target('sample'), 0);
      if (this.depthSize !== `${canvas.width} ${canvas.height}`) {
        this.depth ??= gl.createRenderbuffer();
        gl.bindRenderbuffer(gl.RENDERBUFFER, this.depth);
        gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT32F, canvas.width, canvas.height);
        this.depthSize = `${canvas.width} ${canvas.height}`;
      }
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, this.depth);
      gl.viewport(0, 0, canvas.width, canvas.height);
      gl.clearColor(0, 0, 0, 0);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.enable(gl.DEPTH_TEST);
      const cloud = this.program('cloud', 'cloud.frag', [], 'cloud.vert', ['lobe']);
      gl.bindVertexArray(this.vertices);
      for (const part of page.parts) {
        const place = [(2 * x - 1) / canvas.width, (1 - 2 * y) / canvas.height];
        const own = { extinction: part.extinction * view.density, shape: [part.shape[0] + view.k - page.view.k, part.shape[1]] };
        this.use(cloud, { ...view, ...own, place, half_lambert: page.half_lambert });
        gl.drawElements(gl.TRIANGLES, part.count, this.indexType, part.first * (this.indexType === gl.UNSIGNED_INT ? 4 : 2));
      }
      gl.bindVertexArray(null);
      gl.disable(gl.DEPTH_TEST);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, null);
      if (this.samples === 0) {
        gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.target(sums[0]), 0);
        gl.clear(gl.COLOR_BUFFER_BIT);
      }
      this.fill(sums[1], this.program('accumulate', 'accumulate.frag', []), { sums: sums[0], samples: 'sample' });
    }
    this.fill('drawn', this.program('mean', 'mean.frag', []), { sums: `sums ${this.samples % 2}`, count: this.samples });
    this.paint();
  }

  // finish() does not wait in browsers that draw in another process; reading a pixel does.
  waitForPicture() {
    const { gl } = this;
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  // Two boxes, along rows and along columns.
  boxes(from, channels, near, far) {
    const program = this.program('box', 'box.frag', []), { height } = this.canvas;
    const widths = { channels, near_half: near * height, far_half: far * height };
    this.fill('rows', program, { ...widths, image: from, axis: [1, 0] });
    this.fill('boxes', program, { ...widths, image: 'rows', axis: [0, 1] });
  }

  // The steps of the chain, from what was drawn to the canvas.
  paint() {
    ++this.draws;
    const { page, view } = this, weighted = this.program('weighted', 'weighted.frag', []);
    this.fill('weighted', weighted, { channels: 'drawn', of_depth: 1 });
    this.boxes('weighted', 'drawn', page.depth_spread, page.depth_spread);
    this.fill('spread', this.program('spread', 'spread.frag', []), { channels: 'drawn', weighted: 'boxes' });

    this.fill('weighted', weighted, { channels: 'spread', of_depth: 0 });
    this.boxes('weighted', 'spread', page.soften.near_width, page.soften.far_width);
    this.boxes('boxes', 'spread', page.soften.near_width, page.soften.far_width);
    this.fill('soft', this.program('soft', 'soft.frag', []), { channels: 'spread', weighted: 'boxes' });

    this.fill('distorted', this.program('distort', 'distort.frag', ['noise']), { ...view, ...page.distort, channels: 'soft' });
    this.fill('eroded', this.program('erode', 'erode.frag', ['noise', 'view']), { ...view, ...page.erode, channels: 'distorted' });
    this.fill(null, this.program('composite', 'composite.frag', ['light', 'sky', 'tone', 'view', 'sky_uniforms']),
      { ...view, ...page.composite, channels: 'eroded', background: 'background' });
  }
}
