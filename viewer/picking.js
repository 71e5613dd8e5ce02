// Vertices in the picture: where they are on the page, which one is at a place, and what is known of one.

import { insideByLobe } from './exact_light.js';
import { add, directionFromAngles, dot } from './vectors.js';
import { shapeOf } from './vertices.js';

/** Where the picture is on the page: a fixed size may have another shape than the window. @param {Viewer} viewer */
export function pictureBox({ drawing: { sheet, canvas } }) {
  const { clientWidth, clientHeight, width, height } = sheet?.tiles[0].canvas ?? canvas;
  const scale = Math.min(clientWidth / width, clientHeight / height);
  const [across, down] = [width * scale, height * scale];
  return { left: (clientWidth - across) / 2, top: (clientHeight - down) / 2, width: across, height: down };
}

/** The place of a point of the world on the page, and how far it is along the view. @param {Viewer} viewer */
export function project(viewer, position) {
  const { eye, right, up, forward, scale } = viewer.renderer.view, { left, top, width, height } = pictureBox(viewer);
  const offset = add(position, eye, -1), w = dot(offset, forward);
  return { x: left + (1 + dot(offset, right) * scale[0] / w) / 2 * width, y: top + (1 - dot(offset, up) * scale[1] / w) / 2 * height, w };
}

/** @param {Scene} scene */
export const positionOf = (scene, v) => [...scene.arrays.positions.subarray(3 * v, 3 * v + 3)];

/** Of the vertices that face the camera near a place of the page, the nearest to the camera. @param {Viewer} viewer */
export function vertexAt(viewer, x, y) {
  const { scene } = viewer, { normals } = scene.arrays, { eye } = viewer.renderer.view, near = 12;  // pixels
  let found = -1, nearest = Infinity;
  for (const { first_vertex: first, vertices } of scene.parts.filter(part => !part.level && !part.impostor))
    for (let v = first; v < first + vertices; ++v) {
      const position = positionOf(scene, v), at = project(viewer, position);
      if (!(at.w > 0 && at.w < nearest && Math.hypot(at.x - x, at.y - y) < near)) continue;
      if (dot(normals.subarray(3 * v, 3 * v + 3), add(position, eye, -1)) < 0) [found, nearest] = [v, at.w];
    }
  return found;
}

/** @param {Viewer} viewer */
export function vertexText({ scene, state, light }, v) {
  const { lobes } = scene.arrays, part = scene.parts.find(one => v < one.first_vertex + one.vertices);
  const to_sun = directionFromAngles(state.sun[0], state.sun[1]), numbers = values => values.map(x => x.toFixed(3)).join(', ');
  const transmittance = length => Math.exp(-part.extinction * state.density * length).toFixed(4);
  const lines = [
    `Vertex ${v} at ${numbers(positionOf(scene, v))}`, `o = ${numbers([...lobes.subarray(4 * v, 4 * v + 3)])}`,
    `d = ${lobes[4 * v + 3].toFixed(4)}`,
    `T to the sun: ${transmittance(insideByLobe(lobes, v, to_sun, shapeOf(scene, part, state)))} by the lobe`,
  ];
  try {
    lines[3] += `, ${transmittance(light.lengthFrom(part, v, to_sun))} exact`;
  } catch ({ message }) {
    lines.push(`No exact value: ${message}`);
  }
  return lines.join('\n');
}
