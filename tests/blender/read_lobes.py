"""Imports baked assets into Blender and reads the lobes from their UV maps, as the table of docs/asset_format.md says for Blender.

  blender --background --factory-startup --python tests/blender/read_lobes.py -- FILES.json FOLDER

FILES.json: paths by name. FOLDER/NAME.npz gets the points of all corners and their vectors o·d, both in scene space with glTF's axes."""

import json
import pathlib
import sys

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parent), str(pathlib.Path(__file__).resolve().parents[1] / "cli")]
from glb import read_glb
from in_blender import bpy, numpy, run


def uv_set_numbers(path):
    """Which two UV maps hold the lobes: the asset says so, and Blender keeps the order."""
    return read_glb(pathlib.Path(path))[0]["asset"]["extras"]["cloudbake"]["uv_sets"]


def values(elements, attribute, width):
    flat = numpy.empty(len(elements) * width, numpy.float32)
    elements.foreach_get(attribute, flat)
    return flat.reshape(-1, width).astype(float)


def corners(thing, first, second):
    """Points and vectors o·d of an object's corners in Blender's scene."""
    mesh, matrix = thing.data, numpy.array(thing.matrix_world, dtype=float)
    vertex = numpy.empty(len(mesh.loops), numpy.int32)
    mesh.loops.foreach_get("vertex_index", vertex)
    points = values(mesh.vertices, "co", 3)[vertex] @ matrix[:3, :3].T + matrix[:3, 3]

    (a, b), (c, e) = (values(mesh.uv_layers[n].data, "uv", 2).T for n in (first, second))
    o, d = (a, 1 - b, c), 1 - e
    turned = numpy.column_stack([o[0], -o[2], o[1]])
    return points, (turned * d[:, None]) @ matrix[:3, :3].T


def main():
    source, folder = sys.argv[sys.argv.index("--") + 1:]
    for name, path in json.loads(pathlib.Path(source).read_text()).items():
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.ops.import_scene.gltf(filepath=path)
        bpy.context.view_layer.update()
        found = [corners(thing, *uv_set_numbers(path)) for thing in bpy.data.objects if thing.type == "MESH"]
        points, lobes = (numpy.concatenate(column)[:, [0, 2, 1]] * (1, 1, -1) for column in zip(*found))
        numpy.savez(pathlib.Path(folder) / f"{name}.npz", points=points, lobes=lobes)


if __name__ == "__main__":
    run(main)
