// Files and options that the program refuses, and the module with the same words.
import { glbOf } from '../browser/glb.mjs';
import {
  SHAPES, bytesOfFloats, bytesOfIndices, gltfFiles, gltfParts, moved, objText, offText, plyBinary, plyText, stlBinary, stlText,
} from './shapes.mjs';

const { tetrahedron } = SHAPES, text = objText(tetrahedron), off = offText(tetrahedron), ply = plyText(tetrahedron);
const stl = stlText(tetrahedron);
const parts = () => structuredClone(gltfParts([[tetrahedron, {}]]).json), { binary } = gltfParts([[tetrahedron, {}]]);
// A GLB of the tetrahedron whose document and data `change` may edit.
function glb(change = () => {}) {
  const json = parts(), data = Buffer.from(binary);
  change(json, data);
  return glbOf({ json, binary: data });
}
const edited = (bytes, change) => {
  const copy = Buffer.from(bytes);
  change(copy);
  return copy;
};
const gltf = change => {
  const files = gltfFiles('beside', { json: parts(), binary }), json = JSON.parse(files['beside.gltf']);
  change(json);
  return JSON.stringify(json);
};
const bin = { 'beside.bin': binary };
const sheet = { positions: [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], triangles: [[0, 1, 2], [0, 2, 3]] };

