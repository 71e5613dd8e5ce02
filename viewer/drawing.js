// The frames of the page. While something moves a pixel has few samples; when it rests it gets the others, and is shown again once it has
// all.

import { LARGEST_SIZE } from './address.js';
import { element, fail, setPageState } from './dom.js';
import { Gpu } from './gpu.js';
import { Renderer } from './renderer.js';
import { picturesAt, showCasters, showMeshes } from './sequences.js';
import { isVertex } from './state.js';
import { clamp } from './vectors.js';

const FRAME_MILLISECONDS = 40;  // that a step of a picture should take

export class Drawing {
  /** @param {Viewer} viewer */
  constructor(viewer) {
    this.viewer = viewer;
    this.canvas = viewer.canvas;
    this.divisor = 2;  // of drafts of layered scenes
    this.fullSize = { width: 1, height: 1 };  // of a picture that is no draft
    this.chunks = { first: 1, next: 1 };  // samples in the first step of a picture, which has more to do, and in the next ones
    this.isDraft = false;
    this.frame = 0;
    /** Those that are blended while a cloud changes its mesh, and the number of the one that is drawn. @type {FadedPicture[]} */
    this.pictures = [];
    this.picture = 0;
    this.begin();
  }

  // With graphics that know nothing yet, as after they were lost.
  begin() {
    const gpu = new Gpu(this.canvas, name => element(`shader ${name}`).textContent);
    this.renderer = new Renderer(gpu, this.viewer.layering?.SceneLayers);
  }

  /** @param {Scene} scene */
  useScene(scene) {
    this.renderer.setScene(scene);
    this.segments = undefined;
    this.sheet = scene.layers?.is_sheet ? new this.viewer.layering.TechniqueSheet(scene) : null;
    element('sheet').hidden = !this.sheet;
  }

  useTile(tile) { if (this.renderer.scene !== tile.scene) this.renderer.setScene(tile.scene); }

  request() {
    this.isStale = true;
    setPageState('drawing');
    if (!this.frame) this.frame = requestAnimationFrame(now => this.draw(now));
  }

  draw(now) {
    const { gl } = this.renderer.gpu;
    this.frame = 0;
    if (gl.isContextLost()) return;
    try {
      this.drawFrame(now);
    } catch (error) {
      if (!gl.isContextLost()) fail(error);
    }
  }

  drawFrame(now) {
    const { viewer, renderer } = this, begin = performance.now(), between = now - this.drawnAt;
    this.drawnAt = now;
    viewer.move(Math.min(0.1, between / 1000 || 0));
    this.drawStep(this.isStale || viewer.moves);
    const { gpu: { size: { width, height } }, samples } = renderer, all = viewer.look.samples.length;
    const figures = [`${samples} of ${all} samples`, `${(performance.now() - begin).toFixed(0)} ms`, `${(1000 / between).toFixed(0)} fps`];
    element('figures').textContent = [`${width} × ${height}`, ...figures].join(', ');
    const is_final = renderer.complete && !this.isDraft && !viewer.moves && !viewer.light.isNeeded && !viewer.volume.isNeeded;
    if (this.isLast) viewer.showStep(is_final);
    if (is_final) setPageState('ready');
    else this.frame ||= requestAnimationFrame(next => this.draw(next));
  }

  drawStep(is_first) {
    const target = 1000 / this.viewer.state.rate;
    if (this.sheet) this.sheet.draw(this, is_first, target);
    else if (this.viewer.scene.layers) this.drawLayeredStep(is_first, target);
    else this.drawSampledStep(is_first);
  }

  drawSampledStep(is_first) {
    const { renderer, chunks } = this, begin = performance.now(), step = is_first ? 'first' : 'next';
    if (is_first || this.isDraft) this.startPicture();
    const before = renderer.samples;
    if (is_first) this.showSoon(chunks.first);
    else renderer.drawSamples(chunks.next);
    const drawn = renderer.samples - before, is_over = renderer.complete;
    this.isDraft = is_first && !is_over && this.pictures.length > 1;
    if (!is_first && is_over) this.showPicture();
    renderer.gpu.waitForPicture();
    if (is_first || !is_over)  // the last step has few samples, and shows them
      chunks[step] = clamp(Math.round(drawn * FRAME_MILLISECONDS / (performance.now() - begin)), 1, 64);
  }

