"""Takes the artist's scene through set-up, bake, export and import in Blender, and lists what came back.

  blender --background --factory-startup --python tests/blender/round_trip_scene.py -- ADDONS PROGRAM FOLDER

FOLDER/lines.json: rows of [equal, text]. FOLDER/files.json: the exported files. FOLDER/*.png: pictures of the steps."""

import json
import pathlib
import sys

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parent)]
from in_blender import bpy, run
from artists_scene import CLOUDS, add_light_and_camera, build, facts_of, render, same, scene_facts

SIZE = 192, 128


def start(addons, program):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if addons not in sys.path:
        sys.path.insert(0, addons)
    bpy.ops.preferences.addon_enable(module="cloudbake_addon")
    bpy.context.preferences.addons["cloudbake_addon"].preferences.program = program


def shown(value):
    text = " ".join(str(value).split()) if not hasattr(value, "shape") else f"{value.shape[0]} rows"
    if isinstance(value, dict) and any(hasattr(inner, "shape") for inner in value.values()):
        text = ", ".join(f"{name}: {len(inner)} corners" for name, inner in value.items())
    return text if len(text) < 150 else text[:147] + "…"


def compare(lines, step, before, after, leave_out=()):
    """A line for each fact of each object."""
    for name, facts in before.items():
        for key, wanted in facts.items():
            if key in leave_out:
                continue
            found = after.get(name, {}).get(key)
            equal = found is not None and same(wanted, found) or wanted is None and found is None
            lines.append((bool(equal), f"{step}: {name}: {key}: {shown(wanted)}" + ("" if equal else f" became {shown(found)}")))


def all_facts(names):
    """By the names that the artist gave; `names` are those of the objects that have the lobes."""
    return {**{name: facts_of(bpy.data.objects[own]) for name, own in names.items()}, "scene": scene_facts()}


def nodes_of(material):
    return sorted((node.name, node.bl_idname) for node in material.node_tree.nodes), len(material.node_tree.links)


def main():
    addons, program, name_of_folder = sys.argv[sys.argv.index("--") + 1:][:3]
    folder = pathlib.Path(name_of_folder)
    lines: list[tuple[bool, str]] = []
    start(addons, program)
    sky = build()
    add_light_and_camera()
    own = bpy.context.scene.cloudbake
    own.scope, own.collection, own.voxels, own.rays, own.make_material = "COLLECTION", sky, 100, 200, False
    before = all_facts({name: name for name in CLOUDS})
    trees = {material.name: nodes_of(material) for material in bpy.data.materials}
    render(folder / "before.png", SIZE)

    # Each alone, for the exact chords of each mesh.
    own.each, own.lobe = True, "mean"
    assert bpy.ops.cloudbake.bake() == {"FINISHED"}
    (folder / "each").mkdir()
    assert bpy.ops.cloudbake.export_each(directory=str(folder / "each")) == {"FINISHED"}

    # All together, set up, and what that left of the artist's.
    own.each, own.voxels = False, 200
    for name in ("divided",):
        bpy.data.objects[name].hide_set(False)
    assert bpy.ops.cloudbake.bake() == {"FINISHED"}
    assert bpy.ops.cloudbake.material() == {"FINISHED"}
    has_lobes = {name: "divided baked" if name == "divided" else name for name in CLOUDS}
    # Objects that shared a mesh have their own, because their lobes differ; the copy with the modifiers applied has one too.
    compare(lines, "set up", before, all_facts(has_lobes), ("name of the mesh",))
    assert bpy.ops.cloudbake.follow_sun() == {"FINISHED"}
    render(folder / "set_up.png", SIZE)
    assert bpy.ops.cloudbake.export_asset(filepath=str(folder / "together.glb")) == {"FINISHED"}
    wanted = all_facts(has_lobes)  # names of the meshes of their own
    wanted["divided"]["name of the mesh"] = before["divided"]["name of the mesh"]
    for name in CLOUDS:
        wanted[name] = {**before[name], "name of the mesh": wanted[name]["name of the mesh"]}

    # The operator takes all added nodes away again.
    assert bpy.ops.cloudbake.remove_material() == {"FINISHED"}
    for material in bpy.data.materials:
        lines.append((nodes_of(material) == trees.get(material.name), f"removed: {material.name}: its nodes and links are the artist's"))

    # Back into an empty file.
    start(addons, program)
    sun = add_light_and_camera()
    bpy.context.scene.cloudbake.sun = sun
    assert bpy.ops.cloudbake.import_asset(filepath=str(folder / "together.glb")) == {"FINISHED"}
    compare(lines, "imported", wanted, all_facts({name: name for name in CLOUDS}))
    render(folder / "imported.png", SIZE)
    own = bpy.context.scene.cloudbake
    own.scope, own.collection = "COLLECTION", bpy.data.collections["Sky"]
    assert bpy.ops.cloudbake.export_asset(filepath=str(folder / "again.glb")) == {"FINISHED"}
    assert bpy.ops.cloudbake.remove_material() == {"FINISHED"}
    render(folder / "removed.png", SIZE)

    # Other importers see no trace.
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(folder / "together.glb"))
    traces = [f"{block.name}: {key}" for blocks in (bpy.data.objects, bpy.data.meshes, bpy.data.materials, bpy.data.scenes)
              for block in blocks for key in block.keys() if key.startswith("cloudbake")]
    lines.append((not traces, f"imported by Blender's own importer: no property of the add-on{': ' + ', '.join(traces) if traces else ''}"))
    files = [*sorted((folder / "each").glob("*.glb")), folder / "together.glb", folder / "again.glb"]
    (folder / "files.json").write_text(json.dumps([str(path) for path in files]))
    (folder / "lines.json").write_text(json.dumps(lines))


run(main)
