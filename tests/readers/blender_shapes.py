"""What Blender's importers find in files: the meshes before modifiers, where the scene has them.

  blender --background --factory-startup --python tests/readers/blender_shapes.py -- FILES.json FOLDER

FILES.json: paths by number. Writes NUMBER.shape or NUMBER.error into FOLDER."""

import json
import pathlib
import sys
from typing import Any

HERE = pathlib.Path(__file__).resolve().parent
sys.path += [str(HERE), str(HERE.parent / "blender")]
from in_blender import bpy, numpy, run
from list_sculpts import IMPORTERS
from shapes import Part, write_shape

IMPORTERS = {**IMPORTERS, ".x3d": lambda path: bpy.ops.import_scene.x3d(filepath=path)}


def column(collection, name, width, kind=numpy.float32):
    values = numpy.empty(len(collection) * width, kind)
    collection.foreach_get(name, values)
    return values.reshape(-1, width) if width > 1 else values


def colors_of(mesh, loops, vertices):
    """By corner of each triangle, linear, or nothing."""
    if not mesh.color_attributes:
        return None
    attribute = mesh.color_attributes[0]
    values = column(attribute.data, "color", 4)
    return values[loops] if attribute.domain == "CORNER" else values[vertices]


def parts_of(thing):
    mesh = thing.data
    mesh.calc_loop_triangles()
    triangles = mesh.loop_triangles
    loops, vertices = column(triangles, "loops", 3, numpy.int32), column(triangles, "vertices", 3, numpy.int32)
    if not len(triangles):
        return
    matrix = numpy.array(thing.matrix_world)
    points = column(mesh.vertices, "co", 3).astype(float) @ matrix[:3, :3].T + matrix[:3, 3]
    uvs = [column(layer.data, "uv", 2) for layer in mesh.uv_layers]
    colors = colors_of(mesh, loops, vertices)
    slots = column(triangles, "material_index", 1, numpy.int32)
    for slot in sorted(set(slots)):
        chosen = slots == slot
        rows: Any = lambda values: list(map(tuple, values.reshape(-1, values.shape[-1]).tolist()))
        material = thing.material_slots[slot].material if slot < len(thing.material_slots) else None
        yield Part(thing.name, material.name if material else None, rows(points[vertices[chosen]]), [rows(uv[loops[chosen]]) for uv in uvs],
                   rows(colors[chosen]) if colors is not None else [])


def main():
    source, target = sys.argv[sys.argv.index("--") + 1:]
    folder = pathlib.Path(target)
    for number, path in json.loads(pathlib.Path(source).read_text()).items():
        bpy.ops.wm.read_factory_settings(use_empty=True)
        try:
            IMPORTERS[pathlib.Path(path).suffix.lower()](path)
            bpy.context.view_layer.update()
            shown = [thing for thing in bpy.data.objects if thing.type == "MESH" and not thing.hide_viewport]
            write_shape(folder / f"{number}.shape", [part for thing in shown for part in parts_of(thing)])
        except Exception as problem:  # an importer's, whatever it is
            (folder / f"{number}.error").write_text(str(problem).strip().splitlines()[-1])


if __name__ == "__main__":
    run(main)
