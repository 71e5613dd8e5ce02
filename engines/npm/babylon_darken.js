// Clouds darken the lit materials of Babylon.js.
import { MaterialPluginBase } from '@babylonjs/core/Materials/materialPluginBase.js';

// Babylon.js takes a semicolon of a comment for the end of a line.
export const withoutComments = shader => shader.replace(/ *\/\/.*$/gm, '');

/**
 * A StandardMaterial or a PBRMaterial gets the shade of clouds: its direct light is multiplied by the share of a place in the world.
 * Its shade has a name, GLSL for the share and its declarations, the names of its uniforms and of its texture, and what sets them.
 * @param {any} material
 * @param {{ name: string, text: string, share: string, uniforms: string[], texture: string, bind: (effect: any, scene: any) => void }} _
 */
export function darkenLights(material, { name, text, share, uniforms, texture, bind }) {
  const define = name.toUpperCase();
  const code = {
    CUSTOM_FRAGMENT_DEFINITIONS: withoutComments(`#ifdef ${define}\n${text}\n#endif`),
    '!aggShadow\\s*=\\s*aggShadow\\s*/\\s*numLights;': `aggShadow = aggShadow / numLights;
      #ifdef ${define}
        float ${name}_share = ${share};
        diffuseBase *= ${name}_share;
        #ifdef SPECULARTERM
          specularBase *= ${name}_share;
        #endif
      #endif`,
  };

  // Babylon.js asks for the code while it constructs the base.
  class DarkenPlugin extends MaterialPluginBase {
    constructor() {
      super(material, name, 200, { [define]: false });
      this._enable(true);
    }

    getClassName() { return 'DarkenPlugin'; }
    prepareDefines(defines) { defines[define] = true; }
    getSamplers(samplers) { samplers.push(texture); }
    getUniforms() { return { ubo: [], externalUniforms: uniforms }; }
    bindForSubMesh(_buffer, scene, _engine, subMesh) { bind(subMesh.effect, scene); }
    getCustomCode(type) { return type === 'fragment' ? code : null; }
  }
  new DarkenPlugin();
  return material;
}
