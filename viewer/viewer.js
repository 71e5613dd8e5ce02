// The page of `cloudbake view`: camera and sun by mouse, touch and keys; the state in the address; the picture as PNG.
'use strict';

const element = id => document.getElementById(id);
const LOOKS = { painted: 'Painted', published: 'Chain as published', plain: 'Plain: the lobe formula' };
const STEP_NAMES = name => `Step: ${name.replace('_', ' ')}`;
const CHANNEL_NAMES = name => `Channel: ${name}`;
const ERROR_NAME = 'Error of the light';

// What the viewer can change besides camera, sun, exposure and shape of the lobes, as it is at first. Those of the image chain are factors.
const CHOICES = { asset: 0, light: '', against: 'none', split: 0.5, show: 'picture', density: 1, softness: 1, swirl: 1, erosion: 1, fog: 1, shine: 1, vertex: -1, rate: 30 };
const LIMITS = { rate: [1, 240], elevation: [-89, 89], density: [1 / 16, 16], k: [0, 16], zoom: [0.05, 20], split: [0, 1], exposure: [1e-3, 1e3],
  softness: [0, 10], swirl: [0, 10], erosion: [0, 2], fog: [0, 100], shine: [0, 10] };
// The sliders whose values are those of the state.
const SLIDERS = ['k', 'b', 'exposure', 'softness', 'swirl', 'erosion', 'fog', 'shine'];
const FRAME_MILLISECONDS = 40;  // that a step of a picture should take
const ADDRESS_MILLISECONDS = 400;  // between two addresses: browsers refuse more than 100 in 30 seconds
const LARGEST_SIZE = 8192;  // of a picture, pixels

// What the lobe formula takes for ℓ from a vertex towards a light: s(l) of docs/lobe_math.md.
function insideByLobe(lobes, v, to_light, [k, b]) {
  const along = lobes[4 * v] * to_light[0] + lobes[4 * v + 1] * to_light[1] + lobes[4 * v + 2] * to_light[2];
  return Math.max(0, Math.max(0, along / 2 + 0.5) ** k * lobes[4 * v + 3] + b);
}

class Viewer {
  constructor() {
    this.canvas = element('picture');
    this.pointers = new Map();
    this.dropped = [];  // scenes of GLBs that were dropped on the page
    this.divisor = 2;  // of drafts of layered scenes
    this.fullSize = { width: 1, height: 1 };  // of a picture that is no draft
    this.chunks = { first: 1, next: 1 };  // samples in the first step of a picture, which has more to do, and in the next ones
    this.isReduced = matchMedia('(prefers-reduced-motion: reduce)').matches;
    this.renderer = this.newRenderer();
  }

  async begin(page = JSON.parse(element('page').textContent)) {
    await this.setPage(page);
    this.readAddress();
    element('panel').open = innerWidth >= 500 && !this.sheet;  // a small page is left to the picture, and so are tiles
    this.listen();
  }

  newRenderer() { return new Renderer(this.canvas, name => element(`shader ${name}`).textContent); }

  // Shows another page's scenes; camera, sun, everything that was chosen and what was dropped stays.
  async setPage(page) {
    this.newest = page;
    await Promise.all(page.scenes.map(async scene => { scene.arrays ??= await unpackMesh(scene); }));
    if (page !== this.newest) return;  // another one came meanwhile
    for (const scene of page.scenes) if (scene.keys) ownLooks(scene, page.looks, page.looks);
    for (const scene of this.dropped) ownLooks(scene, this.page.looks, page.looks);
    for (const [i, scene] of page.scenes.entries()) keepKeys(this.page?.scenes[i], scene, page.looks);
    this.page = { ...page, scenes: [...page.scenes, ...this.dropped] };
    if (this.state) this.setState({ ...this.changes(), asset: this.state.asset });
  }

  get scene() { return this.page.scenes[this.state.asset]; }
  get look() { return this.page.looks[this.scene.looks[this.state.look]]; }

  // --- State: what is chosen (CHOICES), azimuth and elevation of the camera, zoom, shift of its target, sun, exposure, k and b ---

  homeOf(scene) {
    const [k, b] = firstPart(scene).shape, { look, light } = scene;
    return { ...CHOICES, ...scene.view, asset: this.page.scenes.indexOf(scene), look, light, k, b };
  }

  // The ways in which the light of a scene can be computed.
  lightsOf(scene) {
    const nameOf = kind => `${kind === 'fit' ? 'Fitted' : 'Mean'} lobe`, first = firstPart(scene), names = { lobe: nameOf(first.lobe) };
    if (first.compared) names.compared = nameOf(first.compared.lobe);
    if (scene.parts.some(part => part.harmonics)) names.harmonics = 'Harmonics';
    return scene.layers?.is_sheet ? names : { ...names, exact: 'Exact transmittance' };  // tiles take turns, and would compute the lengths anew
  }

