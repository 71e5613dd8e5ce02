"""Uses the add-on in scenes of many kinds. Each scenario checks what Blender shows afterwards, and names triangles for the program to bake:
the lobes in the UV maps must be those of the command on the same triangles.

  blender --background --factory-startup --python tests/blender/addon_scenes.py -- ADDONS PROGRAM FOLDER [NAME ...]

FOLDER/NAME.N.off has the triangles of a cloud in scene space with glTF's axes, FOLDER/NAME.N.npz the lobes that Blender holds there.
FOLDER/scenes.json lists by scenario its error, if any, and its clouds and files. With a window, the scenarios run that need one."""

import contextlib
import json
import math
import os
import pathlib
import random
import subprocess
import sys
import time
import traceback
import types
from typing import Any

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parent), str(pathlib.Path(__file__).resolve().parents[1] / "cli")]
from in_blender import bpy, numpy
import bmesh
from events import HANGS
from glb import read_glb
from make_rigs import activate, empty, link
from mathutils import Vector

ADDONS, PROGRAM, _FOLDER = sys.argv[sys.argv.index("--") + 1:][:3]
FOLDER = pathlib.Path(_FOLDER)
MAPS = ["Cloudbake 1", "Cloudbake 2"]
TO_GLTF = numpy.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], float)
SCENES, WINDOWED = {}, {}


def scenario(function):
    SCENES[function.__name__] = function
    return function


def windowed(function):
    WINDOWED[function.__name__] = function
    return function


# ---- what scenarios share ---------------------------------------------------------------------------------------------------------------


class Found:
    """The clouds and files of a scenario, for the program."""

    def __init__(self, name):
        self.name, self.clouds, self.files = name, [], []

    def cloud(self, things, options=(), base=False, constants=True):
        """Compares the objects, which were baked together, with the command."""
        stem = FOLDER / f"{self.name}.{len(self.clouds)}"
        parts = [(world_triangles(thing, base), world_lobes(thing)) for thing in things]
        starts = numpy.cumsum([0] + [len(points) for (points, _), _ in parts])
        triangles = numpy.concatenate([triangles + start for ((_, triangles), _), start in zip(parts, starts)])
        write_off(stem.with_suffix(f"{stem.suffix}.off"), numpy.concatenate([points for (points, _), _ in parts]), triangles)
        numpy.savez(stem.with_suffix(f"{stem.suffix}.npz"), lobes=numpy.concatenate([lobes for _, lobes in parts]))
        asset = json.loads(things[0].data["cloudbake"])["asset"] if constants else None
        self.clouds.append({"stem": stem.name, "options": list(options), "asset": asset})

    def file(self, path, things, sound=True):
        """An exported file, which `cloudbake check` must find sound, and the objects whose lobes it must have."""
        stem = f"{self.name}.file{len(self.files)}"
        numpy.savez(FOLDER / f"{stem}.npz", points=numpy.concatenate([world_triangles(thing)[0] for thing in things]),
                    lobes=numpy.concatenate([world_lobes(thing) for thing in things]))
        self.files.append({"path": str(path), "stem": stem, "sound": sound})


def lump_mesh(name, seed, subdivisions):
    """A closed ball with smooth bumps that the seed chooses, without UV maps."""
    mesh, ball = bpy.data.meshes.new(name), bmesh.new()
    bmesh.ops.create_icosphere(ball, subdivisions=subdivisions, radius=1)
    draw = random.Random(seed)
    waves = [(Vector([draw.uniform(-3, 3) for _ in range(3)]), draw.uniform(0, 6), draw.uniform(0.05, 0.15)) for _ in range(4)]
    for vertex in ball.verts:
        vertex.co *= 1 + sum(high * math.sin(vertex.co.dot(wave) + phase) for wave, phase, high in waves)
    ball.to_mesh(mesh)
    ball.free()
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    return mesh


def lump(name, seed, subdivisions, **where):
    return link(name, lump_mesh(name, seed, subdivisions), **where)


def values(elements, name, width, kind=numpy.float32):
    flat = numpy.empty(len(elements) * width, kind)
    elements.foreach_get(name, flat)
    return flat.reshape(-1, width)


def world_triangles(thing, base=False):
    """Points in scene space with glTF's axes, and triangles, facing outwards."""
    matrix = numpy.array(thing.matrix_world, float)
    evaluated = thing if base else thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = thing.data if base else evaluated.to_mesh()
    mesh.calc_loop_triangles()
    points = values(mesh.vertices, "co", 3).astype(float) @ matrix[:3, :3].T + matrix[:3, 3]
    triangles = values(mesh.loop_triangles, "vertices", 3, numpy.int32)
    return points @ TO_GLTF.T, triangles if numpy.linalg.det(matrix[:3, :3]) > 0 else triangles[:, [0, 2, 1]]


def world_lobes(thing):
    """The vectors o·d of the vertices in scene space with glTF's axes, as docs/asset_format.md says for Blender."""
    mesh, linear = thing.data, numpy.array(thing.matrix_world, float)[:3, :3]
    vertex = values(mesh.loops, "vertex_index", 1, numpy.int32)[:, 0]
    (a, b), (c, e) = (values(mesh.uv_layers[name].data, "uv", 2).astype(float).T for name in MAPS)
    corners = numpy.column_stack([a, -c, 1 - b]) * (1 - e)[:, None]
    lobes = numpy.zeros((len(mesh.vertices), 3))
    lobes[vertex] = corners
    assert numpy.array_equal(lobes[vertex], corners), "corners of a vertex differ"
    assert abs(numpy.linalg.norm(numpy.column_stack([a, c, 1 - b]), axis=1) - 1).max() < 1e-5, "o is not a unit vector"
    return lobes @ linear.T @ TO_GLTF.T


def write_off(path, points, triangles):
    lines = ["OFF", f"{len(points)} {len(triangles)} 0"]
    lines += ["%.9g %.9g %.9g" % tuple(point) for point in points.astype(numpy.float32)]
    lines += ["3 %d %d %d" % tuple(triangle) for triangle in triangles]
    path.write_text("\n".join(lines) + "\n")


def settings(**chosen):
    own = bpy.context.scene.cloudbake
    for name, value in {"voxels": 63, **chosen}.items():
        setattr(own, name, value)


def select(*things):
    bpy.ops.object.select_all(action="DESELECT")
    for thing in things:
        thing.select_set(True)
    bpy.context.view_layer.objects.active = things[-1]


def bake(**chosen):
    settings(**chosen)
    assert bpy.ops.cloudbake.bake() == {"FINISHED"}


def refused(text, operator=None, **chosen):
    """The operator must end with an error that has the text, and change no mesh."""
    settings(**{key: value for key, value in chosen.items() if key not in ("filepath", "directory")})
    before = snapshot()
    try:
        result = (operator or bpy.ops.cloudbake.bake)(**{key: value for key, value in chosen.items() if key in ("filepath", "directory")})
    except RuntimeError as error:
        assert text in str(error), f"another error: {error}"
    else:
        raise AssertionError(f"not refused: {result}")
    assert snapshot() == before, "something was changed"


def snapshot():
    """Everything that a bake may change."""
    meshes = {mesh.name: (mesh.users, mesh.get("cloudbake"),
                          [(layer.name, values(layer.data, "uv", 2).tobytes()) for layer in mesh.uv_layers],
                          [material and material.name for material in mesh.materials]) for mesh in bpy.data.meshes}
    return meshes, {thing.name: thing.data and thing.data.name for thing in bpy.data.objects}, sorted(bpy.data.materials.keys())


def maps(thing):
    return [layer.name for layer in thing.data.uv_layers]


def add_maps(thing, count, name="map"):
    for number in range(count):
        layer = thing.data.uv_layers.new(name=f"{name} {number}", do_init=False)
        layer.data.foreach_set("uv", [number + 0.25] * (2 * len(thing.data.loops)))


