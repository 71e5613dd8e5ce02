// Programs of the graphics card: shaders are compiled and linked, uniforms are set.

// What light.vert and cloud.vert read: a name of scene.arrays or of what is computed, the attribute's name and its size.
export const LIT_BY = [
  ['normals', 'normal', 3], ['lobes', 'lobe', 4], ['compared', 'compared', 4], ['lengths', 'lengths', 2], ['shares', 'sun_share', 1],
  ['seen', 'seen', 2], ['latticed', 'latticed', 2],
];
const LIT_NAMES = [...LIT_BY.map(([, name]) => name), ...[0, 1, 2, 3].map(i => `harmonics_${i}`)];
// What field.vert reads besides harmonics and own colours, in places that light.vert does not use. It has no array without a buffer, so
// that the shade is in one of them.
const FIELD_NAMES = ['mesh_position', 'mesh_normal', 'mesh_lobe', 'cloud_place', 'cloud_light'];
/** @type {Record<string, number>} */
export const LOCATIONS = {
  position: 0, light: 1, own: 2, cloud_shade: 0, ...Object.fromEntries(LIT_NAMES.map((name, index) => [name, index])),
  ...Object.fromEntries(FIELD_NAMES.map((name, index) => [name, LIT_NAMES.length + index])),
};

const HEAD = '#version 300 es\nprecision highp float;\nprecision highp int;\n';

// By the type of a uniform that is no texture: sets it at a location.
const SETTERS = {
  FLOAT: (gl, at, value) => gl.uniform1f(at, value),
  FLOAT_VEC2: (gl, at, value) => gl.uniform2fv(at, value.flat()),
  FLOAT_VEC3: (gl, at, value) => gl.uniform3fv(at, value),
  FLOAT_VEC4: (gl, at, value) => gl.uniform4fv(at, value.flat()),
  FLOAT_MAT3: (gl, at, value) => gl.uniformMatrix3fv(at, false, value),
  INT: (gl, at, value) => gl.uniform1i(at, value),
  BOOL: (gl, at, value) => gl.uniform1i(at, value),
  INT_VEC2: (gl, at, value) => gl.uniform2iv(at, value),
  INT_VEC4: (gl, at, value) => gl.uniform4iv(at, value),
  UNSIGNED_INT: (gl, at, value) => gl.uniform1ui(at, value),
};

function attachShader(gl, program, type, text, name) {
  const shader = gl.createShader(type);
  gl.shaderSource(shader, HEAD + text);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost())
    throw new Error(`This browser cannot compile a shader, ${name}: ${gl.getShaderInfoLog(shader)}`);
  gl.attachShader(program, shader);
}

// The uniforms of a program; those that are textures have their kind.
function uniformsOf(gl, program) {
  const kinds = { [gl.SAMPLER_2D]: gl.TEXTURE_2D, [gl.SAMPLER_2D_ARRAY]: gl.TEXTURE_2D_ARRAY, [gl.SAMPLER_3D]: gl.TEXTURE_3D };
  return Array.from({ length: gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS) }, (_, i) => {
    const { name, type } = gl.getActiveUniform(program, i), set = Object.entries(SETTERS).find(([key]) => gl[key] === type)?.[1];
    if (!set && !kinds[type]) throw new Error(`the uniform ${name} is of an unknown type`);
    return { path: name.replace('[0]', '').split('.'), location: gl.getUniformLocation(program, name), texture: kinds[type], set };
  });
}

// A program of the texts of its two shaders; `name` is for messages. `kept`: a result of the vertices that goes to a buffer.
export function linkedProgram(gl, { vertex, fragment, name, kept }) {
  const program = gl.createProgram();
  attachShader(gl, program, gl.VERTEX_SHADER, vertex, name);
  attachShader(gl, program, gl.FRAGMENT_SHADER, fragment, name);
  for (const [attribute, index] of Object.entries(LOCATIONS)) gl.bindAttribLocation(program, index, attribute);
  if (kept.length) gl.transformFeedbackVaryings(program, kept, gl.INTERLEAVED_ATTRIBS);
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost())
    throw new Error(`This browser cannot link a shader, ${name}: ${gl.getProgramInfoLog(program)}`);
  return { program, uniforms: uniformsOf(gl, program) };
}

// Sets the uniforms that the program has; textures are given as the names of targets.
export function useProgram(gl, { program, uniforms }, values, targets) {
  gl.useProgram(program);
  let unit = 0;
  for (const { path, location, texture, set } of uniforms) {
    const value = path.reduce((found, part) => found?.[part], values);  // settings are tables of tables
    if (value === undefined) throw new Error(`the uniform ${path.join('.')} has no value`);
    if (texture) {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(texture, targets[value].texture);
      gl.uniform1i(location, unit++);
    } else {
      set(gl, location, value);
    }
  }
}