  // Takes a state with all words and numbers that make sense.
  setState(wanted) {
    const asset = clamp(Math.trunc(wanted.asset) || 0, 0, this.page.scenes.length - 1), scene = this.page.scenes[asset], home = this.homeOf(scene);
    const state = { ...home, ...wanted, asset }, lights = this.lightsOf(scene);
    if (!Object.hasOwn(scene.looks, state.look)) state.look = home.look;
    if (!Object.hasOwn(lights, state.light)) state.light = home.light;
    if (!Object.hasOwn(lights, state.against)) state.against = 'none';
    if (state.show !== 'picture' && (state.look === 'plain' || ![...Object.keys(STEPS[state.look]), 'drawn', 'error', ...CHANNELS].includes(state.show))) state.show = 'picture';
    if (!(state.vertex >= 0 && state.vertex < scene.arrays.positions.length / 3 && Number.isInteger(state.vertex))) state.vertex = -1;
    for (const [key, [low, high]] of Object.entries(LIMITS)) state[key] = clamp(state[key], low, high);
    state.sun = [((state.sun[0] % 360) + 360) % 360, clamp(state.sun[1], -20, 90)];
    if (scene.layers?.is_sheet) Object.assign(state, { show: 'picture', against: 'none', vertex: -1 });
    const is_new = scene !== this.drawnScene;
    this.home = home;
    this.state = state;
    if (is_new) this.useScene();
    this.request();
  }

  change(changes) { this.setState({ ...this.state, ...changes }); }

  useScene() {
    this.drawnScene = this.scene;
    this.time = this.sunOfHour = undefined;
    this.renderer.setScene(this.scene);
    this.sheet = this.scene.layers?.is_sheet ? new TechniqueSheet(this.scene) : null;
    element('sheet').hidden = !this.sheet;
    this.showKeys();
    this.lengthsKey = this.insides = this.skyLengths = this.sunLengths = this.errorKey = null;
    const { home, scene } = this, longest = scene.camera.distance;
    Object.assign(element('b'), { min: home.b - longest / 50, max: home.b + longest / 50 });
    element('vertex').max = scene.arrays.positions.length / 3 - 1;
    this.setOptions('asset', Object.fromEntries(this.page.scenes.map(({ name }, i) => [i, name])));
    this.setOptions('look', Object.fromEntries(Object.keys(scene.looks).map(name => [name, LOOKS[name]])));
    this.setOptions('light', this.lightsOf(scene));
    this.setOptions('against', { none: 'Nothing', ...this.lightsOf(scene) });
  }

  setOptions(id, names) { element(id).replaceChildren(...Object.entries(names).map(([value, name]) => new Option(name, value))); }

  // Besides the state: ui=0 hides all but the picture, size=WxH fixes its pixels, play=1 plays unless the system asks for less motion.
  readAddress() {
    const words = new URLSearchParams(location.hash.slice(1)), size = words.get('size')?.match(/^([1-9]\d{0,3})x([1-9]\d{0,3})$/)?.slice(1).map(Number);
    const asset = clamp(Math.trunc(words.get('asset')) || 0, 0, this.page.scenes.length - 1), scene = this.page.scenes[asset], state = { ...this.homeOf(scene) };
    this.isBare = words.get('ui') === '0';
    this.size = size?.every(pixels => pixels <= LARGEST_SIZE) ? size : scene.size ?? null;
    for (const [key, beginning] of Object.entries(state)) {
      const word = words.get(key), numbers = word?.split(',').map(text => text.trim() ? Number(text) : NaN) ?? [];
      if (typeof beginning === 'string') state[key] = word ?? beginning;
      else if (numbers.length === [beginning].flat().length && numbers.every(Number.isFinite)) state[key] = Array.isArray(beginning) ? numbers : numbers[0];
    }
    element('controls').hidden = this.isBare;
    this.setState(state);
    this.play(words.get('play') === '1' && !this.isReduced);
  }

  // What differs from the beginning.
  changes() { return Object.fromEntries(Object.entries(this.state).filter(([key, value]) => String(value) !== String(this.home[key]))); }

  address() {
    const text = value => typeof value === 'string' ? value : [value].flat().map(x => +x.toFixed(4)).join(',');
    const words = Object.entries({ ...(this.state.asset > 0 ? { asset: this.state.asset } : {}), ...this.changes() }).map(([key, value]) => `${key}=${text(value)}`);
    if (this.isBare) words.push('ui=0');
    if (this.size && String(this.size) !== String(this.scene.size)) words.push(`size=${this.size.join('x')}`);
    if (this.playing) words.push('play=1');
    return `#${words.join('&')}`;
  }

  // Frames without an address of their own, such as those of `srcdoc`, keep the one that they have.
  showAddress() {
    clearTimeout(this.addressTimer);
    const wait = (this.addressAt ?? -Infinity) + ADDRESS_MILLISECONDS - performance.now();
    if (wait > 0) {
      this.addressTimer = setTimeout(() => this.showAddress(), wait);
      return;
    }
    this.addressAt = performance.now();
    try {
      history.replaceState(null, '', this.address());
    } catch {}
  }

  // A camera on a path is only turned.
  cameraAt(time) {
    const { scene: { layers }, state, home } = this;
    return layers?.camera_path ? cameraOnPath(time, layers.terrain, [state.azimuth - home.azimuth, home.elevation - state.elevation]) : this.camera();
  }