def collection(name, *things, parent=None):
    made = bpy.data.collections.new(name)
    (parent or bpy.context.scene.collection).children.link(made)
    for thing in things:
        for other in thing.users_collection:
            other.objects.unlink(thing)
        made.objects.link(thing)
    return made


def pair():
    """Two lumps that shade each other."""
    return lump("left", 1, 3, rotation=(0.3, 0.2, 1.1)), lump("right", 2, 3, location=(1.2, 0.3, 0.4), scale=(0.7, 0.8, 0.6))


# ---- bakes ------------------------------------------------------------------------------------------------------------------------------


@scenario
def object_alone(found):
    one, other = pair()
    select(other, one)
    bake(scope="ACTIVE")
    assert maps(one) == MAPS and maps(other) == []
    found.cloud([one])


@scenario
def selected_together(found):
    things = pair()
    select(*things)
    bake()
    found.cloud(bpy.context.selected_objects)


@scenario
def selected_each(found):
    things = pair()
    select(*things)
    bake(each=True)
    for thing in things:
        found.cloud([thing])
    assert things[0].material_slots[0].material != things[1].material_slots[0].material


@scenario
def collection_with_children(found):
    one, other = pair()
    hidden = lump("hidden", 3, 2, location=(0, 0, 3))
    inner = collection("inner", other, hidden)
    outer = collection("outer", one, link("lamp", bpy.data.lights.new("lamp", "POINT")), empty("nothing"))
    bpy.context.scene.collection.children.unlink(inner)
    outer.children.link(inner)
    hidden.hide_set(True)
    bake(scope="COLLECTION", collection=outer)
    assert maps(hidden) == []
    found.cloud([one, other] if outer.all_objects[0] == one else [other, one])


@scenario
def instances_of_a_mesh(found):
    mesh = lump_mesh("shared", 4, 3)
    things = [link(f"copy {n}", mesh, location=(1.3 * n, 0, 0), rotation=(n, 0.4 * n, 0), scale=(1, 1 + 0.2 * n, 1)) for n in range(3)]
    outside = link("outside", mesh, location=(0, 9, 0))
    select(*things)
    bake()
    assert len({thing.data.name for thing in things + [outside]}) == 4 and maps(outside) == []
    found.cloud(bpy.context.selected_objects)


@scenario
def collection_instances_are_refused(found):
    inner = collection("inner", lump("ball", 1, 2))
    instancer = empty("instancer")
    instancer.instance_type, instancer.instance_collection = "COLLECTION", inner
    outer = collection("outer", instancer)
    refused("'instancer' makes instances", scope="COLLECTION", collection=outer)
    carrier = lump("carrier", 2, 2)
    child = lump("child", 3, 1, scale=(0.1, 0.1, 0.1), parent=carrier)
    carrier.instance_type = "VERTS"
    child.hide_set(True)
    select(carrier)
    refused("'carrier' makes instances", scope="ACTIVE")


@scenario
def mirrored(found):
    thing = lump("mirrored", 5, 3, location=(2, 1, -1), rotation=(0.3, 0.5, 0.7), scale=(-1.4, 0.7, 1))
    select(thing)
    bake()
    found.cloud([thing])


@scenario
def sheared(found):
    above = empty("above", scale=(1.5, -0.6, 1), rotation=(0.2, 0.3, 0.5))
    thing = lump("sheared", 6, 3, rotation=(0.6, 0.4, 0.9), parent=above)
    select(thing)
    bpy.context.view_layer.update()
    bake()
    found.cloud([thing])


@scenario
def flat_scale_is_refused(found):
    select(lump("flat", 1, 2, scale=(1, 0, 1)))
    refused("'flat' has a scale of 0")


@scenario
def modifiers_that_bend(found):
    thing = lump("bent", 7, 3)
    bend = thing.modifiers.new("bend", "SIMPLE_DEFORM")
    bend.deform_method, bend.angle = "BEND", 1.2
    wave = thing.modifiers.new("cast", "CAST")
    wave.factor = 0.3
    select(thing)
    bake()
    found.cloud([thing])
    shape = world_triangles(thing)[0] - world_triangles(thing, base=True)[0]
    assert abs(shape).max() > 0.05, "the modifiers do nothing"


@scenario
def modifiers_that_divide(found):
    thing = lump("divided", 8, 3)
    thing.modifiers.new("Ünterteilung", "SUBSURF").levels = 1
    select(thing)
    bake(shape="BASE")
    found.cloud([thing], base=True)
    bake(shape="EVALUATED")
    assert thing.hide_get() and thing.modifiers and len(bpy.data.objects) == 2
    copy = bpy.context.selected_objects[0]
    assert copy.name == "divided baked" and len(copy.data.vertices) == 962 and not copy.modifiers
    found.cloud([copy])
    thing.hide_set(False)
    select(thing)
    bake(rays=60)  # again, into the same copy
    assert bpy.context.selected_objects == [copy] and len(bpy.data.objects) == 2
    found.cloud([copy], ["--rays", "60"])


@scenario
def shape_keys(found):
    thing = lump("keys", 9, 3)
    thing.shape_key_add(name="Basis")
    key = thing.shape_key_add(name="long")
    for vertex in key.data:
        vertex.co.z *= 1.6
    key.value = 0.7
    select(thing)
    bake()
    found.cloud([thing])


@scenario
def no_uvs(found):
    thing = lump("bare", 10, 3)
    select(thing)
    bake()
    assert maps(thing) == MAPS
    found.cloud([thing])
    bake(rays=60)  # again, into the same maps
    assert maps(thing) == MAPS
    found.cloud([thing], ["--rays", "60"])


@scenario
def six_uv_maps(found):
    thing = lump("six", 11, 3)
    add_maps(thing, 6)
    thing.data.uv_layers.active_index = 2
    thing.data.uv_layers[3].active_render = True
    select(thing)
    bake()
    assert maps(thing) == [f"map {n}" for n in range(6)] + MAPS
    assert thing.data.uv_layers.active_index == 2 and thing.data.uv_layers[3].active_render
    assert all(thing.data.uv_layers[n].data[0].uv[0] == n + 0.25 for n in range(6))
    found.cloud([thing])


@scenario
def eight_uv_maps_are_refused(found):
    thing, fine = pair()
    add_maps(thing, 8)
    select(thing, fine)
    refused("'left' has 8 UV maps, and Blender allows 8: lobes need two, so delete 2")
    thing.data.uv_layers.remove(thing.data.uv_layers[0])
    refused("'left' has 7 UV maps, and Blender allows 8: lobes need two, so delete 1")


@scenario
def attribute_of_the_same_name_is_refused(found):
    one, other = pair()
    other.data.attributes.new(MAPS[1], "FLOAT", "POINT")
    select(one, other)
    refused("'right' has another attribute named 'Cloudbake 2': rename it")


@scenario
def maps_that_were_moved(found):
    thing = lump("moved", 12, 3)
    add_maps(thing, 1, MAPS[1][:-2])  # "Cloudbake 0"
    thing.data.uv_layers[0].name = MAPS[1]
    add_maps(thing, 2)
    thing.data.uv_layers.active_index = 1
    thing.data.uv_layers[2].active_render = True
    select(thing)
    bake()
    assert maps(thing) == ["map 0", "map 1"] + MAPS
    assert thing.data.uv_layers.active.name == "map 0" and thing.data.uv_layers["map 1"].active_render
    found.cloud([thing])


@scenario
def undo(found):
    thing, shared = lump("undone", 13, 3), lump("other", 14, 2)
    shared.data = thing.data
    select(thing)
    bpy.ops.ed.undo_push(message="before")
    before = snapshot()
    bake()
    bpy.ops.ed.undo_push(message="after")  # scripts that call operators push no steps
    after = snapshot()
    assert before != after
    bpy.ops.ed.undo()
    assert snapshot() == before, "undo left something"
    bpy.ops.ed.redo()
    assert snapshot() == after, "redo lost something"
    found.cloud([bpy.data.objects["undone"]])