  // Shows the picture of so many samples; all of those that are blended.
  showSoon(samples) {
    for (let is_last = false; !is_last;) {
      this.renderer.drawSamples(samples);
      is_last = this.isLast;
      this.showPicture();
    }
  }

  get isLast() { return this.picture === this.pictures.length - 1; }

  // Shows the picture, or blends it with others and begins the next one.
  showPicture() {
    const { renderer, pictures, picture, isLast } = this;
    if (pictures.length === 1) renderer.show();
    else renderer.showBlended(pictures[picture].weight, picture, isLast);
    if (!isLast) this.startMeshes(picture + 1);
  }

  // While something moves, a picture of fewer pixels and steps is drawn as a whole; when it rests, the whole picture in pieces, behind it.
  drawLayeredStep(is_first, target) {
    if (is_first) this.divisor = this.drawDraft(this.divisor, target);
    else this.continuePicture(target);
  }

  // Draws a picture that is so many times smaller, and returns the number of times for the next one to take so many milliseconds.
  drawDraft(divisor, target) {
    const { renderer } = this, begin = performance.now();
    this.startPicture(divisor);
    this.isDraft = true;
    this.showSoon(1);
    renderer.gpu.waitForPicture();
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
      renderer.gpu.waitForPicture();
      renderer.layers.took(performance.now() - before, target / 2);
    }
    if (renderer.complete) this.showPicture();
  }

  // Draws the whole picture at once, and returns the canvas that has it.
  drawWhole() {
    const { renderer, sheet } = this;
    if (sheet) {
      this.drawStep(true);
      while (!sheet.isComplete) this.drawStep(false);
      return sheet.joined();
    }
    this.startPicture();
    for (let is_last = false; !is_last;) {
      while (!renderer.complete) renderer.advance(this.viewer.look.samples.length);
      is_last = this.isLast;
      this.showPicture();
    }
    return this.canvas;
  }

  // Begins the picture, or a draft that is so many times smaller.
  startPicture(divisor = 0) {
    const { viewer: { clock: { time } }, renderer: { scene } } = this;
    this.isStale = false;
    this.resize(divisor || 1);
    this.fewer = divisor ? 4 : 1;
    this.pictures = picturesAt(scene, time + (scene.time_offset ?? 0));
    showCasters(scene, this.pictures.at(-1));
    this.startMeshes(0);
  }

  // A vertex stays chosen as long as it is on the same mesh.
  keepVertex() {
    const { viewer, viewer: { scene, state }, pictures, segments } = this;
    this.segments = String([...pictures.at(-1).seen.values()].map(({ segment }) => segment));
    if (state.vertex < 0 || (this.segments === (segments ?? this.segments) && isVertex(scene, state.vertex))) return;
    viewer.state = { ...state, vertex: -1 };
  }

  // Begins one of the pictures with its meshes.
  startMeshes(picture) {
    const { viewer, viewer: { state, clock: { time }, scene: { layers } }, renderer, fewer } = this;
    this.picture = picture;
    if (showMeshes(renderer.scene, this.pictures[picture])) {
      renderer.takeMeshes();
      viewer.light.forget();
      viewer.volume.forget();
    }
    if (this.isLast) this.keepVertex();
    viewer.light.computeIfNeeded();
    viewer.volume.computeIfNeeded();
    renderer.volume = viewer.volume.field ? viewer.volume : null;
    const cameraAt = layers?.camera_path && (at => viewer.cameraAt(at));
    renderer.start(viewer.look, { ...state, fewer, camera: viewer.cameraAt(time), cameraAt, time });
  }

  resize(divisor) {
    const { viewer: { size }, canvas: { clientWidth, clientHeight } } = this, { columns, rows } = this.sheet ?? { columns: 1, rows: 1 };
    const pixels = size ?? [clientWidth * devicePixelRatio / columns, clientHeight * devicePixelRatio / rows];
    const [width, height] = pixels.map(x => clamp(Math.round(x / divisor), 1, LARGEST_SIZE));
    this.renderer.gpu.size = { width, height };
    if (divisor === 1) this.fullSize = { width, height };
    this.place = `${clientWidth} ${clientHeight}`;
    this.freePlace = JSON.stringify(this.viewer.freeBox);
  }
}
