// Compresses the meshes of a glTF with Draco, and writes beside it what Draco's own decoder makes of that.
//   node tests/gltf_transform/draco.mjs IN COMPRESSED.glb DECODED.glb
import { NodeIO } from "@gltf-transform/core";
import { ALL_EXTENSIONS, KHRDracoMeshCompression } from "@gltf-transform/extensions";
import draco from "draco3dgltf";

const [source, compressed, decoded] = process.argv.slice(2);
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({
  "draco3d.encoder": await draco.createEncoderModule(),
  "draco3d.decoder": await draco.createDecoderModule(),
});
const document = await io.read(source);
document.createExtension(KHRDracoMeshCompression).setRequired(true);
await io.write(compressed, document);

const again = await io.read(compressed);
const used = again.getRoot().listExtensionsUsed();
used.find((extension) => extension.extensionName === KHRDracoMeshCompression.EXTENSION_NAME).dispose();
await io.write(decoded, again);
