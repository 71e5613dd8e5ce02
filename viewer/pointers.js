// The picture under mouse, fingers and keys.

import { pictureBox, vertexAt } from './picking.js';
import { add } from './vectors.js';

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** By pixels of the page: what is at the target's distance follows the pointer. @param {Viewer} viewer */
function pan(viewer, dx, dy) {
  const { right, up, per_pixel: perPixel, picture } = viewer.renderer.view;
  const scale = perPixel * picture[0] / pictureBox(viewer).width * viewer.camera().distance;
  viewer.change({ shift: add(add(viewer.state.shift, right, -dx * scale), up, dy * scale) });
}

/** A pointer that is down has moved. @param {Viewer} viewer @param {PointerEvent} event */
function drag(viewer, event, before) {
  const { pointers } = viewer, dx = event.clientX - before.clientX, dy = event.clientY - before.clientY;
  if (pointers.size === 2) {
    const other = [...pointers.values()].find(({ pointerId }) => pointerId !== event.pointerId);
    const spread = ({ clientX, clientY }) => Math.hypot(clientX - other.clientX, clientY - other.clientY);
    viewer.zoom(spread(event) / Math.max(1, spread(before)));
    pan(viewer, dx / 2, dy / 2);
  } else if (event.shiftKey) {
    viewer.moveSun(dx / 4, -dy / 4);
  } else if (event.buttons & 6 || event.ctrlKey) {
    pan(viewer, dx, dy);
  } else {
    viewer.turn(-dx / 3, dy / 3);
  }
}

/** @param {Viewer} viewer */
export function listenToPointers(viewer) {
  const { canvas, pointers } = viewer;
  let moved = 0;
  canvas.addEventListener('pointerdown', event => {
    canvas.setPointerCapture(event.pointerId);
    moved = pointers.size ? Infinity : 0;  // two fingers do not click
    pointers.set(event.pointerId, event);
  });
  for (const name of ['pointerup', 'pointercancel'])
    canvas.addEventListener(name, event => {
      const is_click = pointers.delete(event.pointerId) && moved < 4 && name === 'pointerup' && event.button === 0;
      if (is_click && !viewer.drawing.sheet) viewer.change({ vertex: vertexAt(viewer, event.clientX, event.clientY) });
      else viewer.request();
    });
  canvas.addEventListener('pointermove', event => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    moved += Math.abs(event.clientX - before.clientX) + Math.abs(event.clientY - before.clientY);
    drag(viewer, event, before);
    pointers.set(event.pointerId, event);
  });
  canvas.addEventListener('wheel', event => {
    event.preventDefault();
    viewer.zoom(Math.exp(-event.deltaY / 600));
  }, { passive: false });
  canvas.addEventListener('contextmenu', event => event.preventDefault());
  canvas.addEventListener('dblclick', () => viewer.reset());
}

/** @param {Viewer} viewer */
export function listenToKeys(viewer) {
  const zooms = { '+': 1.1, '=': 1.1, '-': 1 / 1.1 };
  viewer.canvas.addEventListener('keydown', event => {
    const { key, shiftKey, ctrlKey, altKey, metaKey } = event, arrow = ARROWS[key]?.map(x => 5 * x);
    if (ctrlKey || altKey || metaKey) return;  // the browser's own keys
    if (arrow && shiftKey) viewer.moveSun(arrow[0], arrow[1]);
    else if (arrow) viewer.turn(arrow[0], arrow[1]);
    else if (zooms[key]) viewer.zoom(zooms[key]);
    else if (key === 'Home') viewer.reset();
    else if (key === ' ' && viewer.clock.sequence) viewer.clock.play(!viewer.clock.plays);
    else return;
    event.preventDefault();
  });
}
