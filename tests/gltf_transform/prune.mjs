// Prunes a GLB as `gltf-transform prune` does, with its defaults: what nothing refers to is removed, UV sets that no texture uses among it.
//   node tests/gltf_transform/prune.mjs IN.glb OUT.glb
import { NodeIO } from "@gltf-transform/core";
import { ALL_EXTENSIONS } from "@gltf-transform/extensions";
import { prune } from "@gltf-transform/functions";

const [source, target] = process.argv.slice(2);
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);
const document = await io.read(source);
await document.transform(prune());
await io.write(target, document);
