// A scene with layout = "techniques": each of its clouds alone, live, with the milliseconds and bytes that it costs.

import { element, make } from '../dom.js';

// The same scene for each technique: techniquesSheet of pipeline/picture/scene_picture.cpp. What a technique does not change is the scene's
// own, also after one of its keys is set.
function techniquesOf(scene) {
  const { layers, parts, arrays, scattered } = scene, found = [];
  const vertices = (arrays.positions.length + (scattered?.arrays.positions.length ?? 0)) / 3;
  const empty = values => values.BYTES_PER_ELEMENT ? new values.constructor(0) : 0;
  const none = { ...Object.fromEntries(Object.entries(arrays).map(([name, values]) => [name, empty(values)])), layers: arrays.layers };
  const alone = (name, cost, only, changes) =>
    found.push({ name, cost, scene: Object.assign(Object.create(scene), { ...changes, layers: { ...layers, only } }) });
  if (parts.length || scattered)
    alone('mesh clouds', `${(16 * vertices / 1000).toFixed(0)} kB, 16 bytes × ${vertices.toLocaleString('en')} vertices`, ['mesh', 0], {});
  for (const [kind, name] of [['slabs', 'cartoon slab'], ['distance', 'marched, distance'], ['density', 'marched, density'],
    ['dust', 'dust']])
    for (const index of layers[kind].keys()) {
      const lattice = kind === 'dust' && arrays.layers.lattices[layers.dust_places[index].lattice];
      const cost = lattice ? `${(lattice.values.byteLength / 1000).toFixed(0)} kB, a lattice of harmonics` : 'no bytes, a march per pixel';
      alone(name, cost, [kind, index], { parts: [], corners: [], casters: [], arrays: none, scattered: undefined });
    }
  return found;
}

// The pictures over the canvas in which they are drawn one after the other.
export class TechniqueSheet {
  /** @param {Scene} scene */
  constructor(scene) {
    this.tiles = techniquesOf(scene).map(technique => {
      const figure = make('figure', {}), canvas = make('canvas', {}), caption = make('figcaption', {});
      figure.append(canvas, caption);
      return { ...technique, figure, canvas, caption, divisor: 4, milliseconds: 0 };
    });
    element('sheet').replaceChildren(...this.tiles.map(({ figure }) => figure));
    this.columns = Math.min(2, this.tiles.length);
    this.rows = Math.ceil(this.tiles.length / this.columns);
    this.next = 0;  // the tile that is to be completed
  }

  get isComplete() { return this.next === this.tiles.length; }

  // A step of the picture, of about so many milliseconds: drafts of all techniques, or a piece of one after the other.
  draw(drawing, is_first, target) {
    if (is_first) this.drawDrafts(drawing, target / this.tiles.length);
    else this.continueTile(drawing, this.tiles[this.next], target);
  }

  drawDrafts(drawing, target) {
    this.next = 0;
    for (const tile of this.tiles) {
      drawing.useTile(tile);
      const begin = performance.now();
      tile.divisor = drawing.drawDraft(tile.divisor, target);
      this.take(tile, drawing.canvas, performance.now() - begin, 'draft');
      tile.milliseconds = 0;
    }
  }

  // The last tile that is completed ends the draft.
  continueTile(drawing, tile, target) {
    const begin = performance.now();
    drawing.useTile(tile);
    drawing.continuePicture(target);
    tile.milliseconds += performance.now() - begin;
    if (!drawing.renderer.complete) return;
    this.take(tile, drawing.canvas, tile.milliseconds, 'picture');
    ++this.next;
    drawing.isDraft = !this.isComplete;
  }

  // Takes over what was drawn, within so many milliseconds.
  take(tile, drawn, milliseconds, what) {
    Object.assign(tile.canvas, { width: drawn.width, height: drawn.height });
    tile.canvas.getContext('2d').drawImage(drawn, 0, 0);
    tile.caption.textContent = `${tile.name}: ${milliseconds.toFixed(0)} ms (${what} of ${drawn.width} × ${drawn.height}); ${tile.cost}`;
  }

  // All pictures side by side, with their captions, on one canvas.
  joined() {
    const { tiles, columns, rows } = this, { width, height } = tiles[0].canvas, text = Math.max(10, height / 30);
    const canvas = make('canvas', { width: columns * width, height: rows * height }), context = canvas.getContext('2d');
    context.font = `${text}px sans-serif`;
    for (const [i, tile] of tiles.entries()) {
      const x = i % columns * width, y = Math.floor(i / columns) * height;
      context.drawImage(tile.canvas, x, y);
      context.fillStyle = '#111a27d1';
      context.fillRect(x, y, context.measureText(tile.caption.textContent).width + text, 1.6 * text);
      context.fillStyle = '#f2f6fa';
      context.fillText(tile.caption.textContent, x + text / 2, y + 1.1 * text);
    }
    return canvas;
  }
}
