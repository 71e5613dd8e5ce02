// Writes a glTF again without EXT_meshopt_compression, decoded by meshoptimizer's own module.
//   node tests/gltf_transform/plain.mjs IN OUT.glb
import { NodeIO } from "@gltf-transform/core";
import { ALL_EXTENSIONS, EXTMeshoptCompression } from "@gltf-transform/extensions";
import { MeshoptDecoder } from "meshoptimizer";

const [source, target] = process.argv.slice(2);
await MeshoptDecoder.ready;
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({ "meshopt.decoder": MeshoptDecoder });
const document = await io.read(source);
const used = document.getRoot().listExtensionsUsed();
used.find((extension) => extension.extensionName === EXTMeshoptCompression.EXTENSION_NAME).dispose();
await io.write(target, document);
