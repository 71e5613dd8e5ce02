// The page of `cloudbake view`: camera and sun by mouse, touch and keys; the state in the address; the picture as PNG.
'use strict';

const element = id => document.getElementById(id);

// The arrays that the program wrote one after the other.
function unpackMesh({ vertices, indices, short }, text) {
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer;
  let at = 0;
  const take = (Type, count) => {
    const array = new Type(bytes, at, count);
    at += array.byteLength;
    return array;
  };
  return { positions: take(Float32Array, 3 * vertices), normals: take(Float32Array, 3 * vertices), lobes: take(Float32Array, 4 * vertices),
    triangles: take(short ? Uint16Array : Uint32Array, indices) };
}

class Viewer {
  constructor(page) {
    this.page = page;
    this.canvas = element('picture');
    this.renderer = new Renderer(this.canvas, page, unpackMesh(page.mesh, element('mesh').textContent), name => element(`shader ${name}`).textContent);
    this.home = { ...page.view };
    this.readAddress();
    this.listen();
    this.request();
  }

  // --- State: azimuth and elevation of the camera, zoom, shift of its target, sun, factor on the extinction, k of the first cloud, exposure ---

  // Besides the state: ui=0 hides all but the picture, size=WxH fixes its pixels.
  readAddress() {
    const words = new URLSearchParams(location.hash.slice(1));
    this.isBare = words.get('ui') === '0';
    this.size = /^[1-9]\d{0,3}x[1-9]\d{0,3}$/.test(words.get('size')) ? words.get('size').split('x').map(Number) : null;
    this.state = { ...this.home };
    for (const [key, beginning] of Object.entries(this.home)) {
      const numbers = words.get(key)?.split(',').map(Number) ?? [];
      if (numbers.length === [beginning].flat().length && numbers.every(Number.isFinite)) this.state[key] = Array.isArray(beginning) ? numbers : numbers[0];
    }
    this.showControls();
  }

  // Only what differs from the beginning.
  address() {
    const words = Object.keys(this.home).filter(key => String(this.state[key]) !== String(this.home[key]))
      .map(key => `${key}=${[this.state[key]].flat().map(x => +x.toFixed(4)).join(',')}`);
    if (this.isBare) words.push('ui=0');
    if (this.size) words.push(`size=${this.size.join('x')}`);
    return `#${words.join('&')}`;
  }

  change(changes) {
    const state = { ...this.state, ...changes };
    state.elevation = Math.min(89, Math.max(-89, state.elevation));
    state.sun = [((state.sun[0] % 360) + 360) % 360, Math.min(90, Math.max(-20, state.sun[1]))];
    state.density = Math.min(16, Math.max(1 / 16, state.density));
    state.k = Math.min(16, Math.max(0, state.k));
    state.zoom = Math.min(20, Math.max(0.05, state.zoom));
    this.state = state;
    this.request();
  }

  camera() {
    const { page, state } = this, towards = directionFromAngles(state.azimuth, state.elevation);
    const at = add(page.camera.at, state.shift);
    return { at, from: add(at, towards, page.camera.distance / state.zoom), fov: page.camera.fov };
  }

  // --- Drawing ---

  request() {
    this.stale = true;
    document.documentElement.dataset.state = 'drawing';
    if (!this.frame) this.frame = requestAnimationFrame(() => this.draw());
  }

  // While something moves a pixel has few samples; when it rests it gets the others.
  draw() {
    this.frame = 0;
    const begin = performance.now();
    if (this.stale) {
      this.stale = false;
      this.resize();
      this.renderer.start({ camera: this.camera(), sun: { azimuth: this.state.sun[0], elevation: this.state.sun[1] },
        exposure: this.state.exposure, density: this.state.density, k: this.state.k, time: this.page.time });
    }
    this.renderer.drawSamples(4);
    this.renderer.waitForPicture();
    const milliseconds = performance.now() - begin;
    element('figures').textContent = `${this.renderer.samples} of ${this.page.samples.length} samples, ${milliseconds.toFixed(0)} ms`;
    if (!this.renderer.complete) {
      this.frame = requestAnimationFrame(() => this.draw());
      return;
    }
    history.replaceState(null, '', this.address());
    element('sun-azimuth').value = this.state.sun[0];
    element('sun-elevation').value = this.state.sun[1];
    element('density').value = Math.log2(this.state.density);
    element('k').value = this.state.k;
    element('exposure').value = this.state.exposure;
    document.documentElement.dataset.state = 'ready';
  }