// [name, bytes or text, files beside it]
export const BAD_FILES = [
  ['empty.obj', ''],
  ['zero_bytes.obj', `${text}\0\0`],
  ['nan.obj', text.replace('v 1 0 0', 'v 1 nan 0')],
  ['infinite.obj', text.replace('v 1 0 0', 'v 1 inf 0')],
  ['too_large.obj', text.replace('v 1 0 0', 'v 1e39 0 0')],
  ['word.obj', text.replace('v 1 0 0', 'v 1 wide 0')],
  ['two_coordinates.obj', text.replace('v 1 0 0', 'v 1 0')],
  ['short_normal.obj', `vn 1 0\n${text}`],
  ['vertex_out_of_range.obj', text.replace('f 1', 'f 9')],
  ['vertex_before_the_first.obj', text.replace('f 1', 'f -9')],
  ['vertex_0.obj', text.replace('f 1', 'f 0')],
  ['uv_out_of_range.obj', text.replace('f 1', 'f 1/3')],
  ['normal_out_of_range.obj', text.replace('f 1', 'f 1//2')],
  ['four_indices.obj', text.replace('f 1', 'f 1/1/1/1')],
  ['no_faces.obj', text.replace(/^f.*\n/gm, '')],
  ['points_only.obj', 'v 0 0 0\nv 1 0 0\np 1 2\nl 1 2\n'],
  ['not_text.obj', Buffer.from(Array.from({ length: 300 }, (_, i) => 255 - i % 200))],
  ['nul.off', `OFF\n4 4 0\n0 0 0\n1 \0 0\n`],
  ['control.obj', text.replace('v 1 0 0', 'v 1 \x07\x1b[31mred 0')],
  ['not_utf8.obj', Buffer.concat([Buffer.from('v 0 0 '), Buffer.from([0xFF, 0xFE]), Buffer.from('\n')])],
  ['empty.stl', ''],
  ['short.stl', 'facets'],
  ['truncated.stl', stlBinary(tetrahedron).subarray(0, 250)],
  ['claims.stl', edited(stlBinary(tetrahedron), bytes => bytes.writeUInt32LE(4e9, 80))],
  ['nan.stl', edited(stlBinary(tetrahedron), bytes => bytes.writeFloatLE(NaN, 84 + 50 + 12 + 4))],
  ['no_facets.stl', Buffer.alloc(84)],
  ['nan_text.stl', stl.replace('vertex 1 0 0', 'vertex 1 nan 0')],
  ['no_end.stl', stl.replace('endsolid made', '')],
  ['two_corners.stl', stl.replace('vertex 1 0 0\n', '')],
  ['nothing.stl', 'solid nothing\nendsolid nothing\n'],
  ['empty.ply', ''],
  ['magic.ply', ply.replace('ply', 'pol')],
  ['endless_header.ply', ply.slice(0, 60)],
  ['type.ply', ply.replace('property float y', 'property complex y')],
  ['list_type.ply', ply.replace('list uchar int', 'list float int').replace('list float', 'list double')],
  ['rows.ply', ply.replace('element vertex 4', 'element vertex four')],
  ['property_first.ply', ply.replace('element vertex 4\n', '')],
  ['no_x.ply', ply.replace('property float x', 'property float w')],
  ['no_list.ply', ply.replace('vertex_indices', 'corners')],
  ['truncated.ply', ply.slice(0, -12)],
  ['truncated_binary.ply', plyBinary(tetrahedron).subarray(0, -9)],
  ['word.ply', ply.replace('1 0 0', '1 wide 0')],
  ['nan.ply', edited(plyBinary(tetrahedron), bytes => bytes.writeFloatLE(NaN, bytes.indexOf('end_header\n') + 11 + 16))],
  ['infinite.ply', edited(plyBinary(tetrahedron, false), bytes => bytes.writeFloatBE(Infinity, bytes.indexOf('end_header\n') + 11 + 16))],
  ['few_values.ply', ply.replace('1 0 0', '1 0')],
  ['out_of_range.ply', ply.replace('3 0 2 1', '3 0 2 7')],
  ['negative.ply', ply.replace('3 0 2 1', '3 0 2 -1')],
  ['no_faces.ply', ply.replace('element face 4', 'element face 0').replace(/3 \d \d \d\n/g, '')],
  ['no_columns.ply', 'ply\nformat ascii 1.0\nelement vertex 1\nend_header\n0\n'],
  ['empty.off', ''],
  ['magic.off', off.replace('OFF', 'OGG')],
  ['four_dimensions.off', off.replace('OFF', '4OFF')],
  ['binary.off', off.replace('OFF', 'OFF BINARY')],
  ['counts.off', off.replace('4 4 0', 'four 4 0')],
  ['one_count.off', off.replace('4 4 0', '4')],
  ['claims.off', off.replace('4 4 0', '400000 4 0')],
  ['nan.off', off.replace('\n1 0 0\n', '\n1 nan 0\n')],
  ['truncated.off', off.slice(0, -10)],
  ['out_of_range.off', off.replace('3 0 2 1', '3 0 2 4')],
  ['corners.off', off.replace('3 0 2 1', '99999 0 2 1')],
  ['no_faces.off', 'OFF\n1 0 0\n0 0 0\n'],
  ['empty.glb', ''],
  ['magic.glb', edited(glb(), bytes => bytes.write('GLTF'))],
  ['short.glb', glb().subarray(0, 15)],
  ['version_1.glb', edited(glb(), bytes => bytes.writeUInt32LE(1, 4))],
  ['truncated.glb', glb().subarray(0, -20)],
  ['chunk.glb', edited(glb(), bytes => bytes.writeUInt32LE(1e6, 12))],
  ['binary_first.glb', edited(glb(), bytes => bytes.writeUInt32LE(0x004E4942, 16))],
  ['json.glb', edited(glb(), bytes => bytes.write('oops', 20))],
  ['bytes_in_json.glb', edited(glb(), bytes => bytes.fill(0xFE, 30, 34))],
  ['accessor.glb', glb(json => { json.meshes[0].primitives[0].attributes.POSITION = 17; })],
  ['accessor_type.glb', glb(json => { json.accessors[0].type = 'VEC2'; })],
  ['component_type.glb', glb(json => { json.accessors[0].componentType = 99; })],
  ['count.glb', glb(json => { json.accessors[0].count = 400; })],
  ['view.glb', glb(json => { json.bufferViews[0].byteLength = 1e6; })],
  ['no_view.glb', glb(json => { json.accessors[0].bufferView = 9; })],
  ['stride.glb', glb(json => { json.bufferViews[0].byteStride = 4; })],
  ['buffer.glb', glb(json => { json.buffers[0].byteLength = 1e6; })],
  ['indices.glb', glb((json, data) => bytesOfIndices([77]).copy(data, 48))],
  ['index_type.glb', glb(json => { json.accessors[1].componentType = 5126; })],
  ['index_count.glb', glb(json => { json.accessors[1].count = 11; })],
  ['nan.glb', glb((json, data) => bytesOfFloats([NaN]).copy(data, 16))],
  ['mode.glb', glb(json => { json.meshes[0].primitives[0].mode = 9; })],
  ['points.glb', glb(json => { json.meshes[0].primitives[0].mode = 0; })],
  ['mesh.glb', glb(json => { json.nodes[0].mesh = 3; })],
  ['no_meshes.glb', glb(json => { delete json.nodes[0].mesh; })],
  ['no_scene.glb', glb(json => { json.scene = 4; })],
  ['node.glb', glb(json => { json.scenes[0].nodes = [5]; })],
  ['cycle.glb', glb(json => { json.nodes[0].children = [0]; })],
  ['flat_scale.glb', glb(json => { json.nodes[0].scale = [1, 0, 1]; })],
  ['far.glb', glb(json => { json.nodes[0].scale = [1e39, 1e39, 1e39]; })],
  ['extension.glb', glb(json => { json.extensionsRequired = json.extensionsUsed = ['EXT_clouds']; })],
  ['wrong_type.glb', glb(json => { json.meshes = { a: 1 }; })],
  ['attributes.glb', glb(json => { json.meshes[0].primitives[0].attributes = { POSITION: 'no' }; })],
  ['empty.gltf', ''],
  ['words.gltf', 'not JSON'],
  ['list.gltf', '[1, 2]'],
  ['version.gltf', gltf(json => { json.asset.version = '1.0'; }), bin],
  ['no_version.gltf', gltf(json => { delete json.asset; }), bin],
  ['nested.gltf', `${'{"a":'.repeat(300)}1${'}'.repeat(300)}`],
  ['truncated.gltf', gltf(() => {}).slice(0, -30), bin],
  ['missing_buffer.gltf', gltf(() => {})],
  ['missing_of_two.gltf', gltf(json => { json.buffers.push({ byteLength: 10, uri: 'no%20where.bin' }); }), bin],
  ['short_buffer.gltf', gltf(() => {}), { 'beside.bin': binary.subarray(0, 40) }],
  ['outside.gltf', gltf(json => { json.buffers[0].uri = '../beside.bin'; }), bin],
  ['absolute.gltf', gltf(json => { json.buffers[0].uri = '/etc/hostname'; }), bin],
  ['data_uri.gltf', gltf(json => { json.buffers[0].uri = 'data:application/octet-stream;base64,AAAA'; })],
  ['scheme.gltf', gltf(json => { json.buffers[0].uri = 'https://example.org/a.bin'; })],
  ['no_buffers.gltf', gltf(json => { delete json.buffers; })],
  ['scene.usd', '#usda 1.0'],
  ['scene.usdz', 'PK'],
  ['cache.abc', 'Ogawa'],
  ['scene.max', 'x'],
  ['scene.ma', 'x'],
  ['tool.ztl', 'x'],
  ['point.obj', objText(moved(tetrahedron, () => [1, 2, 3]))],
  ['wide_range.obj', objText(moved(tetrahedron, p => p.map(x => (x - 0.5) * 6e38)))],
];

