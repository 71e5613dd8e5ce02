"""A scene of six clouds as an artist leaves it: two materials on one object, image textures, a rig, shape keys, a subdivision surface,
objects that share a mesh, custom properties, parents and collections. And the facts of a scene, for comparison."""

import hashlib
import math

import numpy

from in_blender import bpy
from make_rigs import empty, link
from mathutils import Euler, Matrix, Vector

CLOUDS = ("two materials", "skinned", "keyed", "divided", "duplicate", "child")


def ball(name, width, height, depth, maps=(), subdivisions=3):
    """A lump of three balls that were pushed into each other, with UV maps."""
    import bmesh
    mesh, form = bpy.data.meshes.new(name), bmesh.new()
    bmesh.ops.create_icosphere(form, subdivisions=subdivisions, radius=1, calc_uvs=False)
    for vertex in form.verts:
        x, y, z = vertex.co
        bump = 1 + 0.18 * math.sin(3.1 * x + width) * math.sin(2.7 * y + 1) + 0.12 * math.sin(4.3 * z + depth)
        vertex.co = Vector((width * x, depth * y, height * z)) * bump
    form.to_mesh(mesh)
    form.free()
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    points = [mesh.vertices[loop.vertex_index].co for loop in mesh.loops]
    for number, map_name in enumerate(maps):
        layer = mesh.uv_layers.new(name=map_name)
        layer.data.foreach_set("uv", [value for p in points for value in (0.5 + (0.3 + 0.2 * number) * p.x, 0.5 + 0.3 * p.z)])
    return mesh