  camera() {
    const { scene: { camera }, state } = this, { clientWidth, clientHeight } = this.canvas, [width, height] = this.size ?? [clientWidth, clientHeight];
    const at = add(camera.at, state.shift), distance = camera.distance * Math.max(1, camera.aspect * height / width) / state.zoom;
    return { at, from: add(at, directionFromAngles(state.azimuth, state.elevation), distance), fov: camera.fov, distance };
  }

  // --- Drawing ---

  request() {
    this.stale = true;
    document.documentElement.dataset.state = 'drawing';
    if (!this.frame) this.frame = requestAnimationFrame(now => this.draw(now));
  }

  draw(now) {
    this.frame = 0;
    if (this.renderer.gl.isContextLost()) return;
    try {
      this.drawStep(now);
    } catch (error) {
      if (!this.renderer.gl.isContextLost()) fail(error);
    }
  }

  // While something moves a pixel has few samples; when it rests it gets the others, and is shown again once it has all.
  drawStep(now) {
    const begin = performance.now(), between = now - this.drawnAt;
    this.drawnAt = now;
    const seconds = Math.min(0.1, between / 1000 || 0);
    if (this.playing) this.moveTime(seconds);
    if (this.playingSun) this.setHour(this.hour + seconds);
    const is_first = this.stale || this.moves, { renderer } = this;
    if (this.sheet) this.drawSheetStep(is_first);
    else if (this.scene.layers) this.drawLayeredStep(is_first);
    else this.drawSampledStep(is_first);
    const milliseconds = performance.now() - begin, { width, height } = renderer.size;
    element('figures').textContent = `${width} × ${height}, ${renderer.samples} of ${this.look.samples.length} samples, ${milliseconds.toFixed(0)} ms, ${(1000 / between).toFixed(0)} fps`;
    this.showOverlays();
    this.showNumbers();
    const is_final = renderer.complete && !this.isDraft && !this.moves && !this.needsLengths();
    if (is_final || (this.moves && this.state !== this.shownState && !this.pointers.size)) this.showState();
    if (is_final) document.documentElement.dataset.state = 'ready';
    else this.frame ||= requestAnimationFrame(next => this.draw(next));
  }

  drawSampledStep(is_first) {
    const { renderer } = this, begin = performance.now(), step = is_first ? 'first' : 'next';
    if (is_first) this.startPicture();
    const before = renderer.samples;
    renderer.drawSamples(this.chunks[step]);
    if (is_first || renderer.complete) renderer.show();
    renderer.waitForPicture();
    if (is_first || !renderer.complete)  // the last step has few samples, and shows them
      this.chunks[step] = clamp(Math.round((renderer.samples - before) * FRAME_MILLISECONDS / (performance.now() - begin)), 1, 64);
  }

  // Time moves clouds, a camera on a path, and through the hours the sun.
  moveTime(seconds) {
    this.time = Math.max(0, this.time + seconds);
    const { day } = this.scene.layers ?? {};
    if (day?.seconds > 0) this.change({ sun: sunOfDay(day, this.time) });
    element('time').value = this.time;
  }

  // While something moves, a picture of fewer pixels and steps is drawn as a whole; when it rests, the whole picture in pieces, behind it.
  drawLayeredStep(is_first) {
    const target = 1000 / this.state.rate;
    if (is_first) this.divisor = this.drawDraft(this.divisor, target);
    else this.continuePicture(target);
  }

  // Each technique in turn, first as drafts. The last tile that is completed ends the draft.
  drawSheetStep(is_first) {
    const { sheet, renderer, canvas } = this, target = 1000 / this.state.rate, use = tile => { if (renderer.scene !== tile.scene) renderer.setScene(tile.scene); };
    if (is_first) {
      sheet.next = 0;
      for (const tile of sheet.tiles) {
        use(tile);
        const begin = performance.now();
        tile.divisor = this.drawDraft(tile.divisor, target / sheet.tiles.length);
        sheet.take(tile, canvas, performance.now() - begin, 'draft');
        tile.milliseconds = 0;
      }
      return;
    }
    const tile = sheet.tiles[sheet.next], begin = performance.now();
    use(tile);
    this.continuePicture(target);
    tile.milliseconds += performance.now() - begin;
    if (!renderer.complete) return;
    sheet.take(tile, canvas, tile.milliseconds, 'picture');
    ++sheet.next;
    this.isDraft = !sheet.isComplete;
  }

  // Draws a picture that is so many times smaller, and returns the number of times for the next one to take so many milliseconds.
  drawDraft(divisor, target) {
    const { renderer } = this, begin = performance.now();
    this.startPicture(divisor);
    this.isDraft = true;
    renderer.drawSamples(1);
    renderer.show();
    renderer.waitForPicture();
    const share = (performance.now() - begin) / target;
    return share > 1.1 || share < 0.7 ? clamp(divisor * clamp(Math.sqrt(share / 0.9), 0.5, 2), 1, 8) : divisor;
  }

