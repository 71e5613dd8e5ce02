// The looks of `preview` in WebGL2. A picture is drawn sample by sample and is final once every pixel has all of them.

import { CHANNELS, LAMPS, OWN, SHOWN, drawChain } from './chains.js';
import { CloudShade } from './cloud_shade.js';
import { Fields } from './fields.js';
import { Impostors } from './impostors.js';
import { drawPlainSample } from './plain.js';
import { Vertices } from './vertices.js';
import { cloudBox, viewOf } from './view.js';

export class Renderer {
  /** `SceneLayers`: draws the layers of scenes that have some. @param {Gpu} gpu */
  constructor(gpu, SceneLayers) {
    this.gpu = gpu;
    this.SceneLayers = SceneLayers;
    /** Inside the mesh of the scene, once something needs it. @type {import('./volume.js').Volume | null} */
    this.volume = null;
    this.draws = 0;  // pictures since the page was opened
  }

  /** What the program wrote about a scene, with `arrays`. @param {Scene} scene */
  setScene(scene) {
    this.scene = scene;
    this.layers = scene.layers ? new this.SceneLayers(this) : null;
    this.takeMeshes();
    this.impostors = Impostors.areIn(scene) ? new Impostors(this.gpu, scene) : null;
    this.skyKey = null;
  }

  // Vertices, triangles or casters of the scene are others than before.
  takeMeshes() {
    const { gpu, scene } = this;
    this.vertices?.delete();
    this.vertices = new Vertices(gpu, scene);
    this.fields?.delete();
    this.shade = new CloudShade(scene);
    this.fields = scene.scattered ? new Fields(gpu, scene) : null;
  }

  // Settings have changed: the sky is to be drawn anew.
  forget() { this.skyKey = null; }

  viewOf(chosen) { return viewOf(this.scene, this.look, this.gpu.size, this.layers, chosen); }

  /** Begins a new picture. @param {Look} look */
  start(look, chosen) {
    const { gpu, layers } = this;
    this.look = look;
    layers?.begin(chosen);
    this.view = this.viewOf(chosen);
    if (layers) this.view.was = layers.wasAt(chosen);
    this.box = cloudBox(this.corners, look, this.view, gpu.size);
    this.samples = 0;
    this.work = null;
    this.fields?.moveTo(this.view.time);
    this.shade.update(this.view, this.fields?.all ?? []);
    layers?.shadows.takeGrid(this.shade);
    this.vertices.light(this.view, look, layers, this.volume, this.shade);
    this.fields?.place(this.view, this.shade, points => this.vertices.sharesAt(points, layers));
    const { to_sun, forward, picture, per_pixel, eye, fewer } = this.view;
    const key = JSON.stringify([look.kind, to_sun, forward, picture, per_pixel, layers && [eye, fewer, layers.settings]]);
    if (key !== this.skyKey) this.drawSky();
    this.skyKey = key;
    for (const light of this.shown) gpu.clear([gpu.target(`${light}sums 0`, this.drawnSize)], [0, 0, 0, 0]);
  }

  // The sky changes with camera and sun alone.
  drawSky() {
    const { gpu, look: { sky_places, samples, kind }, layers } = this;
    if (layers?.drawSky()) return;
    const files = layers?.skyFiles ?? ['sky', 'view', 'sky_uniforms', 'plain_sky'], places = kind === 'plain' ? samples : sky_places;
    const values = { ...this.view, centers: 'centers', places, count: places.length, everywhere: kind !== 'painted' };
    gpu.fill([gpu.target('centers')], gpu.program('sky.frag', files), values);
    gpu.fill([gpu.target('background')], gpu.program('sky_edges.frag', files), values);
  }

  // Of a box that holds all that is drawn of the clouds.
  get corners() {
    const { scene, volume, view: { light, against } } = this;
    return volume && [light, against].includes('volume') ? volume.field.corners() : scene.corners;
  }

  // As the graphics card's, where the picture may have clouds.
  fillBox(targets, program, values, other) { this.gpu.fillBox(this.box, targets, program, values, other); }

  // Whether the picture is composed of layers; single channels and the error are of the clouds alone.
  get isLayered() { return !!this.layers && this.view.show !== 'error' && !CHANNELS.includes(this.view.show); }

  // The lights and colours that are drawn and go through the chain: those of lamps only while one shines.
  get shown() {
    const { view: { lamp_count, show }, look } = this, [light] = SHOWN;
    if (!look.chain || show === 'error' || CHANNELS.includes(show)) return [light];
    return [light, ...(lamp_count ? LAMPS : []), ...(this.hasOwnColors ? OWN : [])];
  }

