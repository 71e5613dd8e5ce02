"""Objects of the scene in and out: their triangles in scene space, and the lobes in their UV maps."""

import collections
import hashlib
import json

import bpy
import numpy

from . import engine, kept, state
from .engine import BakeError
from .nodes import CONSTANTS_KEY, MAPS

MAX_UV_MAPS = 8  # Blender's own limit
KEPT_D = 6e-4    # of a smaller mean d, 1 - d in 32 bits keeps less than four digits

# From Blender's axes to glTF's: (x, z, -y). Its inverse is its transpose.
AXES = numpy.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], dtype=float)


class Part:
    """An object of a cloud. shape: of shape_of. matrix: the object's, 4×4. now: of state_of. points: #V×3 in scene space with glTF's
    axes. The triangles face outwards there, also if the object is mirrored."""

    def __init__(self, thing, shape, matrix, now):
        self.thing_name, self.shape, self.matrix, self.state, self.linear = thing.name, shape, matrix, now, matrix[:3, :3]
        self.points = (shape.points @ self.linear.T + matrix[:3, 3]) @ AXES.T
        self.triangles = shape.triangles[:, ::-1] if numpy.linalg.det(self.linear) < 0 else shape.triangles

    def thing(self, depsgraph):
        """By name, because references do not survive changes of the file while a bake runs."""
        thing = bpy.data.objects.get(self.thing_name)
        if thing is None or thing.type != "MESH" or shape_of(thing, depsgraph, self.shape.is_base).hash() != self.shape.hash():
            raise BakeError(f"'{self.thing_name}' was changed while it was baked: bake it again")
        return thing


class Shape:
    """Points in an object's own space and triangles. is_base: without modifiers and shape keys. is_new: its vertices are not the mesh's."""

    def __init__(self, points, triangles, is_base=False, is_new=False):
        self.points, self.triangles, self.is_base, self.is_new = points, triangles, is_base, is_new

    def hash(self):
        return state.hash_of(self.points, self.triangles)


class Cloud:
    """What is baked in one run: its parts occlude each other."""

    def __init__(self, name, parts, options):
        self.name, self.parts, self.options = name, parts, options
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
    """As its modifiers and shape keys show it, or without them."""
    if use_base:
        return Shape(table(thing.data.vertices, "co", 3, numpy.float32), triangles_of(thing.data), is_base=True)
    evaluated = thing.evaluated_get(depsgraph)
    try:
        mesh = evaluated.to_mesh()
        return Shape(table(mesh.vertices, "co", 3, numpy.float32), triangles_of(mesh), is_new=not same_topology(thing.data, mesh))
    finally:
        evaluated.to_mesh_clear()


def part_of(thing, depsgraph, use_base):
    matrix = numpy.array(thing.evaluated_get(depsgraph).matrix_world, dtype=float)
    sizes = numpy.linalg.svd(matrix[:3, :3], compute_uv=False)
    if not sizes[2] > 1e-6 * sizes[0]:
        raise BakeError(f"'{thing.name}' has a scale of 0: lobes cannot be stored in its space. Give it another scale")
    shape = shape_of(thing, depsgraph, use_base)
    if len(shape.triangles) == 0:
        raise BakeError(f"'{thing.name}' has no faces{why_empty(thing, use_base)}: leave it out, or give it some")
    return Part(thing, shape, matrix, state.state_of(thing, depsgraph.scene.frame_current))


def why_empty(thing, use_base):
    names = ", ".join(f"'{modifier.name}'" for modifier in thing.modifiers if modifier.show_viewport)
    return f" behind its modifiers ({names})" if len(thing.data.polygons) and names and not use_base else ""


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
            raise BakeError(makes_instances(instance.parent.original))


def makes_instances(thing):
    """The words of a refusal, with what makes the instances."""
    makers = [f"particle system '{system.name}'" for system in thing.particle_systems]
    makers += [f"modifier '{modifier.name}'" for modifier in thing.modifiers if modifier.type == "NODES" and modifier.show_viewport]
    if thing.instance_type == "COLLECTION":
        makers = [f"collection '{thing.instance_collection.name}'" if thing.instance_collection else "a collection"]
    elif thing.instance_type != "NONE":
        makers = [f"instancing on {'vertices' if thing.instance_type == 'VERTS' else 'faces'}"]
    return (f"'{thing.name}' makes instances ({' or '.join(makers) or 'an add-on'}), which cannot hold lobes of their own: make them real "
            "first (Object > Apply > Make Instances Real)")


