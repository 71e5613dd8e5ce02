// What lies over the picture: the divider between two lights, what the colours of the error mean, the mark of a vertex.

import { element } from './dom.js';
import { pictureBox, positionOf, project } from './picking.js';
import { lightsOf } from './state.js';
import { add } from './vectors.js';

function showDivider(viewer, { light, against, split }, is_shown) {
  for (const id of ['divider', 'divider-line', 'left-side', 'right-side']) element(id).hidden = !is_shown;
  if (!is_shown) return;
  const { left, width } = pictureBox(viewer), { clientWidth } = viewer.canvas, at = left + split * width, names = lightsOf(viewer.scene);
  const thumb = 32;
  Object.assign(element('divider'), { value: split }).style.cssText = `left: ${left - thumb / 2}px; width: ${width + thumb}px`;
  element('divider-line').style.left = `${at}px`;
  Object.assign(element('left-side'), { textContent: names[light] }).style.right = `${clientWidth - at + 8}px`;
  Object.assign(element('right-side'), { textContent: names[against] }).style.left = `${at + 8}px`;
}

function showMark(viewer, vertex, is_shown) {
  element('mark').toggleAttribute('hidden', !is_shown);
  if (!is_shown) return;
  const { scene } = viewer, [circle, line] = element('mark').children, position = positionOf(scene, vertex);
  const lobe = [...scene.arrays.lobes.subarray(4 * vertex, 4 * vertex + 4)];
  const from = project(viewer, position), to = project(viewer, add(position, lobe, lobe[3]));
  for (const [shape, values] of [[circle, { cx: from.x, cy: from.y }], [line, { x1: from.x, y1: from.y, x2: to.x, y2: to.y }]])
    for (const [name, value] of Object.entries(values)) shape.setAttribute(name, value);
}

export class Overlays {
  /** @param {Viewer} viewer */
  constructor(viewer) { this.viewer = viewer; }

  show() {
    const { viewer, viewer: { state, isBare } } = this;
    showDivider(viewer, state, state.against !== 'none' && !isBare);
    this.showError(state.show === 'error' && !isBare);
    showMark(viewer, state.vertex, state.vertex >= 0 && !isBare);
  }

  // The text is made anew with the light, and not for every sample of a picture.
  showError(is_shown) {
    const { light, renderer: { vertices } } = this.viewer, shown = [vertices, vertices.lightsKey, light.sunLengths];
    element('error-side').hidden = !is_shown;
    if (!is_shown || shown.every((part, i) => part === this.errorOf?.[i])) return;
    this.errorOf = shown;
    element('error-side').textContent = light.errorText();
  }
}
