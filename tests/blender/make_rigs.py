"""Makes rigs and scenes in Blender, exports each as glTF, and writes what Blender shows as a flat OBJ, its twin.

  blender --background --factory-startup --threads 1 --python tests/blender/make_rigs.py -- FOLDER

For each rig FOLDER gets NAME.glb (or NAME.gltf with its files) and NAME.obj: every mesh as it is posed, in world space, +Y up, with
modifiers, shape keys, bones and instances applied by Blender itself. Objects without volume are left out. FOLDER/rigs.json lists them all.
The same call makes the same files (with more threads, normals differ in their last bits)."""

import json
import math
import pathlib
import random
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from in_blender import bpy, numpy, run
from mathutils import Euler, Matrix, Vector

RIGS = {}


def rig(**settings):
    """Adds a function that builds a scene to the table. Settings: what the export and the twin need."""

    def add(function):
        RIGS[function.__name__] = (function, settings)
        return function

    return add


# ---- parts of scenes --------------------------------------------------------------------------------------------------------------------


def place(thing, location=(0, 0, 0), rotation=(0, 0, 0), scale=(1, 1, 1), parent=None):
    thing.location, thing.rotation_euler, thing.scale, thing.parent = location, Euler(rotation), scale, parent
    return thing


def link(name, data, **where):
    thing = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(thing)
    return place(thing, **where)


def empty(name, **where):
    return link(name, None, **where)


def lump_mesh(name, seed=1, subdivisions=4, stretch=(1, 1, 1)):
    """A closed ball with smooth bumps that the seed chooses."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=subdivisions, radius=1)
    made = bpy.context.object
    mesh = made.data
    bpy.data.objects.remove(made)
    mesh.name = name
    draw = random.Random(seed)
    waves = [(Vector([draw.uniform(-3, 3) for _ in range(3)]), draw.uniform(0, 6), draw.uniform(0.05, 0.15)) for _ in range(4)]
    for vertex in mesh.vertices:
        swell = 1 + sum(high * math.sin(vertex.co.dot(wave) + phase) for wave, phase, high in waves)
        vertex.co = Vector(x * s for x, s in zip(vertex.co * swell, stretch))
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    return mesh


def lump(name, seed=1, subdivisions=4, stretch=(1, 1, 1), **where):
    return link(name, lump_mesh(name, seed, subdivisions, stretch), **where)


def activate(thing):
    bpy.ops.object.select_all(action="DESELECT")
    bpy.context.view_layer.objects.active = thing
    thing.select_set(True)


def armature(name, bones=3, length=1.0, **where):
    """A chain of bones upwards from the origin."""
    thing = link(name, bpy.data.armatures.new(name), **where)
    activate(thing)
    bpy.ops.object.mode_set(mode="EDIT")
    last = None
    for i in range(bones):
        bone = thing.data.edit_bones.new(f"bone {i}")
        bone.head, bone.tail, bone.roll, bone.parent = (0, 0, i * length), (0.1 * i, 0, (i + 1) * length), 0.3 * i, last
        last = bone
    bpy.ops.object.mode_set(mode="OBJECT")
    return thing


def bend(thing, angles=((0.3, 0.1, 0), (0.5, 0, 0.2), (-0.4, 0.3, 0)), scales=(1, 1, 1), move=(0, 0, 0)):
    for bone, angle, scale in zip(thing.pose.bones, angles, scales):
        bone.rotation_mode, bone.rotation_euler, bone.scale = "XYZ", Euler(angle), (scale,) * 3
    thing.pose.bones[0].location = move
    return thing


def skin(mesh, bones, **where):
    """Binds a mesh to the armature's chain: a vertex follows the two bones nearest to its height."""
    place(mesh, parent=bones, **where)
    count = len(bones.data.bones)
    groups = [mesh.vertex_groups.new(name=bone.name) for bone in bones.data.bones]
    local = Matrix.LocRotScale(mesh.location, mesh.rotation_euler, mesh.scale)
    for vertex in mesh.data.vertices:
        height = min(max((local @ vertex.co).z - 0.5, 0), count - 1)
        low = min(int(height), count - 2)
        groups[low].add([vertex.index], 1 - (height - low), "REPLACE")
        groups[low + 1].add([vertex.index], height - low, "REPLACE")
    modifier = mesh.modifiers.new("armature", "ARMATURE")
    modifier.object = bones
    return mesh