def picture(name, low, high, size=16):
    """An image with a pattern, in the file."""
    image = bpy.data.images.new(name, size, size)
    rows = [list(high if (x // 4 + y // 4) % 2 else low) + [1] for y in range(size) for x in range(size)]
    image.pixels = [value for row in rows for value in row]
    image.pack()
    return image


def painted(name, image, uv_map=None, roughness=0.8):
    """A material with a texture, read from a UV map of that name or from the one that renders show."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Roughness"].default_value = roughness
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    if uv_map:
        read = tree.nodes.new("ShaderNodeUVMap")
        read.uv_map = uv_map
        tree.links.new(read.outputs["UV"], texture.inputs["Vector"])
    return material


def colored(name, color):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED").inputs["Base Color"].default_value = color
    return material


def rig():
    """An armature of two bones, of which the upper one is bent."""
    thing = link("rig", bpy.data.armatures.new("rig"), location=(3.2, 0, 0))
    bpy.context.view_layer.objects.active = thing
    bpy.ops.object.mode_set(mode="EDIT")
    low, high = thing.data.edit_bones.new("low"), thing.data.edit_bones.new("high")
    low.head, low.tail = (0, 0, -1.2), (0, 0, 0)
    high.head, high.tail, high.parent = (0, 0, 0), (0, 0, 1.2), low
    bpy.ops.object.mode_set(mode="OBJECT")
    thing.pose.bones["high"].rotation_mode = "XYZ"
    thing.pose.bones["high"].rotation_euler = Euler((0.2, 0, 0.9))
    thing["rig version"] = 3
    return thing


def collection(name, parent):
    made = bpy.data.collections.new(name)
    parent.children.link(made)
    return made


def build():
    """Into an empty file."""
    scene = bpy.context.scene
    scene["mission"], scene["hours"] = "dawn patrol", [5.5, 7.25]
    blue, rust = picture("blue squares", (0.25, 0.45, 0.9), (0.9, 0.95, 1.0)), picture("rust", (0.55, 0.2, 0.08), (1.0, 0.8, 0.5))
    paint, rock = painted("Painted", blue), painted("Rock", rust, "detail", 0.4)
    puff, gold = colored("Puff", (0.9, 0.9, 0.92, 1)), colored("Gold", (1.0, 0.75, 0.3, 1))
    paint["studio id"], rock["weights"] = "mat-7", [1, 2, 3]

    shared = ball("shared lump", 1.2, 0.9, 1.0, ("paint", "detail"))
    shared["triangles wanted"] = 320
    shared.materials.append(paint)
    shared.materials.append(rock)
    middle = [polygon.center.x > 0.1 for polygon in shared.polygons]
    shared.polygons.foreach_set("material_index", list(map(int, middle)))
    shared.uv_layers.active_index, shared.uv_layers["paint"].active_render = 1, True
    two = link("two materials", shared)
    two["hit points"], two["speed"], two["tags"] = 12, 0.75, [1.5, 2.5]
    duplicate = link("duplicate", shared, location=(0, 3.2, 0.3), rotation=(0.3, 0.5, 1.2), scale=(1, 1.2, 0.8))
    duplicate.material_slots[1].link = "OBJECT"
    duplicate.material_slots[1].material = gold

    bones = rig()
    skinned = link("skinned", ball("skin", 0.8, 1.2, 0.8, ("paint",)), parent=bones)
    skinned.data.materials.append(paint)
    for name, sign in (("low", -1), ("high", 1)):
        group = skinned.vertex_groups.new(name=name)
        for vertex in skinned.data.vertices:
            group.add([vertex.index], min(max(0.5 + sign * vertex.co.z, 0), 1), "REPLACE")
    skinned.modifiers.new("skeleton", "ARMATURE").object = bones

    keyed = link("keyed", ball("keys", 1.0, 0.8, 0.9), location=(3.2, 3.2, 0))
    keyed.data.materials.append(puff)
    keyed.shape_key_add(name="Basis")
    for vertex in keyed.shape_key_add(name="long").data:
        vertex.co.z *= 1.7
    keyed.data.shape_keys.key_blocks["long"].value = 0.6
    keyed.data["layer"] = "low"

    divided = link("divided", ball("coarse", 1.1, 0.9, 1.0, ("detail",), subdivisions=2), location=(6.4, 0, 0))
    divided.data.materials.append(rock)
    divided.modifiers.new("Subdivision", "SUBSURF").levels = 1
    divided["owner"] = "Ünal"

    holder = empty("holder", location=(6.4, 3.2, 0.2), rotation=(0, 0, 0.4))
    holder["slots"] = 2
    child = link("child", ball("small lump", 0.9, 0.9, 1.1, ("a", "b", "c")), parent=holder, scale=(1.1, 0.7, 0.9))
    child.data.materials.append(puff)
    child.data.materials.append(paint)
    child.data.polygons.foreach_set("material_index", [int(polygon.center.z < 0) for polygon in child.data.polygons])
    child.data.uv_layers.active_index, child.data.uv_layers["c"].active_render = 1, True

    sky = collection("Sky", scene.collection)
    near, far = collection("Near", sky), collection("Far", sky)
    for thing, homes in ((two, [near]), (duplicate, [near, far]), (skinned, [far]), (bones, [far]), (keyed, [sky]), (divided, [near]),
                         (holder, [sky]), (child, [sky])):
        scene.collection.objects.unlink(thing)
        for home in homes:
            home.objects.link(thing)
    bpy.context.view_layer.update()
    return sky


def add_light_and_camera():
    """A sun lamp, a sky, and a camera that sees all clouds."""
    scene = bpy.context.scene
    sun = link("sun", bpy.data.lights.new("sun", "SUN"), rotation=(math.radians(58), 0, math.radians(70)))
    sun.data.energy = 3
    scene.world = bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.12, 0.22, 0.42, 1)
    camera = link("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 11.5
    camera.rotation_euler = Euler((math.radians(38), 0, math.radians(20)))
    camera.matrix_world = Matrix.Translation(Vector((3.4, 1.6, 0)) + camera.rotation_euler.to_matrix().col[2] * 20) @ \
        camera.rotation_euler.to_matrix().to_4x4()
    scene.camera = camera
    return sun


def render(path, size, samples=16):
    """By Cycles, on the CPU."""
    scene = bpy.context.scene
    scene.render.engine, scene.render.filepath = "CYCLES", str(path)
    (scene.render.resolution_x, scene.render.resolution_y), scene.render.resolution_percentage = size, 100
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.device, scene.cycles.seed = samples, False, "CPU", 0
    scene.cycles.use_adaptive_sampling = False
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.file_format = "PNG"
    bpy.ops.render.render(write_still=True)


# ---- facts ------------------------------------------------------------------------------------------------------------------------------


def values(elements, name, width, kind=numpy.float32):
    flat = numpy.empty(len(elements) * width, kind)
    elements.foreach_get(name, flat)
    return flat.reshape(-1, width)


def properties(block):
    """The artist's custom properties."""
    return {key: (value.to_list() if hasattr(value, "to_list") else value) for key, value in block.items()
            if not key.startswith("cloudbake") and key != "cycles"}


def textures(material):
    """The images behind the base colour, their pixels, and the UV maps that they are read from (None: the one that renders show)."""
    found = []
    for node in material.node_tree.nodes if material and material.node_tree else ():
        if node.type == "TEX_IMAGE" and node.image:
            pixels = (numpy.array(node.image.pixels[:]) * 255).round().astype(int)
            reads = [link.from_node.uv_map for link in node.inputs["Vector"].links if link.from_node.type == "UVMAP"]
            feeds = sorted({link.to_socket.name for link in node.outputs["Color"].links if link.to_node.type == "BSDF_PRINCIPLED"})
            found.append({"image": node.image.name, "size": list(node.image.size), "pixels": hashlib.sha1(pixels.tobytes()).hexdigest()[:8],
                          "map": reads[0] if reads else None, "feeds": feeds})
    return found


def color(material):
    shader = next((node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED"), None)
    return [round(value, 4) for value in shader.inputs["Base Color"].default_value] if shader else None


def corners(thing, mesh, name):
    """Where a UV map puts which point of the scene, in no order."""
    matrix = numpy.array(thing.matrix_world, float)
    points = values(mesh.vertices, "co", 3)[values(mesh.loops, "vertex_index", 1, numpy.int32)[:, 0]] @ matrix[:3, :3].T + matrix[:3, 3]
    return numpy.unique(numpy.hstack([points, values(mesh.uv_layers[name].data, "uv", 2)]).round(3) + 0.0, axis=0)


def facts_of(thing, nodes=True):
    """Everything of an object that must come back, by names that can be read."""
    evaluated = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    mesh.calc_loop_triangles()
    layers = [layer for layer in thing.data.uv_layers if not layer.name.startswith("Cloudbake ")]
    render = next((layer.name for layer in layers if layer.active_render), None)
    active = thing.data.uv_layers.active
    slots = values(mesh.loop_triangles, "material_index", 1, numpy.int32)[:, 0]
    materials = [slot.material for slot in thing.material_slots]
    found = {
        "parent": thing.parent and thing.parent.name,
        "collections": sorted(collection.name for collection in thing.users_collection),
        "name of the mesh": thing.data.name,
        "material slots": [(slot.name, slot.link) for slot in thing.material_slots],
        "triangles of the slots": [int((slots == number).sum()) for number in range(len(materials))],
        "textures": {material.name: textures(material) for material in materials},
        "base colours": {material.name: color(material) for material in materials if not textures(material)},
        "UV maps": [layer.name for layer in layers],
        "active UV map": active.name if active in layers else None,
        "UV map of renders": render,
        "coordinates of the UV maps": {layer.name: corners(evaluated, mesh, layer.name) for layer in layers},
        "properties of the object": properties(thing),
        "properties of the mesh": properties(thing.data),
        "properties of the materials": {material.name: properties(material) for material in materials},
        "place": numpy.array(thing.matrix_world),
    }
    evaluated.to_mesh_clear()
    return found


def scene_facts():
    scene = bpy.context.scene
    tree = {collection.name: sorted(child.name for child in collection.children) for collection in bpy.data.collections}
    return {"properties of the scene": properties(scene), "collections": tree,
            "properties of parents": {thing.name: properties(thing) for thing in bpy.data.objects if thing.name in ("rig", "holder")},
            "collections of parents": {thing.name: [home.name for home in thing.users_collection] for thing in bpy.data.objects
                                       if thing.name in ("rig", "holder")}}


def same(a, b):
    if isinstance(a, numpy.ndarray) or isinstance(b, numpy.ndarray):
        return a.shape == b.shape and numpy.allclose(a, b, atol=2e-3)
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if isinstance(a, float) or isinstance(b, float):
        return math.isclose(a, b, rel_tol=1e-6)
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        return len(a) == len(b) and all(same(x, y) for x, y in zip(a, b))
    return a == b