  // Draws pieces of the whole picture for so many milliseconds, and shows it once it is complete.
  continuePicture(target) {
    const { renderer } = this, begin = performance.now();
    if (this.isDraft) this.startPicture();
    this.isDraft = false;
    while (!renderer.complete && performance.now() - begin < target) {
      const before = performance.now();
      renderer.advance(1);
      renderer.waitForPicture();
      renderer.layers.took(performance.now() - before, target / 2);
    }
    if (renderer.complete) renderer.show();
  }

  // Begins the picture, or a draft that is so many times smaller.
  startPicture(divisor = 0) {
    const { state } = this;
    this.stale = false;
    this.resize(divisor || 1);
    if (this.needsLengths()) this.computeLengths();
    this.time ??= this.scene.time;
    const cameraAt = this.scene.layers?.camera_path && (time => this.cameraAt(time));
    this.renderer.start(this.look, { ...state, fewer: divisor ? 4 : 1, camera: this.cameraAt(this.time), cameraAt, time: this.time });
  }

  resize(divisor) {
    const ratio = devicePixelRatio, { clientWidth, clientHeight } = this.canvas, { columns, rows } = this.sheet ?? { columns: 1, rows: 1 };
    const [width, height] = this.size ?? [clientWidth * ratio / columns, clientHeight * ratio / rows];
    const [w, h] = [width, height].map(x => clamp(Math.round(x / divisor), 1, LARGEST_SIZE));
    this.renderer.size = { width: w, height: h };
    if (divisor === 1) this.fullSize = this.renderer.size;
    this.place = `${clientWidth} ${clientHeight}`;
  }

  // --- Exact transmittance ---

  // Exact lengths follow the sun once it rests, because they take a while; those of the module (web/) follow it at once.
  needsLengths() {
    const { light, against, sun, show } = this.state;
    return [light, against, show === 'error' && 'exact'].includes('exact') && this.lengthsKey !== String(sun) && (this.scene.lengths || !this.pointers.size);
  }

  // ℓ from every vertex along a direction.
  lengthsTowards(direction) {
    const { scene } = this;
    if (scene.lengths) return scene.lengths(direction);
    const lengths = new Float32Array(scene.arrays.positions.length / 3);
    for (const inside of this.insideLengths()) lengths.set(inside.towards(direction), inside.part.first_vertex);
    return lengths;
  }

  insideLengths() {
    this.insides ??= this.scene.parts.map(part => new InsideLengths(this.scene.arrays, part));
    if (!this.insides.every(inside => inside.isClosed)) throw new Error('This mesh is open, so there are no exact lengths inside it.');
    return this.insides;
  }

  computeLengths() {
    this.lengthsKey = String(this.state.sun);
    try {
      this.skyLengths ??= this.lengthsTowards([0, 1, 0]);
      const sun = this.lengthsTowards(directionFromAngles(...this.state.sun)), both = new Float32Array(2 * sun.length);
      for (let v = 0; v < sun.length; ++v) both[2 * v] = sun[v], both[2 * v + 1] = this.skyLengths[v];
      this.renderer.setLengths(both);
      this.sunLengths = sun;
      this.errorKey = null;
    } catch (error) {
      this.tell(error.message);
      const { light, against } = this.state, without = name => name === 'exact' ? 'lobe' : name;
      this.change({ light: without(light), against: against === 'exact' ? 'none' : against, ...(this.state.show === 'error' ? { show: 'picture' } : {}) });
    }
  }

  // What the colours of the error mean, with the rms over all vertices; not for harmonics, whose light only the graphics card knows.
  errorText() {
    const { state: { light, density, sun }, scene: { parts, arrays } } = this, to_sun = directionFromAngles(...sun);
    if (!this.sunLengths || !['lobe', 'compared'].includes(light)) return 'T: red too light, blue too dark';
    let sum = 0;
    for (const part of parts) {
      const other = light === 'compared' && part.compared, lobes = other ? arrays.compared : arrays.lobes, shape = other ? other.shape : this.renderer.shapeOf(part), extinction = part.extinction * density;
      for (let v = part.first_vertex; v < part.first_vertex + part.vertices; ++v) {
        const by_lobe = Math.exp(-extinction * insideByLobe(lobes, v, to_sun, shape)), exact = Math.exp(-extinction * this.sunLengths[v]);
        sum += (by_lobe - exact) ** 2;
      }
    }
    return `T off by ${Math.sqrt(sum / this.sunLengths.length).toFixed(3)} rms: red too light, blue too dark`;
  }

  // --- Vertices ---

  // Where the picture is on the page: a fixed size may have another shape than the window.
  pictureBox() {
    const { clientWidth, clientHeight, width, height } = this.sheet?.tiles[0].canvas ?? this.canvas, scale = Math.min(clientWidth / width, clientHeight / height);
    return { left: (clientWidth - width * scale) / 2, top: (clientHeight - height * scale) / 2, width: width * scale, height: height * scale };
  }

  // The place of a vertex on the page, and how far it is along the view.
  project(position) {
    const { eye, right, up, forward, scale } = this.renderer.view, offset = add(position, eye, -1), w = dot(offset, forward), { left, top, width, height } = this.pictureBox();
    return { x: left + (1 + dot(offset, right) * scale[0] / w) / 2 * width, y: top + (1 - dot(offset, up) * scale[1] / w) / 2 * height, w };
  }