@scenario
def unicode_names(found):
    things = [lump("雲 ☁ 'a\"", 15, 3), lump("облако/небо", 16, 3, location=(1, 0, 0))]
    own = collection("Wölkchen ✓", *things)
    bake(scope="COLLECTION", collection=own, each=True)
    folder = FOLDER / "ünïcode 文件夹"
    folder.mkdir(exist_ok=True)
    assert bpy.ops.cloudbake.export_each(directory=str(folder)) == {"FINISHED"}
    names = {thing.name: thing.name.replace('"', "_").replace("/", "_") for thing in things}
    assert sorted(path.stem for path in folder.glob("*.glb")) == sorted(names.values()), list(folder.glob("*"))
    for thing in things:
        found.cloud([thing])
        found.file(folder / f"{names[thing.name]}.glb", [thing])


# ---- options ----------------------------------------------------------------------------------------------------------------------------


@scenario
def options_of_the_panel(found):
    thing = lump("fitted", 17, 2)
    select(thing)
    bake(lobe="fit", rays=80, extinction="2:5", smooth=2, close="wrap", more="--seed 3 --fit-to=volume")
    found.cloud([thing], "--lobe fit --rays 80 --extinction 2:5 --smooth 2 --close wrap --seed 3 --fit-to volume".split())
    bake(lobe="mean", extinction="", smooth=0, close="auto", rays=100, exponent="2.5", bias="1%", more="--method rays --steps 40")
    found.cloud([thing], ["--exponent", "2.5", "--bias", "1%", "--method", "rays", "--steps", "40"])
    bake(exponent="", bias="", more="--as-published", voxels=100)
    found.cloud([thing], ["--as-published", "--voxels", "100"])


@scenario
def wrong_options(found):
    thing = lump("wrong", 18, 2)
    select(thing)
    refused("--up cannot be used in Blender", more="--up z")
    refused("--rays is set in the panel too", more="--rays 5", rays=50)
    refused("'seed' is not an option", more="seed", rays=100)
    refused("--nonsense", more="--nonsense 1")
    refused("rays", more="", rays=101)  # a sweep needs an even number
    thing.data.clear_geometry()
    refused("'wrong' has no faces", rays=100)


@scenario
def what_cannot_be_baked(found):
    refused("there is no mesh to bake")
    bpy.ops.mesh.primitive_plane_add()
    refused("encloses nothing")
    curve = link("curve", bpy.data.curves.new("curve", "CURVE"))
    select(curve)
    refused("'curve' is not a mesh: convert it first")
    thing = lump("edited", 1, 1)
    select(thing)
    bpy.ops.object.mode_set(mode="EDIT")
    refused("change to object mode first")
    bpy.ops.object.mode_set(mode="OBJECT")


@scenario
def strict(found):
    """A mesh with a hole is closed with a warning, or refused."""
    thing = lump("open", 19, 3)
    bpy.ops.object.select_all(action="DESELECT")
    activate(thing)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    bpy.ops.object.mode_set(mode="OBJECT")
    thing.data.polygons[5].select = True
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.delete(type="FACE")
    bpy.ops.object.mode_set(mode="OBJECT")
    refused("open", strict=True)
    refused("", strict=False, close="reject")
    bake(close="auto")
    found.cloud([thing])


def volume(thing):
    points, triangles = world_triangles(thing)
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return (numpy.cross(a, b) * c).sum() / 6


@scenario
def repairs(found):
    """Both leave the vertices as they are: the lobes are stored in the mesh, whose triangles stay."""
    thing = lump("turned", 32, 3)
    for polygon in list(thing.data.polygons)[:40]:
        polygon.flip()
    select(thing)
    bake(repair={"orient"})
    found.cloud([thing], ["--repair", "orient"])
    hole = bmesh.new()
    hole.from_mesh(thing.data)
    hole.faces.ensure_lookup_table()
    bmesh.ops.delete(hole, geom=hole.faces[50:51], context="FACES_ONLY")
    hole.to_mesh(thing.data)
    hole.free()
    bake(repair={"orient", "fill"})
    assert len(thing.data.polygons) == 319 and len(bpy.data.objects) == 1
    found.cloud([thing], ["--repair", "orient,fill"])


@scenario
def new_vertices(found):
    thing = lump("dense", 20, 4, location=(1, 2, 3), scale=(-2, 1, 1))
    add_maps(thing, 1)
    select(thing)
    before = set(bpy.data.objects)
    bake(vertices=600)
    assert maps(thing) == ["map 0"]
    made, = set(bpy.data.objects) - before
    assert 300 < len(made.data.vertices) <= 600 and maps(made) == MAPS, (len(made.data.vertices), maps(made))
    assert volume(made) > 0, "it is turned inside out"
    select(made)
    assert bpy.ops.cloudbake.export_asset(filepath=str(FOLDER / "new_vertices.glb")) == {"FINISHED"}
    found.file(FOLDER / "new_vertices.glb", [made])


@scenario
def program_is_missing(found):
    thing = lump("waiting", 1, 2)
    select(thing)
    own = bpy.context.preferences.addons["cloudbake_addon"].preferences
    own.program = "/nowhere/cloudbake"
    refused("the program cloudbake is not at '/nowhere/cloudbake': install it, or set its absolute path in the add-on's preferences")
    own.program, path, before = "", os.environ["PATH"], os.getcwd()
    trap = FOLDER / "trap"
    trap.mkdir()
    (trap / "cloudbake").write_text("#!/bin/sh\n", encoding="utf-8")
    (trap / "cloudbake").chmod(0o755)
    os.chdir(trap)
    for relative in ("", ".", ".:", ":/nowhere"):
        os.environ["PATH"] = relative
        refused("the program cloudbake is not on the search path")
    for program in ("cloudbake", "./cloudbake"):
        own.program = program
        refused(f"the program cloudbake is not at '{program}'")
    os.chdir(before)
    own.program = ""
    os.environ["PATH"] = "/nowhere"
    refused("the program cloudbake is not on the search path")
    os.environ["PATH"] = str(pathlib.Path(PROGRAM).parent)
    own.program = __file__
    refused("" if os.access(__file__, os.X_OK) else "is not at")
    own.program = ""
    if pathlib.Path(PROGRAM).name == "cloudbake":
        bake()
        found.cloud([thing])
    os.environ["PATH"] = path


@scenario
def program_that_is_killed(found):
    """Its last line is a warning, and not the cause."""
    thing = lump("waiting", 1, 2)
    select(thing)
    program = FOLDER / "killed_program"
    program.write_text("#!/bin/sh\necho 'cloudbake: warning: some' >&2\nkill -KILL $$\n", encoding="utf-8")
    program.chmod(0o755)
    own = bpy.context.preferences.addons["cloudbake_addon"].preferences
    own.program = str(program)
    refused("the program was ended by a signal (Killed)")
    own.program = ""


@scenario
def module_instead_of_the_program(found):
    """A stand-in for the Python module, which bakes by the program but keeps a record of how it was called."""
    thing = lump("module", 21, 3)
    select(thing)
    calls, module = [], types.ModuleType("cloudbake")

    def stand_in(vertices, triangles, **options):
        calls.append((vertices.dtype, vertices.shape, triangles.shape, options))
        write_off(FOLDER / "module.off", vertices, triangles)
        words = [word for name, value in options.items() for word in (f"--{name}", str(value))]
        subprocess.run([PROGRAM, "bake", FOLDER / "module.off", "-o", FOLDER / "module.glb", "-q", *words], check=True)
        warning = types.SimpleNamespace(kind="some", count=3, first="a warning")
        return types.SimpleNamespace(glb=(FOLDER / "module.glb").read_bytes(), warnings=(warning,))

    setattr(module, "bake", stand_in)
    sys.modules["cloudbake"] = module
    bpy.context.preferences.addons["cloudbake_addon"].preferences.program = "/nowhere"
    try:
        bake(rays=80)
    finally:
        del sys.modules["cloudbake"]
    count = len(thing.data.vertices)
    assert calls == [(numpy.float32, (count, 3), (len(thing.data.polygons), 3), {"rays": 80, "voxels": 63})], calls
    found.cloud([thing], ["--rays", "80"])