// What the module refuses in words of its own, because the program may be able to read or close it.
export const UNKNOWN_FILES = [['sheet.obj', objText(sheet)], ['letter.docx', 'text'], ['noextension', text],
  ['points.xyz', '0 0 0\n1 0 0\n']];

// Options that a bake refuses; of the tetrahedron as .obj, or as .glb.
export const WRONG_OPTIONS = [
  { rays: 7 }, { rays: 0 }, { rays: -4 }, { rays: 2 ** 21 }, { rays: 'many' }, { rays: 2.5 }, { rays: '10 ' }, { rays: '1e2' },
  { voxels: 0 }, { voxels: 'x' }, { 'voxel-size': 0 }, { 'voxel-size': 'nan' }, { 'bake-voxels': 0 }, { 'ray-length': -1 },
  { lobe: 'median' }, { lobe: 'Fit' }, { basis: 'sh4' }, { basis: 'sh3', rays: 20 }, { field: 'grid' }, { method: 'fast' },
  { sampler: 'halton' }, { sampler: 'uniform' }, { quadrature: 'end' }, { steps: 10 }, { 'fixed-directions': true },
  { 'fit-to': 'volume', lobe: 'mean' }, { 'fit-to': 'light' }, { phase: 2, lobe: 'fit', 'fit-to': 'volume' }, { phase: 0.5, lobe: 'mean' },
  { octaves: '4,2,2', lobe: 'fit', 'fit-to': 'volume' }, { 'view-extinction': 2, lobe: 'mean' },
  { exponent: 'fit', lobe: 'mean' }, { exponent: -1 },
  { bias: 'fit', lobe: 'mean' }, { bias: '2000%' }, { extinction: '2:1' }, { extinction: '1:2', lobe: 'mean' }, { extinction: 0 },
  { 'sun-arc': '0:90' },
  { 'sun-arc': '0:90,0:360', lobe: 'mean' }, { 'sun-arc': '0:95,0:360', lobe: 'fit' }, { smooth: -1 }, { smooth: 1001 }, { seed: -1 },
  { vertices: 3 }, { vertices: 10, remesh: '5%' }, { remesh: 0 }, { repair: 'glue' }, { close: 'maybe' }, { 'target-error': 500 },
  { 'target-error': 1, rays: 50 }, { 'target-error': 1, smooth: 1 }, { 'uv-set': 7 }, { 'uv-set': -1 }, { 'keep-alive-texture': 'on' },
  { units: 0 }, { units: 'feet' }, { up: 'w' }, { grid: 'density' }, { iso: 0.5 }, { 'scene-index': 0 }, { 'scene-index': -1 },
  { 'lattice-cells': 1 },
];
export const WRONG_FOR_GLB = [{ units: 1 }, { up: 'z' }, { 'scene-index': 3 }];