  positionOf(v) { return [...this.scene.arrays.positions.subarray(3 * v, 3 * v + 3)]; }

  // Of the vertices that face the camera near a place of the page, the nearest to the camera.
  vertexAt(x, y) {
    const { normals } = this.scene.arrays, { eye } = this.renderer.view, near = 12;  // pixels
    let found = -1, nearest = Infinity;
    for (let v = 0; v < normals.length / 3; ++v) {
      const position = this.positionOf(v), at = this.project(position);
      if (at.w > 0 && at.w < nearest && Math.hypot(at.x - x, at.y - y) < near && dot(normals.subarray(3 * v, 3 * v + 3), add(position, eye, -1)) < 0)
        [found, nearest] = [v, at.w];
    }
    return found;
  }

  vertexText(v) {
    const { lobes } = this.scene.arrays, part = this.scene.parts.find(one => v < one.first_vertex + one.vertices), numbers = (values, digits) => values.map(x => x.toFixed(digits)).join(', ');
    const direction = [...lobes.subarray(4 * v, 4 * v + 3)], thickness = lobes[4 * v + 3], to_sun = directionFromAngles(...this.state.sun);
    const [k, b] = this.renderer.shapeOf(part), extinction = part.extinction * this.state.density;
    const inside = insideByLobe(lobes, v, to_sun, [k, b]);
    const lines = [`Vertex ${v} at ${numbers(this.positionOf(v), 3)}`, `o = ${numbers(direction, 3)}`, `d = ${thickness.toFixed(4)}`, `T to the sun: ${Math.exp(-extinction * inside).toFixed(4)} by the lobe`];
    try {
      const [exact] = this.insideLengths()[this.scene.parts.indexOf(part)].towards(to_sun, [v - part.first_vertex]);
      lines[3] += `, ${Math.exp(-extinction * exact).toFixed(4)} exact`;
    } catch ({ message }) {
      lines.push(`No exact value: ${message}`);
    }
    return lines.join('\n');
  }

  // --- Controls ---

  // What lies over the picture.
  showOverlays() {
    const { state, isBare } = this, compares = state.against !== 'none' && !isBare, names = this.lightsOf(this.scene);
    for (const id of ['divider', 'divider-line', 'left-side', 'right-side']) element(id).hidden = !compares;
    if (compares) {
      const { left, width } = this.pictureBox(), { clientWidth } = this.canvas, at = left + state.split * width;
      Object.assign(element('divider'), { value: state.split }).style.cssText = `left: ${left}px; width: ${width}px`;
      element('divider-line').style.left = `${at}px`;
      Object.assign(element('left-side'), { textContent: names[state.light] }).style.right = `${clientWidth - at + 8}px`;
      Object.assign(element('right-side'), { textContent: names[state.against] }).style.left = `${at + 8}px`;
    }
    const shows_error = state.show === 'error' && !isBare;
    element('error-side').hidden = !shows_error;
    if (shows_error && this.errorKey !== this.renderer.lightsKey) {  // not for every sample of a picture
      this.errorKey = this.renderer.lightsKey;
      element('error-side').textContent = this.errorText();
    }
    element('mark').toggleAttribute('hidden', state.vertex < 0 || isBare);
    if (state.vertex < 0 || isBare) return;
    const [circle, line] = element('mark').children, position = this.positionOf(state.vertex), lobe = [...this.scene.arrays.lobes.subarray(4 * state.vertex, 4 * state.vertex + 4)];
    const from = this.project(position), to = this.project(add(position, lobe, lobe[3]));
    for (const [shape, values] of [[circle, { cx: from.x, cy: from.y }], [line, { x1: from.x, y1: from.y, x2: to.x, y2: to.y }]])
      for (const [name, value] of Object.entries(values)) shape.setAttribute(name, value);
  }

  // The numbers beside the sliders. Screen readers have those of the sliders themselves.
  showNumbers() {
    const { state } = this, [azimuth, elevation] = state.sun;
    const texts = { 'sun-azimuth': `${azimuth.toFixed(0)}°`, 'sun-elevation': `${elevation.toFixed(0)}°`, hour: this.hour.toFixed(1), density: (firstPart(this.scene).extinction * state.density).toPrecision(3), time: `${(this.time ?? 0).toFixed(1)} s`, rate: state.rate.toFixed(0) };
    for (const id of ['sun-azimuth', 'sun-elevation', 'hour', 'density', 'time', 'rate', ...SLIDERS]) element(id).nextElementSibling.textContent = texts[id] ?? state[id].toFixed(2);
  }

