// The colours of the sculpt that a GLB was baked from, by the rules of io/gltf/asset/own_colors.cpp: factor and texture of materials, and
// the colours of vertices.

const WRAPS = { 10497: 'repeats', 33071: 'clamps', 33648: 'mirrors' };
const WHITE = [1, 1, 1];

const limited = x => (x > 0 ? Math.min(x, 1) : 0);
const linearOf = Float32Array.from({ length: 256 }, (_, i) => (i / 255 <= 0.04045 ? i / 255 / 12.92 : ((i / 255 + 0.055) / 1.055) ** 2.4));

// The pixels of an image as they are stored: a canvas for drawing would lose the colours of those that are transparent.
async function decodedImage(blob) {
  const bitmap = await createImageBitmap(blob, { colorSpaceConversion: 'none', premultiplyAlpha: 'none' }), { width, height } = bitmap;
  const gl = document.createElement('canvas').getContext('webgl2'), bytes = new Uint8Array(4 * width * height);
  if (Math.max(width, height) > gl.getParameter(gl.MAX_TEXTURE_SIZE)) throw new Error('it is larger than this graphics card can read');
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, gl.getParameter(gl.TEXTURE_BINDING_2D), 0);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  gl.getExtension('WEBGL_lose_context')?.loseContext();
  return { width, height, bytes };
}

async function imageAt({ json, buffer, binary }, index) {
  const { bufferView, uri, mimeType: type } = json.images[index];
  if (uri?.startsWith('data:')) return decodedImage(await (await fetch(uri)).blob());
  const { byteOffset = 0, byteLength, buffer: number } = json.bufferViews?.[bufferView] ?? {};
  if (number !== 0 || json.buffers[0].uri !== undefined) throw new Error('it is not in the file');
  return decodedImage(new Blob([new Uint8Array(buffer, binary + byteOffset, byteLength)], { type }));
}

// The texel beyond an image that is read in its place.
function wrapped(texel, size, wrap) {
  if (wrap === 'clamps') return Math.min(Math.max(texel, 0), size - 1);
  const period = wrap === 'mirrors' ? 2 * size : size, within = (texel % period + period) % period;
  return within < size ? within : 2 * size - 1 - within;
}

// Bilinear between linear colours.
function colorAt({ image: { width, height, bytes }, wraps, offset, scale, rotation }, u, v) {
  const c = Math.cos(rotation), s = Math.sin(rotation), [x, y] = [scale[0] * u, scale[1] * v];
  const across = (offset[0] + c * x + s * y) * width - 0.5, down = (offset[1] - s * x + c * y) * height - 0.5;
  const left = Math.floor(across), top = Math.floor(down), color = [0, 0, 0];
  if (!Number.isFinite(across + down)) return color;
  for (const [i, j] of [[0, 0], [1, 0], [0, 1], [1, 1]]) {
    const weight = (i ? across - left : 1 - across + left) * (j ? down - top : 1 - down + top);
    const at = 4 * (wrapped(top + j, height, wraps[1]) * width + wrapped(left + i, width, wraps[0]));
    for (let k = 0; k < 3; ++k) color[k] += weight * linearOf[bytes[at + k]];
  }
  return color;
}

// `images`: those of the file that were asked for.
async function readTexture(reader, images, { index, texCoord = 0, extensions }) {
  const { json } = reader, { source, sampler } = json.textures[index], transform = extensions?.KHR_texture_transform ?? {};
  const { offset = [0, 0], scale = [1, 1], rotation = 0, texCoord: set = texCoord } = transform;
  const { wrapS = 10497, wrapT = 10497 } = json.samplers?.[sampler] ?? {};
  return { image: await (images[source] ??= imageAt(reader, source)), set, offset, scale, rotation, wraps: [WRAPS[wrapS], WRAPS[wrapT]] };
}

// A grey without a texture, or with a white one, is that of a modelling program: nobody has set it.
async function readMaterial(reader, images, { pbrMetallicRoughness: pbr }, note) {
  const { baseColorFactor = WHITE, baseColorTexture } = pbr ?? {};
  const factor = baseColorFactor.slice(0, 3).map(limited), is_grey = factor[0] === factor[1] && factor[1] === factor[2];
  if (!baseColorTexture) return { factor: is_grey ? WHITE : factor };
  try {
    const texture = await readTexture(reader, images, baseColorTexture), { bytes } = texture.image;
    if (is_grey && bytes.every((byte, i) => byte === 255 || i % 4 === 3)) return { factor: WHITE };
    return { factor, texture };
  } catch (error) {
    note(`its texture cannot be read (${error.message}): white is shown in its place`);
    return { factor };
  }
}

/** The colours of all materials of a file. `note` takes what cannot be read. @param {import('./glb.js').GlbReader} reader */
export function ownMaterials(reader, note) {
  /** @type {Record<number, Promise<any>>} */
  const images = {};
  return Promise.all((reader.json.materials ?? []).map((material, i) =>
    readMaterial(reader, images, material, text => note(`material ${i}: ${text}`)).catch(error => {
      note(`material ${i} cannot be read (${error.message}): white is shown in its place`);
      return { factor: WHITE };
    })));
}

/** The colours of the vertices of a primitive: red, green and blue. @param {import('./glb.js').GlbReader} reader */
export function ownColors(reader, { attributes, material }, vertices, materials) {
  const { factor, texture } = materials[material] ?? { factor: WHITE }, colors = new Float32Array(3 * vertices);
  const own = attributes.COLOR_0 === undefined ? null : reader.read(attributes.COLOR_0, 'colours'), width = own && own.length / vertices;
  const uvs = texture && reader.read(attributes[`TEXCOORD_${texture.set}`], 'texture coordinates');
  for (let v = 0; v < vertices; ++v) {
    const painted = texture ? colorAt(texture, uvs[2 * v], uvs[2 * v + 1]) : WHITE;
    for (let k = 0; k < 3; ++k) colors[3 * v + k] = factor[k] * (own ? limited(own[width * v + k]) : 1) * painted[k];
  }
  return colors;
}