def other_maps(mesh):
    return sum(layer.name not in MAPS for layer in mesh.uv_layers)


def meshes_of(things, view_layer, to_bake):
    """The visible meshes among objects, and words about what is left out. Other shapes are refused. Of an object whose modifiers were
    applied to a copy, the object is baked, and the copy is what is baked already."""
    meshes, hidden = [], []
    applied = {source_of(thing) for thing in things} - {None}
    for thing in things:
        if thing.type in ("LIGHT", "CAMERA", "SPEAKER", "LIGHT_PROBE", "ARMATURE", "LATTICE") or \
                thing.type == "EMPTY" and thing.instance_type == "NONE":
            continue
        if not thing.visible_get(view_layer=view_layer):
            hidden += [thing.name] if thing not in applied else []
        elif thing.type == "EMPTY":
            raise BakeError(makes_instances(thing))
        elif thing.type != "MESH":
            raise BakeError(f"'{thing.name}' is not a mesh: convert it first (Object > Convert > Mesh)")
        else:
            meshes.append(thing)
    if to_bake:
        meshes = [thing for thing in meshes if source_of(thing) not in meshes]
    else:
        meshes = list(dict.fromkeys(thing if get_info(thing.data) else copy_of(thing) or thing for thing in meshes))
    return meshes, [f"hidden objects are left out: {', '.join(hidden)}"] if hidden else []


def make_cloud(name, things, depsgraph, use_base, options):
    return Cloud(name, [part_of(thing, depsgraph, use_base) for thing in things], options)


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
    mesh[CONSTANTS_KEY] = constants_of(info)


def constants_of(info):
    return [float(info[name]) for name in ("exponent", "bias", "extinction")]


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


SOURCE_KEY = "cloudbake_source"  # of an object whose mesh is what the modifiers of another made


def source_of(thing):
    """The object whose modifiers made this one's mesh; None if there is none or it is gone."""
    source = thing.get(SOURCE_KEY)
    return source if isinstance(source, bpy.types.Object) and source.name in bpy.data.objects else None


def copy_of(thing):
    """The object whose mesh is what this one's modifiers made; None without one."""
    return next((other for other in bpy.data.objects if source_of(other) == thing), None)


def evaluated_mesh(thing, depsgraph):
    """A new mesh with the vertices that modifiers and shape keys give, and all that the object's own mesh has."""
    mesh = bpy.data.meshes.new_from_object(thing.evaluated_get(depsgraph), preserve_all_data_layers=True, depsgraph=depsgraph)
    for key in thing.data.keys():
        if key not in kept.OWN:
            mesh[key] = thing.data[key]
    return mesh


def applied_copy(thing, depsgraph):
    """An object beside another, which is hidden: a copy whose modifiers are applied, because they make vertices of their own, which the
    object's mesh cannot hold lobes for. A later bake renews it. Returns the copy and words."""
    mesh, names = evaluated_mesh(thing, depsgraph), [modifier.name for modifier in thing.modifiers if modifier.show_viewport]
    copy = copy_of(thing)
    if copy is None:
        copy = thing.copy()
        copy.name, copy.data, copy[SOURCE_KEY] = f"{thing.name} baked", mesh, thing
        copy.modifiers.clear()
        if copy.animation_data:
            for curve in [curve for curve in copy.animation_data.drivers if curve.data_path.startswith("modifiers[")]:
                copy.animation_data.drivers.remove(curve)
        for collection in thing.users_collection:
            collection.objects.link(copy)
    else:
        old, copy.data, copy.matrix_world = copy.data, mesh, thing.matrix_world
        bpy.data.meshes.remove(old)
    mesh.name = f"{thing.data.name} baked"
    view_layer = bpy.context.view_layer
    if view_layer.objects.active == thing:
        view_layer.objects.active = copy
    copy.select_set(thing.select_get())
    thing.hide_set(True)
    thing.hide_render = True
    return copy, [f"modifiers of '{thing.name}' make new vertices ({', '.join(names)}): '{copy.name}' is a copy with them applied, which "
                  f"has the lobes; '{thing.name}' is hidden"]


