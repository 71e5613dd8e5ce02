"""Objects of the scene in and out: their triangles in scene space, and the lobes in their UV maps."""

import hashlib
import json

import bpy
import numpy

from . import engine
from .engine import BakeError
from .nodes import MAPS

MAX_UV_MAPS = 8  # Blender's own limit
KEPT_D = 6e-4    # of a smaller mean d, 1 - d in 32 bits keeps less than four digits

# From Blender's axes to glTF's: (x, z, -y). Its inverse is its transpose.
AXES = numpy.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], dtype=float)


class Part:
    """An object of a cloud. points: #V×3 in scene space with glTF's axes. linear: the 3×3 part of the object's matrix."""

    def __init__(self, thing, linear, points, triangles):
        self.thing_name, self.linear, self.points, self.triangles = thing.name, linear, points, triangles

    @property
    def thing(self):
        """By name, because references do not survive changes of the file while a bake runs."""
        thing = bpy.data.objects.get(self.thing_name)
        if thing is None or thing.type != "MESH" or len(thing.data.vertices) != len(self.points):
            raise BakeError(f"'{self.thing_name}' was changed while it was baked: bake it again")
        return thing


class Cloud:
    """What is baked in one run: its parts occlude each other."""

    def __init__(self, name, parts, shape, options):
        self.name, self.parts, self.shape, self.options = name, parts, shape, options
        counts = [len(part.points) for part in parts]
        self.starts = numpy.cumsum([0] + counts)
        self.points = numpy.concatenate([part.points for part in parts]).astype(numpy.float32)
        self.triangles = numpy.concatenate([part.triangles + start for part, start in zip(parts, self.starts)])

    def key(self):
        """Tells apart which objects were baked together."""
        text = json.dumps(self.options, sort_keys=True).encode()
        return hashlib.sha1(self.points.tobytes() + self.triangles.tobytes() + text).hexdigest()

    def start(self, program):
        return engine.start(self.points, self.triangles, self.options, program, self.name)


# ---- from the scene to triangles --------------------------------------------------------------------------------------------------------


def table(elements, name, width, kind):
    flat = numpy.empty(len(elements) * width, kind)
    elements.foreach_get(name, flat)
    return flat.reshape(-1, width)


def triangles_of(mesh):
    mesh.calc_loop_triangles()
    return table(mesh.loop_triangles, "vertices", 3, numpy.int32)


def same_topology(mesh, other):
    if len(mesh.vertices) != len(other.vertices) or len(mesh.loops) != len(other.loops) or len(mesh.polygons) != len(other.polygons):
        return False
    return all(numpy.array_equal(table(a, name, 1, numpy.int32), table(b, name, 1, numpy.int32))
               for a, b, name in ((mesh.loops, other.loops, "vertex_index"), (mesh.polygons, other.polygons, "loop_total")))


def shape_of(thing, depsgraph, use_base):
    """Points in the object's own space and triangles, as its modifiers show them or without modifiers."""
    if use_base:
        return table(thing.data.vertices, "co", 3, numpy.float32), triangles_of(thing.data)
    evaluated = thing.evaluated_get(depsgraph)
    try:
        mesh = evaluated.to_mesh()
        if not same_topology(thing.data, mesh):
            names = ", ".join(f"'{modifier.name}'" for modifier in thing.modifiers if modifier.show_viewport)
            raise BakeError(f"modifiers of '{thing.name}' make new vertices ({names}): apply them, switch them off, or choose to bake "
                            "the base mesh")
        return table(mesh.vertices, "co", 3, numpy.float32), triangles_of(mesh)
    finally:
        evaluated.to_mesh_clear()


def part_of(thing, depsgraph, use_base):
    matrix = numpy.array(thing.evaluated_get(depsgraph).matrix_world, dtype=float)
    linear = matrix[:3, :3]
    sizes = numpy.linalg.svd(linear, compute_uv=False)
    if not sizes[2] > 1e-6 * sizes[0]:
        raise BakeError(f"'{thing.name}' has a scale of 0: lobes cannot be stored in its space")
    points, triangles = shape_of(thing, depsgraph, use_base)
    if len(triangles) == 0:
        raise BakeError(f"'{thing.name}' has no faces")
    if numpy.linalg.det(linear) < 0:  # a mirrored object shows its triangles the other way round
        triangles = triangles[:, ::-1]
    return Part(thing, linear, (points @ linear.T + matrix[:3, 3]) @ AXES.T, triangles)


def check_objects(things, depsgraph):
    """Refuses what cannot hold lobes of its own, before anything is baked."""
    if not things:
        raise BakeError("there is no mesh to bake: select one, or choose a collection that has some")
    chosen = {thing.name for thing in things}
    for thing in things:
        mesh = thing.data
        if thing.library or mesh.library:
            raise BakeError(f"'{thing.name}' is linked from another file: make it local first")
        if thing.mode != "OBJECT":
            raise BakeError(f"'{thing.name}' is being edited: change to object mode first")
        if other_maps(mesh) + 2 > MAX_UV_MAPS:
            raise BakeError(f"'{thing.name}' has {other_maps(mesh)} UV maps, and Blender allows {MAX_UV_MAPS}: lobes need two, so "
                            f"delete {other_maps(mesh) + 2 - MAX_UV_MAPS}")
        for name in MAPS:
            if name in mesh.attributes and name not in mesh.uv_layers:
                raise BakeError(f"'{thing.name}' has another attribute named '{name}': rename it")
    for instance in depsgraph.object_instances:
        if instance.is_instance and instance.parent and instance.parent.original.name in chosen:
            raise BakeError(f"'{instance.parent.original.name}' makes instances, which cannot hold lobes of their own: make them real "
                            f"first (Object > Apply > Make Instances Real)")