# ---- files ------------------------------------------------------------------------------------------------------------------------------


def export(found, name, things, **more):
    path = FOLDER / f"{name}.glb"
    select(*things)
    settings(scope="SELECTED")
    before = snapshot(), [thing.name for thing in bpy.context.selected_objects], bpy.context.view_layer.objects.active.name
    assert bpy.ops.cloudbake.export_asset(filepath=str(path)) == {"FINISHED"}
    assert before == (snapshot(), [thing.name for thing in bpy.context.selected_objects], bpy.context.view_layer.objects.active.name)
    found.file(path, things, **more)
    return path


@scenario
def export_of_one(found):
    thing = lump("exported", 22, 3, location=(1, 2, 3), rotation=(0.2, 0.4, 0.6), scale=(1, -2, 1.5))
    add_maps(thing, 1)
    select(thing)
    bake()
    export(found, "export_of_one", [thing])


@scenario
def export_together(found):
    """Objects with other numbers of UV maps, one sheared below a parent that is not exported, one below a parent that is."""
    one, other = pair()
    add_maps(other, 2)
    above = empty("above", scale=(1.5, 0.6, 1), rotation=(0.2, 0.3, 0.5))
    third = lump("third", 23, 2, rotation=(0.6, 0.4, 0.9), location=(0.5, 0.5, 1), parent=above)
    fourth = lump("fourth", 24, 2, rotation=(0.6, 0.4, -0.9), location=(0.1, 0.5, 1), scale=(0.5, 0.8, -0.6), parent=third)
    select(one, other, third, fourth)
    bpy.context.view_layer.update()
    bake()
    path = export(found, "export_together", [one, other, third, fourth])
    document = read_glb(path)[0]
    assert document["asset"]["extras"]["cloudbake"]["uv_sets"] == [2, 3]
    assert all("TEXCOORD_3" in primitive["attributes"] for mesh in document["meshes"] for primitive in mesh["primitives"])


@scenario
def export_of_shapes(found):
    """Modifiers and shape keys."""
    bent, keyed = lump("bent", 25, 3), lump("keyed", 26, 3, location=(3, 0, 0))
    bend = bent.modifiers.new("bend", "SIMPLE_DEFORM")
    bend.deform_method, bend.angle = "BEND", 1.2
    keyed.shape_key_add(name="Basis")
    for vertex in keyed.shape_key_add(name="long").data:
        vertex.co.z *= 1.6
    keyed.data.shape_keys.key_blocks["long"].value = 0.7
    select(bent, keyed)
    bake()
    found.cloud([bent, keyed] if bpy.context.selected_objects[0] == bent else [keyed, bent])
    export(found, "export_of_shapes", [bent, keyed])


@scenario
def export_of_what_was_baked_apart(found):
    """Possible if k, b and extinction are the same. The file says that its objects do not shade each other."""
    things = pair()
    select(*things)
    bake(each=True, extinction="2.5", exponent="2", bias="-0.01")
    for thing in things:
        found.cloud([thing], ["--extinction", "2.5", "--exponent", "2", "--bias=-0.01"])
    path = export(found, "export_of_what_was_baked_apart", things)
    assert b'"separate": true' in path.read_bytes()


@scenario
def exports_that_are_refused(found):
    one, other = pair()
    select(one)
    refused("'left' is not baked yet", bpy.ops.cloudbake.export_asset, filepath=str(FOLDER / "refused.glb"))
    select(one, other)
    bake(each=True)
    refused("these objects were baked apart", bpy.ops.cloudbake.export_asset, filepath=str(FOLDER / "refused.glb"))
    select(one)
    refused("cannot be written", bpy.ops.cloudbake.export_asset, filepath="/nowhere/refused.glb")
    assert not (FOLDER / "refused.glb").exists()
    one.data.uv_layers[0].name = "something else"
    refused("'left' is not baked yet", bpy.ops.cloudbake.export_asset, filepath=str(FOLDER / "refused.glb"))


def glb_with(data, old, new):
    """The GLB with other bytes in its JSON."""
    size = int.from_bytes(data[12:16], "little")
    text = data[20:20 + size].replace(old, new).rstrip(b" ")
    text += b" " * (-len(text) % 4)
    whole = data[:8] + (len(data) - size + len(text)).to_bytes(4, "little") + len(text).to_bytes(4, "little") + data[16:20]
    return whole + text + data[20 + size:]