def store_cloud(cloud, baked, depsgraph):
    """Writes the lobes of all parts, or makes an object of a new mesh. Returns the objects and words for the user."""
    more = {"bake": cloud.key(), "objects": len(cloud.parts)}
    words = [f"{cloud.name}: {warning}" for warning in baked.warnings]
    if baked.vertices is not None:
        return [new_object(cloud, baked, more)], words + [f"{cloud.name}: the options made a new mesh, which is an object of its own"]
    things = []
    for number, (part, thing, start) in enumerate(zip(cloud.parts, [part.thing(depsgraph) for part in cloud.parts], cloud.starts)):
        source = part.state if part.shape.is_new else (get_info(thing.data) or {}).get("source")
        thing, told = applied_copy(thing, depsgraph) if part.shape.is_new else (thing, own_mesh(thing))
        lobes = local_lobes(baked.lobes[start:start + len(part.points)], part.linear)
        store_lobes(thing.data, lobes)
        set_info(thing.data, baked.info, **more, **record_of(part), part=number, source=source)
        things.append(thing)
        words += told
        if lobes[:, 3].mean() < KEPT_D:
            words.append(f"'{thing.name}' is so small that its UV maps keep few digits of d: make it larger")
    return things, words


def record_of(part):
    """What was baked, so that an export can say what has changed since."""
    return {"base": part.shape.is_base, "points": part.shape.hash(), "state": part.state, "matrix": part.matrix.tolist()}


def new_object(cloud, baked, more):
    mesh = bpy.data.meshes.new(f"{cloud.name} cloud")
    mesh.from_pydata((baked.vertices @ AXES).tolist(), [], baked.triangles.tolist())
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    store_lobes(mesh, baked.lobes.astype(float))
    set_info(mesh, baked.info, **{**more, "objects": 1})  # without a shape: an export takes the mesh as it is
    thing = bpy.data.objects.new(mesh.name, mesh)
    bpy.data.objects[cloud.parts[0].thing_name].users_collection[0].objects.link(thing)
    return thing


# ---- what has changed since the bake ----------------------------------------------------------------------------------------------------


def check_unchanged(thing, depsgraph):
    """Refuses an object whose shape is not the one that was baked, and names the cause."""
    info = get_info(thing.data)
    if "points" not in info:  # of an older add-on, or of new vertices
        if info.get("shape") != "base" and shape_of(thing, depsgraph, False).is_new:
            raise BakeError(f"the modifiers of '{thing.name}' make other vertices than were baked: bake it again")
        return
    frame, source = depsgraph.scene.frame_current, source_of(thing)
    words = state.changes({**info["source"], "frame": frame}, state.state_of(source, frame)) if source and info["source"] else []
    if words:
        raise BakeError(f"'{source.name}' has changed since its bake: {'; '.join(words)}. Show it and bake it again, or delete it to keep "
                        f"'{thing.name}' as it is")
    if shape_of(thing, depsgraph, info["base"]).hash() == info["points"]:
        return
    words = [] if source else state.changes(info["state"], state.state_of(thing, frame))
    used = [f"'{modifier.object.name}'" for modifier in thing.modifiers if getattr(modifier, "object", None)]
    cause = "; ".join(words) or (f"its mesh was edited, or something that its modifiers use ({', '.join(used)})" if used else
                                 "its mesh was edited")
    raise BakeError(f"'{thing.name}' has another shape than it was baked with: {cause}. Bake it again, or undo the change")


def bakes_of(things):
    """The objects of each bake. Duplicates of baked objects are bakes of their own, because they shade nothing."""
    groups: dict[tuple, list] = {}
    seen: collections.Counter = collections.Counter()
    for thing in things:
        info = get_info(thing.data)
        part = info["bake"], info.get("part", thing.name)
        groups.setdefault((info["bake"], seen[part]), []).append(thing)
        seen[part] += 1
    return list(groups.values())


def check_places(things, depsgraph):
    """Refuses objects that were baked together and then moved apart: each has the shade of the others in its lobes."""
    for group in bakes_of(things):
        moves = [(thing.name, numpy.array(thing.evaluated_get(depsgraph).matrix_world, dtype=float) @ numpy.linalg.inv(matrix))
                 for thing in group if (matrix := get_info(thing.data).get("matrix")) is not None]
        for (first, usual), (name, move) in zip(moves, moves[1:]):
            if numpy.abs(move - usual).max() > 1e-4 * max(1.0, numpy.abs(usual).max()):
                raise BakeError(f"'{first}' and '{name}' were baked together and shade each other, but one was moved since: bake them "
                                "again, or move them back")