  // The state in the controls and in the address.
  showState() {
    this.shownState = this.state;
    this.showAddress();
    const { state } = this, steps = Object.keys(STEPS[state.look]);
    element('sun-azimuth').value = state.sun[0];
    element('sun-elevation').value = state.sun[1];
    element('hour').value = this.hour;
    element('density').value = Math.log2(state.density);
    Object.assign(element('time'), { max: Math.max(120, this.scene.layers?.day?.seconds ?? 0), value: this.time ?? 0 });
    element('rate').value = state.rate;
    for (const id of SLIDERS) element(id).value = state[id];
    this.setOptions('show', { picture: 'Picture', ...Object.fromEntries(['drawn', ...steps].map(name => [name, STEP_NAMES(name)])), ...Object.fromEntries(CHANNELS.map(name => [name, CHANNEL_NAMES(name)])), error: ERROR_NAME });
    for (const id of ['asset', 'look', 'show', 'light', 'against']) element(id).value = state[id];
    element('show').disabled = state.look === 'plain';
    element('chain').hidden = state.look === 'plain';
    element('softness').disabled = element('erosion').disabled = state.look !== 'painted';
    element('vertex').value = state.vertex < 0 ? '' : state.vertex;
    const figures = element('vertex-figures'), text = state.vertex < 0 ? 'Click the cloud to choose a vertex.' : this.vertexText(state.vertex);
    if (figures.textContent !== text) figures.textContent = text;  // what is new is read out
    element('save-width').defaultValue = this.fullSize.width;  // what is shown until another size is typed
    element('save-height').defaultValue = this.fullSize.height;
  }

  // --- The keys of a scene ---

  // A slider and a field for each number of a scene file, by table.
  showKeys() {
    const { scene, scene: { layers, keys } } = this, list = element('keys');
    element('scene-keys').hidden = !keys;
    element('play').textContent = `${this.playing ? 'Stop' : 'Play'} ${layers ? 'time' : 'swirls'}`;
    list.replaceChildren(...keyTables(scene, this.look).map(table => this.tableOfKeys(table)));
    this.findKeys();
    this.showWritten();
  }

  // The lines of the keys that were set by hand, by table.
  showWritten() {
    const tables = new Map();
    for (const { id, title, name, value } of this.scene.written?.values() ?? []) {
      if (!tables.has(id)) tables.set(id, [`[${title}]`]);
      tables.get(id).push(`${name} = ${JSON.stringify(value).replaceAll(',', ', ')}`);
    }
    element('toml').value = [...tables.values()].map(lines => lines.join('\n')).join('\n\n');
  }

  tableOfKeys({ title, keys }) {
    const box = document.createElement('details'), heading = Object.assign(document.createElement('summary'), { textContent: title });
    box.append(heading);
    for (const { limits: [low, high, step, help], ...key } of keys)
      [key.holder[key.at]].flat().forEach((value, index, all) => {
        const one = { ...key, index, text: all.length > 1 ? `${key.name} ${'xyz'[index]}` : key.name };
        const label = typeof value === 'boolean' ? this.switchOf(one, value) : this.numberOf(one, value, { low, high, step });
        label.title = help;
        box.append(label);
      });
    return box;
  }

  switchOf(key, checked) {
    const label = document.createElement('label'), input = Object.assign(document.createElement('input'), { type: 'checkbox', checked });
    label.dataset.key = `${key.title} ${key.name}`;
    label.append(`${key.text} `, input);
    input.addEventListener('input', () => this.setKey(key, input.checked));
    return label;
  }

  // A slider about the value, as far as it may be moved either way without leaving the limits, and a field for every value within them.
  numberOf(key, value, { low, high, step }) {
    const label = document.createElement('label'), reach = Math.abs(value) || 1, [least, most] = [Math.max(low, value - reach), Math.min(high, value + reach)];
    const inputs = [{ type: 'range', min: least, max: most }, { type: 'number', min: low, max: high }].map(kind => {
      const input = Object.assign(document.createElement('input'), { ...kind, step: step || 'any', ariaLabel: `${key.title} ${key.text}` });
      input.value = value;  // after the limits, which would move it
      return input;
    });
    for (const input of inputs)
      input.addEventListener('input', () => {
        const number = clamp(input.valueAsNumber, low, high);
        for (const other of inputs) if (other !== input) other.value = number;
        this.setKey(key, number);
      });
    label.dataset.key = `${key.title} ${key.name}`;
    label.append(`${key.text} `, ...inputs);
    return label;
  }

  // Sets one number of a key, and writes its line. The scene knows what it was in its file.
  setKey({ title, id, name, path, holder, at, index }, value) {
    if (typeof value === 'number' && !Number.isFinite(value)) return;
    const written = this.scene.written ??= new Map(), key = path.join('.'), was = written.get(key)?.was ?? JSON.stringify(holder[at]);
    if (Array.isArray(holder[at])) holder[at][index] = value;
    else holder[at] = value;
    written.set(key, { id, title, name, was, value: structuredClone(holder[at]) });
    this.renderer.forget();
    this.showWritten();
    this.change({});
  }

  findKeys() {
    const wanted = element('find-key').value.toLowerCase();
    for (const box of element('keys').children) {
      let found = 0;
      for (const label of box.querySelectorAll('label')) {
        const fits = label.dataset.key.toLowerCase().includes(wanted);
        label.hidden = !fits;
        found += fits;
      }
      box.hidden = !found;
      box.open = wanted !== '' && found > 0;
    }
  }

  copyKeys() {
    element('toml').select();
    navigator.clipboard?.writeText(element('toml').value);
  }

  // A message over the picture, until the next one or until it is closed; none if there is no text.
  tell(text) {
    element('message-text').textContent = text;
    element('message').hidden = !text;
  }