  resize() {
    const ratio = window.devicePixelRatio || 1, [width, height] = this.size ?? [innerWidth * ratio, innerHeight * ratio];
    const [w, h] = [width, height].map(x => Math.min(8192, Math.max(1, Math.round(x))));
    if (this.canvas.width !== w || this.canvas.height !== h) Object.assign(this.canvas, { width: w, height: h });
  }

  // --- Input ---

  listen() {
    const pointers = new Map(), { canvas } = this;
    canvas.addEventListener('pointerdown', event => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, event);
    });
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, event => pointers.delete(event.pointerId));
    canvas.addEventListener('pointermove', event => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const dx = event.clientX - before.clientX, dy = event.clientY - before.clientY;
      if (pointers.size === 2) {
        const other = [...pointers.values()].find(p => p.pointerId !== event.pointerId);
        const spread = p => Math.hypot(p.clientX - other.clientX, p.clientY - other.clientY);
        this.change({ zoom: this.state.zoom * spread(event) / Math.max(1, spread(before)) });
        this.pan(dx / 2, dy / 2);
      } else if (event.shiftKey) {
        this.moveSun(dx / 4, -dy / 4);
      } else if (event.buttons & 6 || event.ctrlKey) {
        this.pan(dx, dy);
      } else {
        this.turn(-dx / 3, dy / 3);
      }
      pointers.set(event.pointerId, event);
    });
    canvas.addEventListener('wheel', event => {
      event.preventDefault();
      this.change({ zoom: this.state.zoom * Math.exp(-event.deltaY / 600) });
    }, { passive: false });
    canvas.addEventListener('contextmenu', event => event.preventDefault());
    canvas.addEventListener('dblclick', () => this.change(this.home));
    canvas.addEventListener('keydown', event => {
      const [x, y] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key] ?? [0, 0];
      if (x || y) event.shiftKey ? this.moveSun(5 * x, 5 * y) : this.turn(5 * x, 5 * y);
      else if (event.key === '+' || event.key === '=') this.change({ zoom: this.state.zoom * 1.1 });
      else if (event.key === '-') this.change({ zoom: this.state.zoom / 1.1 });
      else if (event.key === 'Home') this.change(this.home);
      else return;
      event.preventDefault();
    });
    element('sun-azimuth').addEventListener('input', event => this.change({ sun: [event.target.valueAsNumber, this.state.sun[1]] }));
    element('sun-elevation').addEventListener('input', event => this.change({ sun: [this.state.sun[0], event.target.valueAsNumber] }));
    element('density').addEventListener('input', event => this.change({ density: 2 ** event.target.valueAsNumber }));
    element('k').addEventListener('input', event => this.change({ k: event.target.valueAsNumber }));
    element('exposure').addEventListener('input', event => this.change({ exposure: event.target.valueAsNumber }));
    element('reset').addEventListener('click', () => this.change(this.home));
    element('save').addEventListener('click', () => this.save());
    addEventListener('resize', () => this.request());
    addEventListener('hashchange', () => {
      this.readAddress();
      this.request();
    });
    canvas.addEventListener('webglcontextlost', event => event.preventDefault());
    canvas.addEventListener('webglcontextrestored', () => location.reload());
  }

  showControls() { element('controls').hidden = this.isBare; }
  turn(x, y) { this.change({ azimuth: this.state.azimuth + x, elevation: this.state.elevation + y }); }
  moveSun(x, y) { this.change({ sun: [this.state.sun[0] + x, this.state.sun[1] + y] }); }

  // By pixels of the page: what is at the target's distance follows the pointer.
  pan(dx, dy) {
    const { right, up, per_pixel: perPixel } = this.renderer.view, pixels = this.canvas.width / this.canvas.clientWidth;
    const scale = perPixel * pixels * this.page.camera.distance / this.state.zoom;
    this.change({ shift: add(add(this.state.shift, right, -dx * scale), up, dy * scale) });
  }

  save() {
    this.canvas.toBlob(blob => {
      const link = Object.assign(document.createElement('a'), { href: URL.createObjectURL(blob), download: `${this.page.name}.png` });
      link.click();
      URL.revokeObjectURL(link.href);
    });
  }
}

try {
  window.viewer = new Viewer(JSON.parse(element('page').textContent));
} catch (error) {
  element('message').textContent = error.message;
  element('message').hidden = false;
  document.documentElement.dataset.state = 'failed';
}
