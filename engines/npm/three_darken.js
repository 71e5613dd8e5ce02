// Clouds darken built-in materials of three.js.

/**
 * A built-in material with lights gets the shade of clouds: its direct light is multiplied by the share of a place in the world.
 * @param {any} material @param {object} uniforms that `text` declares, without `${name}_place`
 * @param {{ name: string, text: string, share: string }} shade GLSL: a name for what is added, declarations, and the function of a vec3
 */
export function darkenLights(material, uniforms, { name, text, share }) {
  material.onBeforeCompile = shader => {
    Object.assign(shader.uniforms, uniforms);
    shader.vertexShader = shader.vertexShader.replace('#include <common>', `#include <common>\nvarying vec3 ${name}_place;`)
      .replace('#include <project_vertex>', `#include <project_vertex>
        mat4 ${name}_to_world = modelMatrix;
        #ifdef USE_INSTANCING
          ${name}_to_world *= instanceMatrix;
        #endif
        ${name}_place = (${name}_to_world * vec4(transformed, 1.0)).xyz;`);
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', `#include <common>\nvarying vec3 ${name}_place;\n${text}`)
      .replace('#include <lights_fragment_end>', `#include <lights_fragment_end>
        float ${name}_share = ${share}(${name}_place);
        reflectedLight.directDiffuse *= ${name}_share;
        reflectedLight.directSpecular *= ${name}_share;`);
  };
  material.customProgramCacheKey = () => `cloudbake ${name}`;
  material.needsUpdate = true;
  return material;
}