@scenario
def export_keeps_maps_alive(found):
    """A material without a texture gets a white one, whatever it and other images are called."""
    things = pair()
    for thing, name in zip(things, ("Marble Texture", "Painted")):
        thing.data.materials.append(bpy.data.materials.new(name))
        thing.data.materials[0].use_nodes = True
    tree = things[1].data.materials[0].node_tree
    own, image = tree.nodes.new("ShaderNodeTexImage"), bpy.data.images.new("white", 4, 4)
    image.pixels = [0.2, 0.4, 0.6, 1] * 16
    image.pack()
    own.image = image
    tree.links.new(own.outputs["Color"], next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED").inputs["Base Color"])
    add_maps(things[1], 1)
    select(*things)
    settings(make_material=False)
    bake()
    path = export(found, "export_keeps_maps_alive", things)
    document = read_glb(path)[0]
    marble, painted = (next(one for one in document["materials"] if one["name"] == name) for name in ("Marble Texture", "Painted"))
    white, first = marble["pbrMetallicRoughness"]["baseColorTexture"], document["asset"]["extras"]["cloudbake"]["uv_sets"][0]
    assert (white["texCoord"], marble["occlusionTexture"]["texCoord"]) == (first, first + 1), marble
    assert painted["pbrMetallicRoughness"]["baseColorTexture"]["index"] != white["index"] and "occlusionTexture" not in painted, painted
    view = document["bufferViews"][document["images"][document["textures"][white["index"]]["source"]]["bufferView"]]
    assert view["byteLength"] < 100, "the white texture has two pixels"


@scenario
def import_again(found):
    """A file that the add-on wrote comes back with its lobes and its material, and can be written again."""
    thing = lump("first", 27, 3, rotation=(0.4, 0.2, 0.1), scale=(1, 2, -1))
    add_maps(thing, 1)
    select(thing)
    bake(bias="2%", exponent="2.5")
    path = export(found, "import_again", [thing])
    bpy.data.objects.remove(thing)
    sun = link("sun", bpy.data.lights.new("sun", "SUN"), rotation=(1, 0.3, 0.2))
    assert bpy.ops.cloudbake.import_asset(filepath=str(path)) == {"FINISHED"}
    again = next(thing for thing in bpy.context.scene.objects if thing.type == "MESH")
    assert maps(again)[1:] == MAPS
    node = next(node for node in again.material_slots[0].material.node_tree.nodes if node.type == "GROUP")
    asset = json.loads(again.data["cloudbake"])["asset"]
    for key in ("exponent", "bias", "extinction"):
        assert math.isclose(node.inputs[key.capitalize()].default_value, asset[key], rel_tol=1e-6), key
    assert asset["exponent"] == 2.5 and asset["uv_sets"] == [1, 2]
    bpy.context.view_layer.update()
    assert (sun.matrix_world.to_3x3().col[2] - Vector(node.inputs["Sun direction"].default_value)).length < 1e-6
    export(found, "import_again_again", [again])


def transmittance(lobes, lights, asset):
    """T of vectors o·d, for each light."""
    d = numpy.linalg.norm(lobes, axis=1)
    half_cosine = numpy.maximum(lobes / d[:, None] @ lights.T * 0.5 + 0.5, 0)
    thickness = half_cosine ** asset["exponent"] * d[:, None] + asset["bias"]
    return numpy.exp(-asset["extinction"] * numpy.maximum(thickness, 0))


@scenario
def import_of_packed_assets(found):
    """They have the lobes of the file, the light of the same cloud with four floats, and can be written again."""
    thing = lump("packed", 29, 3, rotation=(0.4, 0.2, 0.1), scale=(1, 2, 1.5))
    select(thing)
    bpy.ops.export_scene.gltf(filepath=str(FOLDER / "packed.glb"), use_selection=True)
    bpy.data.objects.remove(thing)
    clouds, files = {}, {}
    packings: dict[str, list[str]] = {"floats": [], "list": ["--pack", "8"], "strip": ["--pack", "8", "--pack-as", "strip"]}
    for name, options in packings.items():
        files[name] = FOLDER / f"packed.{name}.glb"
        subprocess.run([PROGRAM, "bake", FOLDER / "packed.glb", "-o", files[name], "-q", *options], check=True)
        assert bpy.ops.cloudbake.import_asset(filepath=str(files[name])) == {"FINISHED"}
        clouds[name] = bpy.context.selected_objects[0]
    bpy.context.view_layer.update()
    asset, turns = json.loads(clouds["list"].data["cloudbake"])["asset"], numpy.random.default_rng(1).normal(size=(64, 3))
    assert asset["layout"] == "lobe-uv" and not {"density_max", "certificate", "seal"} & set(asset)
    lights, plain = turns / numpy.linalg.norm(turns, axis=1)[:, None], world_lobes(clouds["floats"])
    assert 0.3 < (plain[:, 2] < 0).mean() < 0.7, "too few lobes on one half of the octahedron"
    for name in ("list", "strip"):
        far = numpy.abs(transmittance(world_lobes(clouds[name]), lights, asset) - transmittance(plain, lights, asset)).max()
        assert far < 1 / 255, f"{name}: T differs by {far}"
        assert numpy.abs(world_triangles(clouds[name])[0] - world_triangles(clouds["floats"])[0]).max() < 1e-3, f"{name}: other places"
    found.file(files["list"], [clouds["list"]])
    path = export(found, "import_of_packed_assets", [clouds["list"]])
    written = read_glb(path)[0]
    assert written["asset"]["extras"]["cloudbake"]["layout"] == "lobe-uv" and "KHR_mesh_quantization" not in str(written)


@scenario
def imports_that_are_refused(found):
    (FOLDER / "plain.glb").write_bytes(b"glTF" + bytes(30))
    refused("cannot be read", bpy.ops.cloudbake.import_asset, filepath=str(FOLDER / "plain.glb"))
    refused("cannot be read", bpy.ops.cloudbake.import_asset, filepath=str(FOLDER / "missing.glb"))
    thing = lump("plain", 1, 1)
    select(thing)
    bpy.ops.export_scene.gltf(filepath=str(FOLDER / "plain.glb"), use_selection=True)
    refused("is not a baked asset", bpy.ops.cloudbake.import_asset, filepath=str(FOLDER / "plain.glb"))
    bake()
    path = FOLDER / "infinite.glb"
    assert bpy.ops.cloudbake.export_asset(filepath=str(path)) == {"FINISHED"}
    exponent = f'"exponent": {read_glb(path)[0]["asset"]["extras"]["cloudbake"]["exponent"]}'.encode()
    for wrong in (b"1e39", b"Infinity", b"NaN", b"null", b'"3"'):
        data = path.read_bytes()
        assert exponent + b"," in data
        (FOLDER / "wrong.glb").write_bytes(glb_with(data, exponent, b'"exponent": ' + wrong))
        refused("asset.extras.cloudbake.exponent is", bpy.ops.cloudbake.import_asset, filepath=str(FOLDER / "wrong.glb"))
    packed = glb_with(path.read_bytes(), b'"lobe-uv"', b'"lobe-packed"')
    for wrong in (b"0", b"-2.5", b"null"):
        (FOLDER / "wrong.glb").write_bytes(glb_with(packed, exponent, b'"density_max": ' + wrong + b", " + exponent))
        refused("asset.extras.cloudbake.density_max is", bpy.ops.cloudbake.import_asset, filepath=str(FOLDER / "wrong.glb"))


def bent_rig(thing):
    """Bends an object by an armature of one bone."""
    rig = link("rig", bpy.data.armatures.new("rig"))
    activate(rig)
    bpy.ops.object.mode_set(mode="EDIT")
    bone = rig.data.edit_bones.new("spine")
    bone.tail = (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    thing.vertex_groups.new(name="spine").add([vertex.index for vertex in thing.data.vertices if vertex.co.z > 0], 1, "REPLACE")
    thing.modifiers.new("skeleton", "ARMATURE").object = rig
    return rig


@scenario
def what_changed_since_the_bake(found):
    """An export of another shape than the baked one is refused, and names what has changed. Taken back, it goes."""
    thing = lump("living", 45, 2)
    thing.shape_key_add(name="Basis")
    for vertex in thing.shape_key_add(name="long").data:
        vertex.co.z *= 1.5
    key, cast = thing.data.shape_keys.key_blocks["long"], thing.modifiers.new("round", "CAST")
    rig = bent_rig(thing)
    key.value, cast.factor = 0.5, 0.2
    rig.pose.bones["spine"].location = (0.3, 0, 0)
    select(thing)
    bake()
    target = FOLDER / "what_changed.glb"
    export(found, "what_changed_1", [thing])

    def changed(words, change, back):
        change()
        bpy.context.view_layer.update()
        refused(words, bpy.ops.cloudbake.export_asset, filepath=str(target))
        refused("'living' has another shape than it was baked with", bpy.ops.cloudbake.export_each, directory=str(FOLDER))
        back()
        bpy.context.view_layer.update()

    spine = rig.pose.bones["spine"]
    changed("shape key 'long' was 0.5 and is 0.9", lambda: setattr(key, "value", 0.9), lambda: setattr(key, "value", 0.5))
    changed("'factor' of modifier 'round' was 0.2 and is 0.7", lambda: setattr(cast, "factor", 0.7), lambda: setattr(cast, "factor", 0.2))
    changed("modifier 'round' was removed or switched off", lambda: setattr(cast, "show_viewport", False),
            lambda: setattr(cast, "show_viewport", True))
    changed("armature 'rig' has another pose (bone 'spine')", lambda: setattr(spine, "location", (0, 0.4, 0)),
            lambda: setattr(spine, "location", (0.3, 0, 0)))
    for frame, place in ((1, (0.3, 0, 0)), (9, (0, 0, 0.5))):
        spine.location = place
        spine.keyframe_insert("location", frame=frame)
    scene = bpy.context.scene
    changed("the frame was 1 and is 9", lambda: scene.frame_set(9), lambda: scene.frame_set(1))
    old = thing.data.vertices[3].co.copy()
    base = thing.data.shape_keys.key_blocks["Basis"].data[3]

    def edited(place):
        base.co = thing.data.vertices[3].co = place

    changed("the mesh was edited", lambda: edited(old * 2), lambda: edited(old))
    assert not target.exists()
    export(found, "what_changed_2", [thing])
    changed("it was moved against 'rig', which a modifier uses", lambda: setattr(thing, "location", (5, 1, 2)),
            lambda: setattr(rig, "location", (5, 1, 2)))  # together: a place is no shape
    export(found, "what_changed_3", [thing])


@scenario
def what_was_moved_since_the_bake(found):
    """Clouds that shade each other can be moved together, and not apart."""
    left, right = pair()
    select(left, right)
    bake()
    right.location.x += 0.5
    bpy.context.view_layer.update()
    refused("'left' and 'right' were baked together and shade each other", bpy.ops.cloudbake.export_asset, filepath=str(FOLDER / "no.glb"))
    left.location.x += 0.5
    bpy.context.view_layer.update()
    export(found, "moved_together", [left, right])


@scenario
def duplicates_of_a_baked_object(found):
    """They have its lobes, with a mesh of their own or a shared one, wherever they are moved to. They shade nothing."""
    thing = lump("one", 51, 2)
    select(thing)
    bake()
    own, shared = thing.copy(), thing.copy()
    own.data = thing.data.copy()
    own.location, shared.location = (4, 0, 0), (0, 4, 0)
    for copy in (own, shared):
        bpy.context.scene.collection.objects.link(copy)
    bpy.context.view_layer.update()
    path = export(found, "duplicates", [thing, own, shared])
    assert read_glb(path)[0]["asset"]["extras"]["cloudbake"]["separate"] is True
    bpy.ops.wm.read_factory_settings(use_empty=True)
    prepare()
    assert bpy.ops.cloudbake.import_asset(filepath=str(path)) == {"FINISHED"}
    things = [thing for thing in bpy.context.scene.objects if thing.type == "MESH"]
    things[0].location.z += 1
    bpy.context.view_layer.update()
    export(found, "duplicates_again", things)


@scenario
def applied_copy_of_a_changed_object(found):
    """The copy is not exported once the modifiers of its object are others."""
    thing = lump("divided", 46, 2)
    thing.modifiers.new("Subdivision", "SUBSURF").levels = 1
    select(thing)
    bake()
    copy = bpy.context.selected_objects[0]
    thing.modifiers["Subdivision"].levels = 2
    refused("'divided' has changed since its bake: 'levels' of modifier 'Subdivision' was 1 and is 2", bpy.ops.cloudbake.export_asset,
            filepath=str(FOLDER / "no.glb"))
    thing.modifiers["Subdivision"].levels = 1
    thing.hide_set(False)
    select(thing)  # which is not baked itself
    assert bpy.ops.cloudbake.material() == {"FINISHED"} and lobe_node(copy.material_slots[0].material)
    assert bpy.ops.cloudbake.export_asset(filepath=str(FOLDER / "by_its_object.glb")) == {"FINISHED"}
    found.file(FOLDER / "by_its_object.glb", [copy])
    thing.hide_set(True)
    path = export(found, "applied_copy", [copy])
    assert [node["name"] for node in read_glb(path)[0]["nodes"]] == ["divided"]
    bpy.data.objects.remove(thing)
    export(found, "applied_copy_alone", [copy])


@scenario
def causes_are_named(found):
    """Which object, modifier or instancer it is, and what to do."""
    thing = lump("ghost", 47, 2)
    mask = thing.modifiers.new("Mask all", "MASK")
    mask.vertex_group = thing.vertex_groups.new(name="none").name
    select(thing)
    refused("'ghost' has no faces behind its modifiers ('Mask all')")
    thing.modifiers.clear()
    fine, flat = lump("fine", 48, 2, location=(4, 0, 0)), link("flat", bpy.data.meshes.new("flat"))
    flat.data.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    select(fine, flat)
    refused("'flat': ", each=True)
    thing.modifiers.new("hair", "PARTICLE_SYSTEM")
    ball = lump("seed", 49, 1, scale=(0.1, 0.1, 0.1))
    thing.particle_systems[0].settings.type, thing.particle_systems[0].settings.render_type = "HAIR", "OBJECT"
    thing.particle_systems[0].settings.instance_object = ball
    select(thing)
    refused("'ghost' makes instances (particle system 'hair'), which cannot hold lobes of their own: make them real first", each=False)


# ---- sun, versions, registration --------------------------------------------------------------------------------------------------------


@scenario
def sun_drives_the_material(found):
    """By a lamp under a turned and scaled parent, in an animation, and after a change of the lamp."""
    thing = lump("lit", 28, 2)
    select(thing)
    above = empty("above", rotation=(0.3, 1.0, 0.2), scale=(2, 2, 2))
    first = link("b sun", bpy.data.lights.new("sun", "SUN"), rotation=(1, 0.3, 0.2), parent=above)
    other = link("a sun", bpy.data.lights.new("sun", "SUN"), rotation=(-0.5, 0.1, 0.2))
    settings(sun=first)
    bake()
    node = next(node for node in thing.material_slots[0].material.node_tree.nodes if node.type == "GROUP")

    def follows(sun, what):
        bpy.context.view_layer.update()
        wanted = sun.matrix_world.to_3x3().col[2].normalized()
        assert (wanted - Vector(node.inputs["Sun direction"].default_value)).length < 1e-6, what

    follows(first, "the chosen sun")
    first.rotation_euler.x = -1
    follows(first, "after a turn")
    for frame, angle in ((1, 0.0), (20, 2.0)):
        first.rotation_euler.z = angle
        first.keyframe_insert("rotation_euler", frame=frame)
    for frame in (1, 7, 20):
        bpy.context.scene.frame_set(frame)
        follows(first, f"frame {frame}")
    settings(sun=None)
    assert bpy.ops.cloudbake.follow_sun() == {"FINISHED"}
    follows(other, "the first sun by name")
    assert len(thing.material_slots[0].material.node_tree.animation_data.drivers) == 3
    for curve in thing.material_slots[0].material.node_tree.animation_data.drivers:
        assert curve.driver.is_simple_expression, "the driver needs Python"


@scenario
def materials(found):
    """A material of the artist's own stays until the button is used, and a bake gives the group new constants."""
    thing = lump("own", 29, 2)
    own = bpy.data.materials.new("own")
    thing.data.materials.append(own)
    select(thing)
    bake()
    assert thing.material_slots[0].material == own
    refused("the scene has no sun lamp", bpy.ops.cloudbake.follow_sun)
    add_sun()
    refused("no material shows lobes yet: choose 'own' and press Set Up first", bpy.ops.cloudbake.follow_sun)
    own.diffuse_color = (0.2, 0.4, 0.6, 1)
    assert bpy.ops.cloudbake.material() == {"FINISHED"}
    assert thing.material_slots[0].material == own and own.use_nodes
    assert bpy.ops.cloudbake.follow_sun() == {"FINISHED"}
    bake(extinction="1.5")
    node = lobe_node(own)
    assert thing.material_slots[0].material == own and node.inputs["Extinction"].default_value == 1.5
    assert [round(value, 3) for value in node.inputs["Base color"].default_value] == [0.2, 0.4, 0.6, 1]
    assert len([tree for tree in bpy.data.node_groups if tree.name.startswith("Cloudbake")]) == 1
    assert bpy.ops.cloudbake.remove_material() == {"FINISHED"}
    assert thing.material_slots[0].material == own and not own.use_nodes and not any(key.startswith("cloudbake") for key in own.keys())
    refused("no material of these objects was set up", bpy.ops.cloudbake.remove_material)


def add_sun():
    return link("sun", bpy.data.lights.new("sun", "SUN"), rotation=(1, 0.3, 0.2))


def lobe_node(material):
    return next(node for node in material.node_tree.nodes if node.type == "GROUP" and "cloudbake_version" in node.node_tree)


def picture():
    """The colours of a small picture by Cycles, with one sample in the middle of each pixel."""
    scene = bpy.context.scene
    camera = link("camera", bpy.data.cameras.new("camera"), location=(1.5, -9, 0), rotation=(math.pi / 2, 0, 0))
    scene.camera, scene.render.engine, scene.render.filepath = camera, "CYCLES", str(FOLDER / "picture.exr")
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 64, 48, 100
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.device = 1, False, "CPU"
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 0.01
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    image.colorspace_settings.name = "Non-Color"
    pixels = numpy.array(image.pixels[:])
    bpy.data.images.remove(image)
    bpy.data.objects.remove(camera)
    return pixels.reshape(48, 64, 4)[..., :3]


@scenario
def material_of_two_bakes(found):
    """Objects that were baked apart have other k, b and sigma, and may share a material. One without lobes shows the artist's shader."""
    things = [lump(name, 40, 2, location=(3 * number, 0, 0)) for number, name in enumerate(("thin", "dense"))]
    stone = lump("stone", 41, 2, location=(1.5, 0, 2.2), scale=(0.4, 0.4, 0.4))
    shared = bpy.data.materials.new("shared")
    shared.use_nodes = True
    glow = shared.node_tree.nodes.new("ShaderNodeEmission")
    glow.inputs["Color"].default_value = (0.9, 0.1, 0.1, 1)
    shared.node_tree.links.new(glow.outputs[0], shared.node_tree.nodes["Material Output"].inputs["Surface"])
    for thing in (*things, stone):
        thing.data.materials.append(shared)
    add_sun()
    for thing, extinction in zip(things, ("0.3", "6")):
        select(thing)
        bake(extinction=extinction, scope="SELECTED")
    select(*things)
    assert bpy.ops.cloudbake.material() == {"FINISHED"} and all(thing.material_slots[0].material == shared for thing in things)
    together = picture()
    for thing, wanted in zip(things, (0.3, 6)):
        thing.data.materials[0] = shared.copy()
        select(thing)
        assert bpy.ops.cloudbake.material() == {"FINISHED"}
        node = lobe_node(thing.data.materials[0])
        assert not node.inputs["Extinction"].is_linked and math.isclose(node.inputs["Extinction"].default_value, wanted, rel_tol=1e-6)
    apart = picture()
    assert abs(together - apart).max() < 1e-5, abs(together - apart).max()
    assert (abs(together - (0.9, 0.1, 0.1)).max(axis=2) < 1e-5).sum() > 20, "the stone does not show its own shader"
    halves = together[:, :32].max(), together[:, 32:].max()
    assert together[20:28, 8:16].mean() > 1.2 * together[20:28, 48:56].mean() or halves[0] != halves[1], "both clouds look the same"


@scenario
def empty_slots_come_back(found):
    """Objects without slots, and with an empty one between two others."""
    bare, between = lump("bare", 42, 2), lump("between", 43, 2, location=(3, 0, 0))
    for name in ("first", None, "last"):
        between.data.materials.append(bpy.data.materials.new(name) if name else None)
    between.data.polygons.foreach_set("material_index", [number % 3 for number in range(len(between.data.polygons))])
    select(bare, between)
    bake()
    assert bpy.ops.cloudbake.material() == {"FINISHED"}
    assert [slot.name for slot in between.material_slots] == ["first", "Cloudbake between", "last"]
    path = export(found, "empty_slots", [bare, between])
    assert bpy.ops.cloudbake.remove_material() == {"FINISHED"}
    names = [slot.name for slot in between.material_slots]
    assert not bare.material_slots and names == ["first", "", "last"], (list(bare.material_slots), names)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    prepare()
    assert bpy.ops.cloudbake.import_asset(filepath=str(path)) == {"FINISHED"}
    bpy.ops.object.select_all(action="SELECT")
    assert bpy.ops.cloudbake.remove_material() == {"FINISHED"}
    bare, between = bpy.data.objects["bare"], bpy.data.objects["between"]
    names = [slot.name for slot in between.material_slots]
    assert not bare.material_slots and names == ["first", "", "last"], (list(bare.material_slots), names)
    assert numpy.bincount(values(between.data.polygons, "material_index", 1, numpy.int32)[:, 0]).tolist() == [27, 27, 26]


@scenario
def clear_materials_stay_clear(found):
    """The opacity of the artist's shader holds in the set-up, and again after the artist changed it."""
    thing = lump("veil", 44, 2)
    veil = bpy.data.materials.new("veil")
    veil.use_nodes = True
    shader = veil.node_tree.nodes["Principled BSDF"]
    thing.data.materials.append(veil)
    select(thing)
    bake()
    add_sun()
    assert bpy.ops.cloudbake.material() == {"FINISHED"}
    full = picture()
    shader.inputs["Alpha"].default_value = 0.0
    assert bpy.ops.cloudbake.material() == {"FINISHED"}
    assert full.max() > 0.2 and abs(picture()).max() < 1e-6
    shader.inputs["Alpha"].default_value = 1.0
    tree, output = veil.node_tree, veil.node_tree.nodes["Material Output"]
    mix, clear = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeBsdfTransparent")
    shader.inputs["Base Color"].default_value = (0.1, 0.9, 0.1, 1)
    for sides, share in (((clear, shader), 0.0), ((shader, clear), 1.0)):  # wholly clear, both times
        for number, side in enumerate(sides):
            tree.links.new(side.outputs[0], mix.inputs[1 + number])
        tree.links.new(mix.outputs[0], output.inputs["Surface"])
        mix.inputs[0].default_value = share
        assert bpy.ops.cloudbake.material() == {"FINISHED"}
        assert abs(picture()).max() < 1e-6
        mix.inputs[0].default_value = 1 - share
        assert bpy.ops.cloudbake.material() == {"FINISHED"}
        green = picture()
        assert green[..., 1].max() > 4 * green[..., 0].max() > 0, "not the colour of the shader"
    tree.nodes.remove(mix)
    tree.nodes.remove(clear)
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    assert bpy.ops.cloudbake.remove_material() == {"FINISHED"}
    assert sorted(veil.node_tree.nodes.keys()) == ["Material Output", "Principled BSDF"]


@scenario
def wrong_version(found):
    """An older Blender is told which version it needs."""
    bpy.ops.preferences.addon_disable(module="cloudbake_addon")
    source = (pathlib.Path(ADDONS) / "cloudbake_addon/__init__.py").read_text()
    assert '"blender": (3, 4, 0)' in source
    folder = FOLDER / "newer/cloudbake_newer"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "__init__.py").write_text(source.replace('"blender": (3, 4, 0)', '"blender": (99, 1, 0)'))
    sys.path.insert(0, str(folder.parent))
    try:
        bpy.ops.preferences.addon_enable(module="cloudbake_newer")
        raise AssertionError("it was enabled")
    except (RuntimeError, ImportError) as error:
        assert "Cloudbake needs Blender 99.1 or newer; this is Blender " + bpy.app.version_string in str(error), error
    assert not hasattr(bpy.types.Scene, "cloudbake")


@scenario
def installed_from_a_zip(found):
    """Into a folder for scripts of the test's own."""
    bpy.ops.preferences.addon_disable(module="cloudbake_addon")
    archive, program = FOLDER / "cloudbake_blender.zip", FOLDER / "packed/cloudbake"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec "{PROGRAM}" "$@"\n')
    package(archive, program)
    with hidden_addon():
        bpy.ops.preferences.addon_install(filepath=str(archive))
        bpy.ops.preferences.addon_enable(module="cloudbake_addon")
        assert pathlib.Path(sys.modules["cloudbake_addon"].__file__).is_relative_to(os.environ["BLENDER_USER_SCRIPTS"])
        select(lump("installed", 31, 2))
        path, os.environ["PATH"] = os.environ["PATH"], "/nowhere"
        try:  # the program in the archive, which Blender unpacks without the right to run it
            assert "(in the add-on)" in sys.modules["cloudbake_addon.engine"].who_bakes()
            bake()
        finally:
            os.environ["PATH"] = path
        found.cloud([bpy.context.object])
        bpy.ops.preferences.addon_disable(module="cloudbake_addon")


def package(archive, *programs):
    script = pathlib.Path(ADDONS).parent / "scripts/package_addon"
    subprocess.run([sys.executable, script, "-o", archive, *(word for program in programs for word in ("--program", program))], check=True)


@scenario
def programs_are_found(found):
    """In this order: the preferences, the add-on's folder bin, beside the add-on, the search path."""
    engine: Any = sys.modules["cloudbake_addon.engine"]
    folder = FOLDER / "places"
    places = {"in the add-on": folder / "addon/bin", "beside the add-on": folder, "on the search path": folder / "path"}
    for place in places.values():
        place.mkdir(parents=True, exist_ok=True)
        (place / "cloudbake").write_text("#!/bin/sh\n")
        (place / "cloudbake").chmod(0o755)
    kept, path = engine.ADDON, os.environ["PATH"]
    engine.ADDON, os.environ["PATH"] = folder / "addon", str(folder / "path")
    try:
        for words, place in places.items():
            assert engine.who_bakes() == f"{place / 'cloudbake'} ({words})", engine.who_bakes()
            assert engine.who_bakes(PROGRAM) == f"{PROGRAM} (set in the preferences)"
            (place / "cloudbake").unlink()
        bpy.context.preferences.addons["cloudbake_addon"].preferences.program = ""
        assert "the program cloudbake is not on the search path" in sys.modules["cloudbake_addon.settings"].bakes_with(bpy.context)
    finally:
        engine.ADDON, os.environ["PATH"] = kept, path


@scenario
def module_in_node(found):
    """cloudbake.mjs instead of the program: a stand-in for the module of docs/web.md, which bakes by the program."""
    thing = lump("noded", 50, 2)
    select(thing)
    module = FOLDER / "node/cloudbake.mjs"
    module.parent.mkdir()
    module.write_text("""import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
export async function bake(data, name, options) {
  const folder = mkdtempSync(`${import.meta.dirname ?? new URL('.', import.meta.url).pathname}bake-`);
  writeFileSync(`${folder}/${name}`, data);
  const words = Object.entries(options).flatMap(([key, value]) => value === true ? [`--${key}`] : [`--${key}`, `${value}`]);
  const target = ['-o', `${folder}/out.glb`, '-q', '--json', `${folder}/out.json`];
  const done = spawnSync('PROGRAM', ['bake', `${folder}/${name}`, ...target, ...words]);
  const report = JSON.parse(readFileSync(`${folder}/out.json`));
  if (done.status) throw Object.assign(new Error(report.message), { code: done.status });
  return { glb: readFileSync(`${folder}/out.glb`), report };
}
""".replace("PROGRAM", PROGRAM))
    bpy.context.preferences.addons["cloudbake_addon"].preferences.program = str(module)
    bake(rays=80, more="--as-published")
    found.cloud([thing], ["--rays", "80", "--as-published"])
    refused("rays", rays=101, more="")  # the words of the program, not of Node
    path, os.environ["PATH"] = os.environ["PATH"], "/nowhere"
    try:
        refused("needs Node 18 or newer, which is not on the search path", rays=80)
    finally:
        os.environ["PATH"] = path


@contextlib.contextmanager
def hidden_addon():
    """Python does not find the add-on in the source folder."""
    names = [name for name in sys.modules if name.partition(".")[0] == "cloudbake_addon"]
    kept = {name: sys.modules.pop(name) for name in names}
    sys.path.remove(ADDONS)
    try:
        yield
    finally:
        for name in [name for name in sys.modules if name.partition(".")[0] == "cloudbake_addon"]:
            del sys.modules[name]
        sys.modules.update(kept)
        sys.path.insert(0, ADDONS)


@scenario
def switched_off_and_on(found):
    bpy.ops.preferences.addon_disable(module="cloudbake_addon")
    assert not hasattr(bpy.types.Scene, "cloudbake") and not hasattr(bpy.types, "CLOUDBAKE_PT_panel")
    bpy.ops.preferences.addon_enable(module="cloudbake_addon")
    bpy.context.preferences.addons["cloudbake_addon"].preferences.program = PROGRAM
    select(lump("again", 30, 2))
    bake()
    found.cloud([bpy.context.object])


# ---- with a window ----------------------------------------------------------------------------------------------------------------------


def events(window, *keys):
    for key in keys:
        window.event_simulate(type=key, value="PRESS")
        window.event_simulate(type=key, value="RELEASE")


def viewport():
    """The window and the area of a 3D view, for operators."""
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    return {"window": window, "area": area, "region": next(region for region in area.regions if region.type == "WINDOW")}


def until(holds, what):
    """Lets the window live until something holds."""
    end = time.monotonic() + HANGS
    while not holds():
        assert time.monotonic() < end, f"{what}: not after {HANGS} seconds"
        yield 0.05


def slow_program(folder):
    """One that never ends, and writes its number and its folder."""
    path = folder / "slow"
    path.write_text('#!/bin/sh\necho "$$ $(dirname "$2")" > ' + str(folder / "slow.txt") + "\nexec tail -f /dev/null\n")
    path.chmod(0o755)
    return str(path)


@windowed
def cancelled(found):
    """Esc ends the program, removes its folder and changes nothing."""
    thing, shared = pair()
    shared.data = thing.data
    select(thing, shared)
    settings(scope="SELECTED")
    bpy.context.preferences.addons["cloudbake_addon"].preferences.program = slow_program(FOLDER)
    before, place = snapshot(), viewport()
    with bpy.context.temp_override(**place):
        assert bpy.ops.cloudbake.bake("INVOKE_DEFAULT") == {"RUNNING_MODAL"}
    yield from until(lambda: (FOLDER / "slow.txt").exists() and (FOLDER / "slow.txt").read_text().endswith("\n"), "the program begins")
    number, folder = (FOLDER / "slow.txt").read_text().strip().split(" ", 1)
    assert pathlib.Path(folder).exists() and pathlib.Path(f"/proc/{number}").exists(), "the program does not run"
    events(place["window"], "ESC")
    yield from until(lambda: not pathlib.Path(f"/proc/{number}").exists(), "the program ends")
    yield from until(lambda: not pathlib.Path(folder).exists(), "its folder goes")
    assert snapshot() == before, "something was changed"


@windowed
def in_the_background(found):
    """Each object alone, one after the other, while the window lives. Undo takes the whole bake back."""
    things = pair()
    select(*things)
    settings(scope="SELECTED", each=True)
    before = snapshot()
    with bpy.context.temp_override(**viewport()):
        bpy.ops.ed.undo_push(message="before")
        assert bpy.ops.cloudbake.bake("INVOKE_DEFAULT") == {"RUNNING_MODAL"}
    assert snapshot() == before, "something was changed before the end"
    progress = sys.modules["cloudbake_addon.settings"].Progress
    assert progress.text.startswith("left, 1 of 2") and progress.share == 0, progress.text
    yield from until(lambda: progress.text.startswith("right, 2 of 2") or len(maps(bpy.data.objects["right"])) == 2, "the second begins")
    yield from until(lambda: len(maps(bpy.data.objects["right"])) == 2, "the last object is baked")
    assert progress.text == "" and progress.share == 0
    for name in ("left", "right"):
        found.cloud([bpy.data.objects[name]])
    with bpy.context.temp_override(**viewport()):
        bpy.ops.ed.undo()
    assert snapshot() == before, "undo left something"


# ---- running them -----------------------------------------------------------------------------------------------------------------------


def prepare():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="cloudbake_addon")
    bpy.context.preferences.addons["cloudbake_addon"].preferences.program = PROGRAM


def steps(chosen):
    """Runs the scenarios. Yields seconds to wait."""
    report = {}
    for name, function in chosen.items():
        found, error = Found(name), None
        try:
            prepare()
            yield from function(found) or ()
        except Exception:  # a scenario that failed is reported, and the next one runs
            error = traceback.format_exc()
        report[name] = {"error": error, "clouds": found.clouds, "files": found.files}
    (FOLDER / ("scenes.json" if bpy.app.background else "windowed.json")).write_text(json.dumps(report))


def tick(iterator):
    try:
        return next(iterator)
    except StopIteration:
        os._exit(0)


def main():
    sys.path.insert(0, ADDONS)
    only = sys.argv[sys.argv.index("--") + 4:]
    table = SCENES if bpy.app.background else WINDOWED
    iterator = steps({name: function for name, function in table.items() if not only or name in only})
    if bpy.app.background:
        list(iterator)
    else:
        bpy.app.timers.register(lambda: tick(iterator), first_interval=0.5, persistent=True)


main()
