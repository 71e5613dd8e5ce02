// Lobe impostors (preview/mesh_clouds/impostor.h): atlases on the graphics card, and the passes that add them to the channels of clouds.

import { firstPart } from './vertices.js';
import { add } from './vectors.js';

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

export class Impostors {
  /** @param {Gpu} gpu @param {Scene} scene */
  constructor(gpu, scene) {
    this.gpu = gpu;
    this.scene = scene;
    scene.arrays.impostors.forEach(({ lobe, rest }, i) => {
      const side = Math.sqrt(lobe.length / 3);
      upload(gpu, `impostor lobe ${i}`, side, lobe);
      upload(gpu, `impostor rest ${i}`, side, rest);
    });
  }

  // Those that are seen, the farthest one first; the eye is outside of their balls.
  seenFrom(eye) {
    const seen = this.scene.impostors.map(one => {
      const way = add(eye, one.center, -1), own = turned(one.to_own, way);
      return { one, own, away: Math.hypot(...way) };
    });
    return seen.filter(({ own }) => Math.hypot(...own) > 1).sort((a, b) => b.away - a.away);
  }

  // Adds them to channels of a size. `start(target)` makes the channels without them; the result is in the target `name`.
  draw(renderer, name, size, shown, start) {
    const { gpu, scene } = this, { view, look } = renderer, seen = this.seenFrom(view.eye), other = `${name} behind`;
    const pixel = [gpu.size.width / size.width, gpu.size.height / size.height];
    let [to, from] = seen.length % 2 ? [other, name] : [name, other];
    start(gpu.target(to, size));
    for (const { one, own, away } of seen) {
      [to, from] = [from, to];
      const exponent = one.exponent + view.k - firstPart(scene).shape[0];
      renderer.fillBox([gpu.target(to, size)],
        gpu.program('impostor.frag', ['lobe', 'impostor', 'impostor_uniforms', 'impostor_atlas', 'view']), {
          ...view, behind: from, impostor_eye: own, to_own: one.to_own, to_world: one.to_world, pixel, shown,
          impostor_lobe: `impostor lobe ${one.picture}`, impostor_rest: `impostor rest ${one.picture}`,
          impostor_atlas: one.atlas, impostor_exponent: exponent, extinction: one.extinction * view.density,
          gain: one.gains ? look.volume_gain : 1,
          impostor_texels: away * view.per_pixel * pixel[1] / (2 * one.radius) * one.atlas[1],
        });
    }
  }
}
