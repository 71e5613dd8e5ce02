"""Imports files into Blender, each into an empty scene, and lists what Blender finds in each.

  blender --background --factory-startup --python tests/blender/list_sculpts.py -- FILES.json LISTS.json

FILES.json: paths by name. LISTS.json: by name the objects with their materials, UV sets, colours and counts, all images, which material
shows which, and the box of the scene; or the error. What the file hides is left out."""

import json
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from in_blender import bpy, numpy, run

IMPORTERS = {
    ".gltf": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    ".glb": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    ".obj": lambda path: bpy.ops.wm.obj_import(filepath=path),
    ".fbx": lambda path: bpy.ops.import_scene.fbx(filepath=path),
    ".dae": lambda path: bpy.ops.wm.collada_import(filepath=path),
    ".ply": lambda path: bpy.ops.import_mesh.ply(filepath=path),
    ".stl": lambda path: bpy.ops.import_mesh.stl(filepath=path),
}


def plain(name):
    """A name without the number that Blender adds to a name that is taken."""
    return re.sub(r"\.\d\d\d$", "", name)


def shown():
    """The objects that have a mesh and are not hidden."""
    return [thing for thing in bpy.data.objects if thing.type == "MESH" and not thing.hide_viewport]


def shades(mesh):
    """Lowest and highest red, green, blue and alpha of the vertex colours, linear."""
    if not mesh.color_attributes:
        return []
    colours = [list(element.color) for element in mesh.color_attributes[0].data]
    return [[choose(channel) for channel in zip(*colours)] for choose in (min, max)]


def shape_counts(mesh):
    """Places and triangles: vertices at one place count once, triangles without three places or over the same three places too."""
    points = numpy.empty(3 * len(mesh.vertices), numpy.float32)
    mesh.vertices.foreach_get("co", points)
    _, place = numpy.unique(points.reshape(-1, 3) + numpy.float32(0), axis=0, return_inverse=True)
    mesh.calc_loop_triangles()
    corners = numpy.empty(3 * len(mesh.loop_triangles), numpy.int32)
    mesh.loop_triangles.foreach_get("vertices", corners)
    triangles = numpy.sort(place[corners].reshape(-1, 3), axis=1)
    triangles = numpy.unique(triangles[(triangles[:, 0] != triangles[:, 1]) & (triangles[:, 1] != triangles[:, 2])], axis=0)
    return len(numpy.unique(triangles)), len(triangles)


def material_names(thing):
    """Of the slots that a face uses."""
    used = {polygon.material_index for polygon in thing.data.polygons}
    return sorted(plain(slot.material.name) for i, slot in enumerate(thing.material_slots) if i in used and slot.material)


def textures():
    """Pairs of a material that an object uses and an image that it shows."""
    pairs = set()
    for thing in shown():
        for slot in (slot for slot in thing.material_slots if slot.material and slot.material.node_tree):
            nodes = slot.material.node_tree.nodes
            pairs |= {(plain(slot.material.name), plain(node.image.name)) for node in nodes if node.type == "TEX_IMAGE" and node.image}
    return sorted(pairs)


def box():
    """Low and high corner of all meshes in the scene, as Blender shows them."""
    corners = []
    graph = bpy.context.evaluated_depsgraph_get()
    for thing in (thing.evaluated_get(graph) for thing in shown()):
        mesh = thing.to_mesh()
        used = sorted({corner for polygon in mesh.polygons for corner in polygon.vertices})
        corners += [thing.matrix_world @ mesh.vertices[i].co for i in used]
        thing.to_mesh_clear()
    return [[choose(point[axis] for point in corners) for axis in range(3)] for choose in (min, max)] if corners else []


def describe():
    """The scene that was just imported."""
    meshes = []
    for thing in shown():
        places, triangles = shape_counts(thing.data)
        mesh = thing.data
        meshes.append({"name": plain(thing.name), "materials": material_names(thing), "uv_sets": len(mesh.uv_layers),
                       "colours": len(mesh.color_attributes), "shades": shades(mesh), "vertices": len(mesh.vertices), "places": places,
                       "triangles": triangles})
    others = sorted(plain(thing.name) for thing in bpy.data.objects if thing.type != "MESH")
    images = sorted(plain(image.name) for image in bpy.data.images if image.source != "VIEWER")
    return {"meshes": meshes, "others": others, "images": images, "textures": textures(), "box": box()}


def listed(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    try:
        IMPORTERS[pathlib.Path(path).suffix.lower()](path)
    except Exception as problem:  # an importer's, whatever it is
        return {"error": str(problem).strip().splitlines()[-1]}
    return describe() if any(thing.type == "MESH" for thing in bpy.data.objects) else {"error": "no mesh was imported"}


def main():
    source, target = sys.argv[sys.argv.index("--") + 1:]
    files = json.loads(pathlib.Path(source).read_text())
    pathlib.Path(target).write_text(json.dumps({name: listed(path) for name, path in files.items()}, indent=1, ensure_ascii=False))


if __name__ == "__main__":
    run(main)