def other_maps(mesh):
    return sum(layer.name not in MAPS for layer in mesh.uv_layers)


def meshes_of(things, view_layer):
    """The visible meshes among objects, and words about what is left out. Other shapes are refused."""
    meshes, hidden = [], []
    for thing in things:
        if thing.type in ("LIGHT", "CAMERA", "SPEAKER", "LIGHT_PROBE", "ARMATURE", "LATTICE") or \
                thing.type == "EMPTY" and thing.instance_type == "NONE":
            continue
        if not thing.visible_get(view_layer=view_layer):
            hidden.append(thing.name)
        elif thing.type == "EMPTY":
            raise BakeError(f"'{thing.name}' makes instances, which cannot hold lobes of their own: make them real first "
                            "(Object > Apply > Make Instances Real)")
        elif thing.type != "MESH":
            raise BakeError(f"'{thing.name}' is not a mesh: convert it first (Object > Convert > Mesh)")
        else:
            meshes.append(thing)
    return meshes, [f"hidden objects are left out: {', '.join(hidden)}"] if hidden else []


def make_cloud(name, things, depsgraph, use_base, options):
    parts = [part_of(thing, depsgraph, use_base) for thing in things]
    return Cloud(name, parts, "base" if use_base else "evaluated", options)


# ---- from lobes to UV maps --------------------------------------------------------------------------------------------------------------


def local_lobes(lobes, linear):
    """v = M⁻¹(o·d) in the object's own space with glTF's axes, o' = v/‖v‖, d' = ‖v‖; with d = 0, o' is M⁻¹o normalised."""
    into = AXES @ numpy.linalg.inv(linear) @ AXES.T
    moved = lobes[:, :3].astype(float) @ into.T
    length = numpy.linalg.norm(moved, axis=1, keepdims=True)
    return numpy.hstack([moved / numpy.where(length > 0, length, 1), length * lobes[:, 3:]])


def lobe_layers(mesh):
    """The two UV maps beside each other, which are made if needed. Making one moves the others in memory."""
    names = [layer.name for layer in mesh.uv_layers]
    if not (set(MAPS) <= set(names) and names.index(MAPS[1]) == names.index(MAPS[0]) + 1):
        for name in MAPS:
            if name in mesh.uv_layers:
                mesh.uv_layers.remove(mesh.uv_layers[name])
        for name in MAPS:
            mesh.uv_layers.new(name=name, do_init=False)
    return [mesh.uv_layers[name] for name in MAPS]


def store_lobes(mesh, lobes):
    """lobes: #V×4 in the mesh's space with glTF's axes. The maps are what a glTF importer makes of the asset: it stores 1 - v."""
    corners = lobes[table(mesh.loops, "vertex_index", 1, numpy.int32)[:, 0]]
    for layer, pair in zip(lobe_layers(mesh), (corners[:, :2], corners[:, 2:])):
        layer.data.foreach_set("uv", numpy.column_stack([pair[:, 0], 1 - pair[:, 1]]).astype(numpy.float32).ravel())
    mesh.update()


def set_info(mesh, info, **more):
    """What an export writes into asset.extras.cloudbake, and how the mesh was baked."""
    mesh["cloudbake"] = json.dumps({"asset": info, **more})


def get_info(mesh):
    """None if the mesh is not baked."""
    try:
        return json.loads(mesh["cloudbake"])
    except (KeyError, ValueError, TypeError):
        return None


def own_mesh(thing):
    """Gives an object a mesh of its own, because its lobes fit no other object. Returns words about it."""
    others = [other.name for other in bpy.data.objects if other.data == thing.data and other != thing]
    if not others:
        return []
    thing.data = thing.data.copy()
    return [f"'{thing.name}' shared its mesh with {len(others)} more and has its own now"]


def store_cloud(cloud, baked):
    """Writes the lobes of all parts, or makes an object of a new mesh. Returns the objects and words for the user."""
    more = {"bake": cloud.key(), "objects": len(cloud.parts), "shape": cloud.shape}
    words = [f"{cloud.name}: {warning}" for warning in baked.warnings]
    if baked.vertices is not None:
        return [new_object(cloud, baked, more)], words + [f"{cloud.name}: the options made a new mesh, which is an object of its own"]
    things = [part.thing for part in cloud.parts]
    for part, thing, start in zip(cloud.parts, things, cloud.starts):
        words += own_mesh(thing)
        lobes = local_lobes(baked.lobes[start:start + len(part.points)], part.linear)
        store_lobes(thing.data, lobes)
        set_info(thing.data, baked.info, **more)
        if lobes[:, 3].mean() < KEPT_D:
            words.append(f"'{thing.name}' is so small that its UV maps keep few digits of d: make it larger")
    return things, words


def new_object(cloud, baked, more):
    mesh = bpy.data.meshes.new(f"{cloud.name} cloud")
    mesh.from_pydata((baked.vertices @ AXES).tolist(), [], baked.triangles.tolist())
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    store_lobes(mesh, baked.lobes.astype(float))
    set_info(mesh, baked.info, **{**more, "objects": 1})
    thing = bpy.data.objects.new(mesh.name, mesh)
    bpy.data.objects[cloud.parts[0].thing_name].users_collection[0].objects.link(thing)
    return thing
