"""Renders sculpts with the colours of their textures, without light, as refined_picture.py does.

  blender --background --factory-startup --python tests/blender/textured_picture.py -- TEXTURE.png FILE ...

FILE.VIEW.png is written beside each file. Blender's reader of PLY takes the UVs of vertices, but no texture: a PLY gets this one."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from in_blender import bpy, run
from mathutils import Matrix
from refined_picture import draw


def read(path):
    """The scene of a file, in Blender's axes."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if path.suffix == ".glb":
        bpy.ops.import_scene.gltf(filepath=str(path))
    elif path.suffix == ".obj":
        bpy.ops.wm.obj_import(filepath=str(path))
    else:
        bpy.ops.import_mesh.ply(filepath=str(path))
        for thing in bpy.context.scene.objects:  # its reader does not turn what is Y up
            thing.matrix_world = Matrix(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1))) @ thing.matrix_world


def shine(thing, texture):
    """Each material of a mesh shines in the colours of its texture, or of this one if the mesh has no material."""
    if not thing.data.materials:
        material = bpy.data.materials.new("scan")
        material.use_nodes = True
        node = material.node_tree.nodes.new("ShaderNodeTexImage")
        node.image = bpy.data.images.load(str(texture))
        material.node_tree.links.new(node.outputs["Color"], material.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
        thing.data.materials.append(material)
    for material in thing.data.materials:
        nodes, links = material.node_tree.nodes, material.node_tree.links
        surface = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
        output = next(node for node in nodes if node.type == "OUTPUT_MATERIAL")
        emission = nodes.new("ShaderNodeEmission")
        links.new(surface.inputs["Base Color"].links[0].from_socket, emission.inputs["Color"])
        links.new(emission.outputs["Emission"], output.inputs["Surface"])


def main():
    texture, *paths = map(pathlib.Path, sys.argv[sys.argv.index("--") + 1:])
    for path in paths:
        read(path)
        for thing in bpy.context.scene.objects:
            if thing.type == "MESH":
                shine(thing, texture)
        draw(path.with_name(path.name + ".png"))


if __name__ == "__main__":
    run(main)
