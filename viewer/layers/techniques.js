// A scene with layout = "techniques": each of its clouds alone, live, with the milliseconds and bytes that it costs.
'use strict';

// The same scene for each technique: techniquesSheet of pipeline/picture/scene_picture.cpp. What a technique does not change is the scene's own,
// also after one of its keys is set.
function techniquesOf(scene) {
  const { layers, parts, arrays } = scene, vertices = arrays.positions.length / 3, found = [];
  const none = Object.fromEntries(Object.entries(arrays).map(([name, values]) => [name, values.BYTES_PER_ELEMENT ? new values.constructor(0) : 0]));
  const add = (name, cost, only, changes) => found.push({ name, cost, scene: Object.assign(Object.create(scene), { ...changes, layers: { ...layers, only } }) });
  if (parts.length) add('mesh clouds', `${(16 * vertices / 1000).toFixed(0)} kB, 16 bytes × ${vertices.toLocaleString('en')} vertices`, ['mesh', 0], {});
  for (const [kind, name] of [['slabs', 'cartoon slab'], ['distance', 'marched, distance'], ['density', 'marched, density']])
    for (const index of layers[kind].keys()) add(name, 'no bytes, a march per pixel', [kind, index], { parts: [], corners: [], casters: [], arrays: none });
  return found;
}

// The pictures over the canvas in which they are drawn one after the other.
class TechniqueSheet {
  constructor(scene) {
    this.tiles = techniquesOf(scene).map(technique => {
      const figure = document.createElement('figure'), canvas = document.createElement('canvas'), caption = document.createElement('figcaption');
      figure.append(canvas, caption);
      return { ...technique, figure, canvas, caption, divisor: 4, milliseconds: 0 };
    });
    element('sheet').replaceChildren(...this.tiles.map(({ figure }) => figure));
    this.columns = Math.min(2, this.tiles.length);
    this.rows = Math.ceil(this.tiles.length / this.columns);
    this.next = 0;  // the tile that is to be completed
  }

  get isComplete() { return this.next === this.tiles.length; }

  // Takes over what was drawn, within so many milliseconds.
  take(tile, drawn, milliseconds, what) {
    Object.assign(tile.canvas, { width: drawn.width, height: drawn.height });
    tile.canvas.getContext('2d').drawImage(drawn, 0, 0);
    tile.caption.textContent = `${tile.name}: ${milliseconds.toFixed(0)} ms (${what} of ${drawn.width} × ${drawn.height}); ${tile.cost}`;
  }

  // All pictures side by side, with their captions, on one canvas.
  joined() {
    const [{ canvas: { width, height } }] = this.tiles, canvas = Object.assign(document.createElement('canvas'), { width: this.columns * width, height: this.rows * height }), context = canvas.getContext('2d');
    const text = Math.max(10, height / 30);
    context.font = `${text}px sans-serif`;
    for (const [i, tile] of this.tiles.entries()) {
      const x = i % this.columns * width, y = Math.floor(i / this.columns) * height;
      context.drawImage(tile.canvas, x, y);
      context.fillStyle = '#fffffff0';
      context.fillRect(x, y, context.measureText(tile.caption.textContent).width + text, 1.6 * text);
      context.fillStyle = '#16202c';
      context.fillText(tile.caption.textContent, x + text / 2, y + 1.1 * text);
    }
    return canvas;
  }
}
