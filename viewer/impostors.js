// Lobe impostors (preview/mesh_clouds/impostor.h): atlases on the graphics card, and the passes that add them to the channels of clouds.

import { isDrawn } from './levels.js';
import { add, clamp, dot } from './vectors.js';
import { firstPart } from './vertices.js';

// By three columns.
const turned = (columns, v) => [0, 1, 2].map(r => columns[r] * v[0] + columns[3 + r] * v[1] + columns[6 + r] * v[2]);

// Three bytes per pixel, rows from the top, with mip levels.
function upload(gpu, name, side, bytes) {
  const { gl } = gpu, texture = gpu.newTexture(name, gl.TEXTURE_2D);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
  for (const edge of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, edge, gl.CLAMP_TO_EDGE);
  const rgba = new Uint8Array(4 * side * side).map((_, i) => i % 4 < 3 ? bytes[3 * (i >> 2) + i % 4] : 255);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, side, side, 0, gl.RGBA, gl.UNSIGNED_BYTE, rgba);
  gl.generateMipmap(gl.TEXTURE_2D);
  gpu.targets[name] = { name, texture, width: side, height: side };
}

/** The corners of the cube around the ball of an impostor, in the world. @param {PlacedImpostor} one */
const cornersOf = ({ center, own_radius, to_world }) => Array.from({ length: 8 }, (_, corner) =>
  add(center, turned(to_world, [0, 1, 2].map(axis => corner >> axis & 1 ? own_radius : -own_radius))));

/**
 * The pixels of a picture of a size that an impostor may cover: left, bottom, right and top, within those in which clouds are drawn.
 * @param {PlacedImpostor} one @param {View} view @param {number[]} within in pixels of the view's picture
 */
function pixelsOf(one, view, within, { width, height }) {
  const { eye, right, up, forward, scale, picture } = view, size = [width, height], box = [width, height, 0, 0];
  const limits = within.map((edge, i) => Math[i < 2 ? 'floor' : 'ceil'](edge * size[i % 2] / picture[i % 2]));
  for (const corner of cornersOf(one)) {
    const offset = add(corner, eye, -1), w = dot(offset, forward);
    if (!(w > 0)) return limits;
    [right, up].forEach((axis, i) => {
      const at = (dot(offset, axis) * scale[i] / w + 1) / 2 * size[i];
      box[i] = Math.min(box[i], Math.floor(at) - 1);
      box[2 + i] = Math.max(box[2 + i], Math.ceil(at) + 1);
    });
  }
  return box.map((edge, i) => clamp(edge, limits[i % 2], limits[2 + i % 2]));
}

export class Impostors {
  /** @param {Scene} scene */
  static areIn = ({ parts, scattered }) => [...parts, ...scattered?.parts ?? []].some(part => part.impostor);

  /** @param {Gpu} gpu @param {Scene} scene */
  constructor(gpu, scene) {
    this.gpu = gpu;
    this.scene = scene;
    for (const [where, arrays] of Object.entries({ placed: scene.arrays, scattered: scene.scattered?.arrays }))
      arrays?.impostors?.forEach(({ lobe, rest }, i) => {
        const side = Math.sqrt(lobe.length / 3);
        upload(gpu, `${where} impostor lobe ${i}`, side, lobe);
        upload(gpu, `${where} impostor rest ${i}`, side, rest);
      });
  }

  /** The placed ones that are drawn. @param {Renderer} renderer @returns {DrawnImpostor[]} */
  placed({ view, vertices }) {
    const { parts } = this.scene;
    return parts.filter((part, i) => part.impostor && isDrawn(parts, i, view))
      .map(part => ({ one: part.impostor, share: vertices.shareOf(part), pictures: 'placed' }));
  }

  // Those that are seen, the farthest one first; the eye is outside of their balls.
  seenBy(renderer) {
    const seen = [...this.placed(renderer), ...renderer.fields?.impostors ?? []].map(drawn => {
      const way = add(renderer.view.eye, drawn.one.center, -1), own = turned(drawn.one.to_own, way);
      return { ...drawn, own, away: Math.hypot(...way) };
    });
    return seen.filter(({ own }) => Math.hypot(...own) > 1).sort((a, b) => b.away - a.away);
  }

  // Adds them to channels of a size, each where it may be. `start(target)` makes the channels without them, in the target `name`.
  draw(renderer, name, size, shown, start) {
    const { gpu, scene } = this, { view, look, box: within } = renderer, all = gpu.target(name, size), added = gpu.target('added', size);
    const pixel = [gpu.size.width / size.width, gpu.size.height / size.height];
    start(all);
    const program = gpu.program('impostor.frag', ['lobe', 'impostor', 'impostor_uniforms', 'impostor_atlas', 'view']);
    for (const { one, own, away, share, pictures } of this.seenBy(renderer)) {
      const box = pixelsOf(one, view, within, size), exponent = one.exponent + view.k - firstPart(scene).shape[0];
      if (!(box[0] < box[2] && box[1] < box[3])) continue;
      gpu.fillPart(box, [added], program, {
        ...view, behind: name, impostor_eye: own, to_own: one.to_own, to_world: one.to_world, pixel, shown, share,
        impostor_lobe: `${pictures} impostor lobe ${one.picture}`, impostor_rest: `${pictures} impostor rest ${one.picture}`,
        impostor_atlas: one.atlas, impostor_exponent: exponent, extinction: one.extinction * view.density,
        gain: one.gains ? look.volume_gain : 1,
        impostor_texels: away * view.per_pixel * pixel[1] / (2 * one.radius) * one.atlas[1],
      });
      gpu.copyPart(box, added, all);
    }
  }
}