  get hasOwnColors() {
    const { look, scene: { arrays, scattered } } = this;
    return look.own_colors && [arrays, scattered?.arrays].some(one => one?.colors?.length);
  }

  get hasClouds() { return !!this.fields || !!this.impostors || this.scene.parts.some(part => part.count); }

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
    const { gpu: { size: { width, height } }, divisor } = this;
    return { width: Math.ceil(width / divisor), height: Math.ceil(height / divisor) };
  }

  // So many pixels to a side are drawn for each pixel of a sample, of which one is used. Graphics cards move vertices to 1/256 of a pixel;
  // in a picture that is drawn smaller than the canvas this is much, and each sample that it moves off the cloud's rim leaves a blot.
  get fineness() {
    const { drawnSize: { width, height }, divisor } = this, pixels = 1 << 22;
    return divisor === 1 ? 1 : Math.max(divisor, Math.floor(Math.sqrt(pixels / (width * height))));
  }

  // Draws `count` more samples of the clouds.
  drawSamples(count) {
    const { gpu, look, fineness } = this, all = look.samples.length, size = this.drawnSize;
    if (!this.hasClouds) this.samples = all;
    for (const end = Math.min(all, this.samples + count); this.samples < end; ++this.samples) {
      const place = look.samples[this.samples].map(x => x * fineness), pixel = place.map(Math.floor);
      const in_pixel = place.map((x, i) => x - pixel[i]);
      const from = `sums ${this.samples % 2}`, to = `sums ${(this.samples + 1) % 2}`;
      for (const light of this.shown) {
        if (look.kind === 'plain') drawPlainSample(this, in_pixel);
        else this.drawSurface(in_pixel, { width: size.width * fineness, height: size.height * fineness }, SHOWN.indexOf(light));
        this.fillBox([gpu.target(light + to, size)], gpu.program('accumulate.frag'),
          { sums: light + from, samples: 'sample', share: 1 / all, fineness, pixel: [pixel[0], fineness - 1 - pixel[1]] }, [0, 0, 0, 0]);
      }
    }
  }

  // The nearest surface at one sample of each pixel.
  drawSurface(place, size, shown) {
    const { gpu } = this, sample = gpu.target('sample', size), depth = gpu.target('depth 0', size, gpu.gl.DEPTH_COMPONENT32F);
    gpu.drawNearest([sample], depth, () => {
      this.vertices.draw('cloud.frag', this.view, size, place, {}, shown);
      this.fields?.draw('cloud.frag', this.view, this.look, size, place, shown);
    });
  }

  // Draws the picture of the samples so far.
  show() {
    const { gpu } = this;
    ++this.draws;
    if (this.look.kind === 'plain') {
      gpu.fill([], gpu.program('plain.frag', ['tone']), { ...this.view, ...this.sums, background: 'background', box: this.box });
    } else if (!this.isLayered) {
      this.drawMean();
    } else {
      for (const work = this.drawScene(); !this.layers.isComposed;) work.next();  // of the samples so far
      this.layers.show();
    }
  }

  // Draws the picture of the samples so far, which counts so much, and adds it to those that were blended before. Shows the last one.
  showBlended(weight, number, is_last) {
    const { gpu } = this, [from, to] = [0, 1].map(i => `blended ${(number + i) % 2}`);
    gpu.screen = gpu.target('one picture');
    this.show();
    gpu.screen = null;
    if (number === 0) gpu.clear([gpu.target(from)], [0, 0, 0, 0]);
    gpu.fill(is_last ? [] : [gpu.target(to)], gpu.program('accumulate.frag'),
      { sums: from, samples: 'one picture', share: weight, fineness: 1, pixel: [0, 0] });
  }

  // The samples so far.
  get sums() { return { sums: `sums ${this.samples % 2}`, share: this.samples / this.look.samples.length }; }

  // Their mean, and the chain.
  drawMean() {
    const { gpu, sums: { sums, share } } = this;
    for (const light of this.shown) {
      const name = `${light}drawn`, start = target => this.fillBox([target], gpu.program('mean.frag'), { sums: light + sums, share });
      if (this.impostors) this.impostors.draw(this, name, this.drawnSize, SHOWN.indexOf(light), start);
      else start(gpu.target(name, this.drawnSize));
    }
    drawChain(this);
  }
}