def column(name, seed, **where):
    """A lump as long as the chain of three bones, around it."""
    made = lump(name, seed, stretch=(0.7, 0.7, 1.5), **where)
    made.data.transform(Matrix.Translation((0, 0, 1.5)))
    return made


def material(name, colour, image=None):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*colour, 1)
    if image:
        node = made.node_tree.nodes.new("ShaderNodeTexImage")
        node.image = image
        made.node_tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    return made


def checker(name, colour):
    image = bpy.data.images.new(name, 8, 8)
    image.pixels = [x for i in range(64) for x in ((*colour, 1) if (i + i // 8) % 2 else (1, 1, 1, 1))]
    image.pack()
    return image


def add_uvs(mesh, name, scale):
    """Longitude and latitude, with a seam."""
    layer = mesh.uv_layers.new(name=name)
    for loop in mesh.loops:
        co = mesh.vertices[loop.vertex_index].co
        longitude, latitude = math.atan2(co.y, co.x) / math.tau, math.atan2(co.z, math.hypot(co.x, co.y)) / math.pi
        layer.data[loop.index].uv = (scale * (longitude + 0.5), scale * (latitude + 0.5))


def polygon_prism(name, outline, height, **where):
    """A prism with planar faces of many corners, as one closed mesh."""
    count = len(outline)
    points = [(x, y, z) for z in (0, height) for x, y in outline]
    faces = [list(range(count))[::-1], list(range(count, 2 * count))]
    faces += [[i, (i + 1) % count, count + (i + 1) % count, count + i] for i in range(count)]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [], faces)
    return link(name, mesh, **where)


# ---- rigs: transforms -------------------------------------------------------------------------------------------------------------------


@rig()
def moved_turned_scaled():
    lump("far", 1, location=(40, -3, 12), rotation=(0.3, 1.1, -0.7), scale=(2.5, 2.5, 2.5))
    lump("near", 2, subdivisions=3, location=(37, -2, 13), rotation=(1.2, 0, 0.4), scale=(0.8, 0.8, 0.8))


@rig()
def uneven_scale():
    lump("flat", 3, rotation=(0.4, 0.2, 1), scale=(3, 1.5, 0.5))
    lump("needle", 4, subdivisions=3, location=(1, 1, 1), rotation=(1, 1, 0), scale=(0.3, 0.4, 2))


@rig()
def negative_scale():
    lump("one axis", 5, scale=(-1, 1.3, 1), rotation=(0.2, 0.5, 0))
    lump("two axes", 6, subdivisions=3, location=(1.5, 0, 0), scale=(-1, -0.7, 1))
    lump("three axes", 7, subdivisions=3, location=(-1.5, 0.4, 0.3), scale=(-0.8, -0.8, -1.1), rotation=(0, 1, 0))


@rig(export_apply=True)
def mirror_modifier():
    half = lump("half", 8, subdivisions=4, location=(0.9, 0, 0))
    pivot = empty("pivot", rotation=(0, 0, 0.3))
    modifier = half.modifiers.new("mirror", "MIRROR")
    modifier.mirror_object, modifier.use_clip, modifier.use_mirror_merge = pivot, False, False


@rig()
def empties():
    top = empty("top", location=(1, 2, 3), rotation=(0.3, 0, 0.5), scale=(2, 2, 2))
    middle = empty("middle", location=(0, 1, 0), rotation=(0, 1, 0), scale=(0.5, 0.5, 0.5), parent=top)
    low = empty("low", location=(-1, 0, 0.5), rotation=(0.7, 0.2, 0), scale=(1.2, 1.2, 1.2), parent=middle)
    lump("leaf", 9, parent=low, location=(0.3, 0, 0), rotation=(0, 0, 2))
    lump("twig", 10, subdivisions=3, parent=middle, location=(0, -1, 0))


@rig()
def shear():
    stretched = empty("stretched", rotation=(0, 0, 0.4), scale=(2, 0.6, 1))
    turned = empty("turned", rotation=(0.3, 0.8, 0.6), scale=(1, 1.7, 0.9), parent=stretched)
    lump("sheared", 11, parent=turned, rotation=(0.9, 0, 0.2))
    lump("sheared and mirrored", 12, subdivisions=3, parent=turned, location=(0.8, 0.9, 0), rotation=(0, 0.5, 0), scale=(1, -0.8, 1.2))


@rig()
def instances():
    mesh = lump_mesh("shared", 13, subdivisions=3)
    for i in range(4):
        where = (1.3 * i, 0.4 * (i % 2), 0.1 * i)
        link(f"copy {i}", mesh, location=where, rotation=(0.5 * i, 0.2, i), scale=(1, 1 + 0.2 * i, -1 if i == 3 else 1))


@rig()
def collections():
    group = bpy.data.collections.new("group")
    inner = bpy.data.collections.new("inner")
    group.children.link(inner)
    for name, seed, where, home in (("a", 14, (0, 0, 0), group), ("b", 15, (1.2, 0, 0.3), inner)):
        made = lump(name, seed, subdivisions=3, location=where)
        bpy.context.scene.collection.objects.unlink(made)
        home.objects.link(made)
    for i in range(3):
        placed = empty(f"instance {i}", location=(0, 2.1 * i, 0.2 * i), rotation=(0, 0.4 * i, 0.3), scale=(1, 1, 1 + 0.3 * i))
        placed.instance_type, placed.instance_collection = "COLLECTION", group


@rig(scenes=["first", "second"])
def scenes():
    bpy.context.scene.name = "first"
    lump("in the first", 16, subdivisions=3, location=(1, 0, 0))
    second = bpy.data.scenes.new("second")
    bpy.context.window.scene = second
    lump("in the second", 17, subdivisions=4, rotation=(1, 0, 0), scale=(1, 2, 1))
    lump("also in the second", 18, subdivisions=3, location=(0, 2, 0.4))
    bpy.context.window.scene = bpy.data.scenes["first"]


@rig()
def zero_scale():
    lump("whole", 19)
    lump("gone", 20, subdivisions=3, location=(3, 0, 0), scale=(0, 0, 0))
    lump("flat as paper", 21, subdivisions=3, location=(0, 4, 0), scale=(1, 1, 0))


# ---- rigs: skins ------------------------------------------------------------------------------------------------------------------------


@rig()
def skin_bent():
    skin(column("cloud", 22), bend(armature("rig")))


@rig()
def skin_moved():
    skin(column("cloud", 23), bend(armature("rig", location=(5, -2, 1)), move=(0.3, 0.2, 0.1)))


@rig()
def skin_scaled():
    skin(column("cloud", 24), bend(armature("rig", scale=(3, 3, 3)), scales=(1, 0.8, 1.3)))


@rig()
def skin_turned():
    skin(column("cloud", 25, location=(0.2, 0, 0.1)), bend(armature("rig", rotation=(1.2, 0.4, -0.8))))


@rig()
def skin_uneven_scale():
    skin(column("cloud", 26), bend(armature("rig", rotation=(0.2, 0.5, 0), scale=(1.5, 0.7, 1.2))))


@rig()
def skin_mirrored():
    skin(column("cloud", 27), bend(armature("rig", scale=(-1, 1.2, 1), rotation=(0, 0.3, 0))))


@rig()
def skin_nested():
    holder = empty("holder", location=(1, 1, 0), rotation=(0, 0.4, 0))
    outer = bend(armature("outer", bones=2, rotation=(0.3, 0, 0.2), scale=(1.4, 1.4, 1.4), parent=holder))
    inner = bend(armature("inner", location=(0.3, 0, 0.2), rotation=(0, 0.5, 0), parent=outer))
    inner.parent_type, inner.parent_bone = "BONE", "bone 1"
    skin(column("cloud", 28), inner)


@rig()
def skins_two():
    skin(column("left", 29), bend(armature("left rig", location=(-1, 0, 0))))
    skin(column("right", 30), bend(armature("right rig", location=(1, 0.3, 0), rotation=(0, 0, 2)), scales=(1.1, 1, 0.9)))
    lump("without a skin", 31, subdivisions=3, location=(0, 1, 3))


@rig(export_apply=False)
def skin_and_morph():
    cloud = column("cloud", 32)
    cloud.shape_key_add(name="Basis")
    key = cloud.shape_key_add(name="swollen")
    for point in key.data:
        point.co = (point.co.x * 1.3, point.co.y, point.co.z + 0.1 * point.co.x)
    key.value = 0.6
    skin(cloud, bend(armature("rig", location=(0, 1, 0))))


@rig(export_animations=True, frame=10)
def skin_animated():
    bones = bend(armature("rig"))
    pose = bones.pose.bones[1]
    for frame, angle in ((1, 0), (20, 1.5)):
        pose.rotation_euler.x = angle
        pose.keyframe_insert("rotation_euler", frame=frame)
    skin(column("cloud", 33), bones)
    bpy.context.scene.frame_end = 20


# ---- rigs: what meshes carry ------------------------------------------------------------------------------------------------------------


@rig()
def unicode_names():
    top = empty("Wölkchen \u2601", rotation=(0.2, 0, 0))
    made = lump("雲の塊", 34, parent=top, location=(0, 0, 1))
    made.data.materials.append(material("Белый \U0001f325", (1, 1, 1)))
    lump("‮עָנָן 'quoted' \"twice\" / \\", 35, subdivisions=3, parent=top, location=(1, 0, 0))


@rig()
def uv_sets():
    made = lump("three sets", 36)
    for name, scale in (("first", 1), ("second", 2.5), ("third", -1)):
        add_uvs(made.data, name, scale)
    other = lump("one set", 37, subdivisions=3, location=(1.1, 0.2, 0))
    add_uvs(other.data, "only", 1)


@rig()
def vertex_colours():
    made = lump("painted", 38)
    for name, domain in (("per corner", "CORNER"), ("per point", "POINT")):
        layer = made.data.color_attributes.new(name=name, type="BYTE_COLOR" if domain == "CORNER" else "FLOAT_COLOR", domain=domain)
        for i, element in enumerate(layer.data):
            element.color = (i % 7 / 6, i % 5 / 4, i % 3 / 2, 1)


@rig(export_apply=False)
def morphs():
    made = lump("two keys", 39, rotation=(0.3, 0, 0), scale=(1, 1.5, 1))
    made.shape_key_add(name="Basis")
    for name, stretch, value in (("tall", (1, 1, 1.8), 0.7), ("wide", (1.5, 1, 1), 0.25), ("unused", (3, 3, 3), 0)):
        key = made.shape_key_add(name=name)
        for point in key.data:
            point.co = [x * s for x, s in zip(point.co, stretch)]
        key.value = value


@rig()
def materials():
    made = lump("four colours", 40, scale=(1, 1, 1.4))
    for i in range(4):
        made.data.materials.append(material(f"colour {i}", (i / 3, 0.5, 1 - i / 3)))
    for polygon in made.data.polygons:
        polygon.material_index = (int(polygon.center.z * 3) + 30) % 4


@rig(export_format="GLTF_SEPARATE")
def textures():
    made = lump("textured", 41, rotation=(0, 0.3, 0))
    add_uvs(made.data, "map", 1)
    made.data.materials.append(material("checked", (1, 1, 1), checker("red squares", (1, 0, 0))))
    other = lump("also textured", 42, subdivisions=3, location=(1, 0.4, 0.2))
    add_uvs(other.data, "map", 3)
    other.data.materials.append(material("checked too", (1, 1, 1), checker("blue squares", (0, 0, 1))))


@rig(polygons=True)
def polygons():
    star = [((1 if i % 2 else 0.45) * math.cos(math.pi * i / 7), (1 if i % 2 else 0.45) * math.sin(math.pi * i / 7)) for i in range(14)]
    polygon_prism("star", star, 0.8, rotation=(0.4, 0.2, 0))
    bpy.ops.mesh.primitive_cube_add(size=0.9, location=(0.2, 0.1, 0.9), rotation=(0.1, 0.5, 0.3))
    corners = [(math.cos(2 * math.pi * i / 12) * 0.5, math.sin(2 * math.pi * i / 12) * 0.8) for i in range(12)]
    polygon_prism("drum", corners, 1, location=(-0.9, 0, 0), rotation=(0.9, 0, 1))


@rig(export_apply=True)
def text_and_curve():
    text = link("text", bpy.data.curves.new("text", "FONT"), rotation=(1.5, 0, 0.2))
    text.data.body, text.data.extrude, text.data.resolution_u = "oO", 0.2, 3
    activate(text)
    bpy.ops.object.convert(target="MESH")
    curve = bpy.data.curves.new("tube", "CURVE")
    curve.dimensions, curve.bevel_depth, curve.bevel_resolution, curve.use_fill_caps = "3D", 0.2, 2, True
    line = curve.splines.new("POLY")
    line.points.add(5)
    for i, point in enumerate(line.points):
        point.co = (math.cos(i), math.sin(i), 0.3 * i, 1)
    link("tube", curve, location=(0.5, 0, 0.9))


@rig()
def joined_spheres():
    draw = random.Random(43)
    for i in range(5):
        lump(f"ball {i}", 50 + i, subdivisions=3, location=[draw.uniform(-0.9, 0.9) for _ in range(3)], scale=(draw.uniform(0.6, 1),) * 3)
    bpy.ops.object.select_all(action="SELECT")
    bpy.context.view_layer.objects.active = bpy.data.objects["ball 0"]
    bpy.ops.object.join()


@rig()
def head():
    """Blender's monkey, which has holes. Made of triangles, because Blender may cut a bent quad one way for the export and another way for
    itself."""
    bpy.ops.mesh.primitive_monkey_add(rotation=(0.2, 0.1, 0.5))
    bpy.context.object.modifiers.new("triangles", "TRIANGULATE")
    bpy.ops.object.modifier_apply(modifier="triangles")


@rig()
def on_a_bone():
    """A lump that hangs on a bone without a skin."""
    bones = bend(armature("crane", bones=2, rotation=(0, 0.3, 0)))
    made = lump("load", 44, parent=bones, location=(0, 0.4, 0), rotation=(0.3, 0, 0), scale=(1, 0.7, 1))
    made.parent_type, made.parent_bone = "BONE", "bone 1"


@rig()
def sheet():
    """Encloses nothing: to be refused."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=6, y_subdivisions=6, rotation=(0.3, 0.1, 0))


# ---- the twin, and the export -----------------------------------------------------------------------------------------------------------


def write_twin(path, scene, keep_polygons):
    """Every mesh of the evaluated scene in world space, as OBJ, +Y up."""
    bpy.context.window.scene = scene
    graph = bpy.context.evaluated_depsgraph_get()
    lines, base = [], 1
    for instance in graph.object_instances:
        thing = instance.object
        if thing.type != "MESH":  # the surface of a curve or a text comes as a mesh of its own
            continue
        matrix = numpy.array(instance.matrix_world, dtype=float)
        side = numpy.linalg.det(matrix[:3, :3])
        if side == 0:
            continue
        mesh = thing.to_mesh()
        mesh.calc_loop_triangles()
        points = numpy.array([v.co for v in mesh.vertices], dtype=float) @ matrix[:3, :3].T + matrix[:3, 3]
        lines.append(f"o part {base}")
        lines += [f"v {x:.9g} {z:.9g} {-y:.9g}" for x, y, z in points]
        faces = [list(p.vertices) for p in (mesh.polygons if keep_polygons else mesh.loop_triangles)]
        lines += ["f " + " ".join(str(base + i) for i in (face if side > 0 else face[::-1])) for face in faces]
        base += len(points)
        thing.to_mesh_clear()
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def make(folder, name):
    """Builds a rig, writes its files, and returns an entry for each scene that is to be baked."""
    function, settings = RIGS[name]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    function()
    bpy.context.scene.frame_set(settings.get("frame", bpy.context.scene.frame_current))
    bpy.context.view_layer.update()

    # The twins come first, because an export of animations moves bones.
    file_format = settings.get("export_format", "GLB")
    file = name + (".glb" if file_format == "GLB" else ".gltf")
    shown, entries = bpy.context.scene, []
    for number, scene in enumerate(settings.get("scenes", [shown.name])):
        twin = name + (f".{number}" if "scenes" in settings else "") + ".obj"
        write_twin(folder / twin, bpy.data.scenes[scene], settings.get("polygons", False))
        entries.append({"name": name if number == 0 else f"{name}.{number}", "file": file, "twin": twin, "scene": number})

    bpy.context.window.scene = shown
    bpy.ops.export_scene.gltf(filepath=str(folder / file), export_format=file_format, export_apply=settings.get("export_apply", False),
                              export_animations=settings.get("export_animations", False), export_current_frame=True)
    return entries


def main():
    folder = pathlib.Path(sys.argv[sys.argv.index("--") + 1])
    folder.mkdir(parents=True, exist_ok=True)
    entries = [entry for name in RIGS for entry in make(folder, name)]
    (folder / "rigs.json").write_text(json.dumps(entries, indent=1) + "\n")
    print(f"{len(RIGS)} rigs, {len(entries)} scenes in {folder}")


if __name__ == "__main__":
    run(main)