  listen() {
    const { canvas } = this, onInput = (id, change) => element(id).addEventListener('input', event => change(event.target));
    this.listenToPointers();
    canvas.addEventListener('keydown', event => {
      if (event.ctrlKey || event.altKey || event.metaKey) return;  // the browser's own keys
      const [x, y] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key] ?? [0, 0];
      if (x || y) event.shiftKey ? this.moveSun(5 * x, 5 * y) : this.turn(5 * x, 5 * y);
      else if (event.key === '+' || event.key === '=') this.change({ zoom: this.state.zoom * 1.1 });
      else if (event.key === '-') this.change({ zoom: this.state.zoom / 1.1 });
      else if (event.key === 'Home') this.reset();
      else return;
      event.preventDefault();
    });
    for (const slider of document.querySelectorAll('#controls fieldset > label > [type=range]')) slider.after(Object.assign(document.createElement('output'), { ariaHidden: 'true' }));
    onInput('sun-azimuth', ({ valueAsNumber }) => this.change({ sun: [valueAsNumber, this.state.sun[1]] }));
    onInput('sun-elevation', ({ valueAsNumber }) => this.change({ sun: [this.state.sun[0], valueAsNumber] }));
    onInput('density', ({ valueAsNumber }) => this.change({ density: 2 ** valueAsNumber }));
    onInput('time', ({ valueAsNumber }) => { this.moveTime(valueAsNumber - this.time); this.request(); });
    onInput('rate', ({ valueAsNumber }) => this.change({ rate: valueAsNumber }));
    onInput('find-key', () => this.findKeys());
    element('copy-keys').addEventListener('click', () => this.copyKeys());
    onInput('hour', ({ valueAsNumber }) => this.setHour(valueAsNumber));
    onInput('divider', ({ valueAsNumber }) => this.change({ split: valueAsNumber }));
    onInput('vertex', ({ valueAsNumber }) => this.change({ vertex: valueAsNumber }));
    for (const id of SLIDERS) onInput(id, ({ valueAsNumber }) => this.change({ [id]: valueAsNumber }));
    for (const id of ['look', 'show', 'light', 'against']) onInput(id, ({ value }) => this.change({ [id]: value }));
    onInput('asset', ({ value }) => this.choose(+value));
    element('reset').addEventListener('click', () => this.reset());
    element('play').addEventListener('click', () => this.play(!this.playing));
    element('play-sun').addEventListener('click', () => this.playSun(!this.playingSun));
    element('save').addEventListener('click', () => this.save());
    element('close-message').addEventListener('click', () => this.tell(''));
    new ResizeObserver(() => { if (`${canvas.clientWidth} ${canvas.clientHeight}` !== this.place) this.request(); }).observe(canvas);
    this.followPixels();
    addEventListener('hashchange', () => this.readAddress());
    canvas.addEventListener('webglcontextlost', event => {
      event.preventDefault();
      document.documentElement.dataset.state = 'drawing';
    });
    canvas.addEventListener('webglcontextrestored', () => {
      try {
        this.renderer = this.newRenderer();
        this.drawnScene = null;
        this.change({});
      } catch (error) {
        fail(error);
      }
    });
    addEventListener('dragover', event => event.preventDefault());
    addEventListener('drop', event => {
      event.preventDefault();
      this.open(...event.dataTransfer.files);
    });
    if (location.protocol !== 'file:' && element('page').dataset.events) this.follow();
  }

  // A window may be moved to a screen of finer pixels.
  followPixels() {
    matchMedia(`(resolution: ${devicePixelRatio}dppx)`).addEventListener('change', () => {
      this.request();
      this.followPixels();
    }, { once: true });
  }

  listenToPointers() {
    const { canvas, pointers } = this;
    let moved = 0;
    canvas.addEventListener('pointerdown', event => {
      canvas.setPointerCapture(event.pointerId);
      moved = pointers.size ? Infinity : 0;  // two fingers do not click
      pointers.set(event.pointerId, event);
    });
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, event => {
      const is_click = pointers.delete(event.pointerId) && moved < 4 && name === 'pointerup' && event.button === 0;
      if (is_click && !this.sheet) this.change({ vertex: this.vertexAt(event.clientX, event.clientY) });
      else this.request();
    });
    canvas.addEventListener('pointermove', event => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const dx = event.clientX - before.clientX, dy = event.clientY - before.clientY;
      moved += Math.abs(dx) + Math.abs(dy);
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
    canvas.addEventListener('dblclick', () => this.reset());
  }

  turn(x, y) { this.change({ azimuth: this.state.azimuth + x, elevation: this.state.elevation + y }); }
  moveSun(x, y) { this.change({ sun: [this.state.sun[0] + x, this.state.sun[1] + y] }); }

  // By pixels of the page: what is at the target's distance follows the pointer.
  pan(dx, dy) {
    const { right, up, per_pixel: perPixel } = this.renderer.view, scale = perPixel * this.renderer.view.picture[0] / this.pictureBox().width * this.camera().distance;
    this.change({ shift: add(add(this.state.shift, right, -dx * scale), up, dy * scale) });
  }

  reset() { this.setState({ ...this.home }); }

  // Another asset in the same light, look and comparison.
  choose(asset) {
    const kept = ['sun', 'exposure', 'look', 'light', 'against', 'split', 'show'], changes = Object.entries(this.changes()).filter(([key]) => kept.includes(key));
    this.setState({ ...this.homeOf(this.page.scenes[asset]), ...Object.fromEntries(changes) });
  }

  play(is_on) {
    this.playing = is_on;
    this.shownState = null;  // the address says it
    element('play').setAttribute('aria-pressed', is_on);
    element('play').textContent = `${is_on ? 'Stop' : 'Play'} ${this.scene.layers ? 'time' : 'swirls'}`;
    this.request();
  }

  // The circle on which the sun goes around in a day, and its hour there. It is that of the scene's day, or one that begins with the first sun.
  // A sun that setHour() moved stays on its circle, also below the horizon, where the state keeps it at 20 degrees.
  get sunCircle() {
    const { state: { sun }, scene, home } = this;
    if (String(sun) !== this.sunOfHour) {
      this.sunOfHour = String(sun);
      this.circle = circleThrough(directionFromAngles(...sun), scene.layers?.day ? scene.layers.day.noon[0] : noonAzimuthAfter(home.sun));
    }
    return this.circle;
  }

  get hour() { return this.sunCircle.hour; }

  setHour(hour) {
    const { noon } = this.sunCircle;
    this.change({ sun: sunOfDay({ noon, hour, seconds: 0 }, 0) });
    this.circle = { noon, hour: hour % 24 };
    this.sunOfHour = String(this.state.sun);
  }

  // An hour per second.
  playSun(is_on) {
    this.playingSun = is_on;
    element('play-sun').setAttribute('aria-pressed', is_on);
    element('play-sun').textContent = `${is_on ? 'Stop' : 'Play'} sun`;
    this.request();
  }

  get moves() { return this.playing || this.playingSun; }

  // Adds dropped GLBs to the assets and shows the last one. Those that cannot be read are named.
  async open(...files) {
    const refusals = [];
    for (const file of files) {
      try {
        const scene = sceneOfGlb(await file.arrayBuffer(), file.name.replace(/\.glb$/i, ''), this.scene);
        if (scene.keys) ownLooks(scene, this.page.looks, this.page.looks);
        this.dropped.push(scene);
        this.page.scenes.push(scene);
        this.drawnScene = null;
        this.choose(this.page.scenes.length - 1);
      } catch (error) {
        refusals.push(`${file.name}: ${error.message}`);
      }
    }
    if (files.length) this.tell(refusals.join('\n'));
  }

  // New scenes of the server.
  follow() {
    const events = new EventSource('events');
    events.addEventListener('scene', event => {
      this.tell('');
      this.setPage(JSON.parse(event.data)).catch(({ message }) => this.tell(`The new picture cannot be shown: ${message}`));
    });
    events.addEventListener('failure', event => this.tell(JSON.parse(event.data)));
    events.addEventListener('error', () => this.tell('The server does not answer; the picture is the last one.'));
    events.addEventListener('open', () => this.tell(''));
  }

  // The whole picture at another size, then the page's own again.
  save() {
    const fields = ['save-width', 'save-height'].map(element), own = this.size, { renderer: { gl }, scene: { name } } = this;
    if (!fields.every(field => field.reportValidity())) return;
    const [width, height] = this.size = fields.map(field => field.valueAsNumber);
    if (this.sheet) {
      this.drawSheetStep(true);
      while (!this.sheet.isComplete) this.drawSheetStep(false);
    } else {
      this.startPicture();
      while (!this.renderer.complete) this.renderer.advance(this.look.samples.length);
      this.renderer.show();
    }
    const error = gl.getError(), is_sized = gl.drawingBufferWidth === width && gl.drawingBufferHeight === height;
    const trouble = gl.isContextLost() ? 'the graphics card is not available now' : !is_sized || error === gl.OUT_OF_MEMORY ? 'it is too large for this graphics card'
      : error !== gl.NO_ERROR ? `WebGL reports the error ${error}` : '';
    (this.sheet?.joined() ?? this.canvas).toBlob(blob => {
      if (trouble || !blob) {
        this.tell(`A picture of ${width} x ${height} pixels cannot be saved: ${trouble || 'the browser cannot encode it'}.`);
        return;
      }
      const link = Object.assign(document.createElement('a'), { href: URL.createObjectURL(blob), download: `${name}.png` });
      link.click();
      URL.revokeObjectURL(link.href);
    });
    this.size = own;  // toBlob() has copied the picture
    this.request();
  }
}

// Nothing can be drawn: the page is a message.
function fail({ message }) {
  element('message-text').textContent = message;
  for (const other of document.querySelectorAll('main > :not(h1, #message), #close-message')) other.toggleAttribute('hidden', true);
  element('message').hidden = false;
  document.documentElement.dataset.state = 'failed';
}

if (element('page').dataset.waits === undefined) (async () => {
  try {
    window.viewer = new Viewer();
    await window.viewer.begin();
  } catch (error) {
    fail(error);
  }
})();
