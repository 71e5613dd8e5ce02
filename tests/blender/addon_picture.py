"""Renders a baked asset with the add-on's material, or with that of `cloudbake shader blender`, and saves what another program needs to
compute the same picture.

  blender [--background] --factory-startup --python tests/blender/addon_picture.py -- ADDONS ASSET.glb FOLDER PICTURES.json

ADDONS: the folder of the add-on, or a script of the kit. PICTURES.json: by name, the engine, and values for inputs of the node group.
FOLDER/NAME.npy gets the colours of the rows from below, FOLDER/place.json the matrices of object and camera, and the sun."""

import json
import os
import pathlib
import runpy
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from in_blender import bpy, numpy, run
from mathutils import Euler

SIZE = 128


def import_clouds(addons, asset):
    """With the material. The sun lamp is in the scene already."""
    if addons.endswith(".py"):
        bpy.ops.import_scene.gltf(filepath=asset)
        runpy.run_path(addons)
        runpy.run_path(addons)  # the second run changes nothing
        return next(thing for thing in bpy.context.scene.objects if thing.type == "MESH")
    sys.path.insert(0, addons)
    bpy.ops.preferences.addon_enable(module="cloudbake_addon")
    assert bpy.ops.cloudbake.import_asset(filepath=asset) == {"FINISHED"}
    return next(thing for thing in bpy.context.scene.objects if thing.type == "MESH")


def build(addons, asset):
    """The cloud under a mirrored and sheared matrix, a sun lamp below a turned parent, a camera without perspective."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    link = scene.collection.objects.link
    holder = bpy.data.objects.new("holder", None)
    holder.rotation_euler = Euler((0.2, -0.4, 1.0))
    link(holder)
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.parent, sun.rotation_euler = holder, Euler((0.9, 0.2, 0.5))
    link(sun)
    thing = import_clouds(addons, asset)
    shear = bpy.data.objects.new("shear", None)
    shear.scale, shear.rotation_euler, shear.location = (1.2, -0.8, 1.1), Euler((0.1, 0.3, -0.2)), (3, -1, 2)
    link(shear)
    thing.parent, thing.rotation_mode, thing.rotation_euler = shear, "XYZ", Euler((0.4, 0.2, 0.7))
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 4.0
    camera.rotation_euler = Euler((1.2, 0.0, 0.4))
    link(camera)
    bpy.context.view_layer.update()
    middle = sum((thing.matrix_world @ vertex.co for vertex in thing.data.vertices), camera.location * 0) / len(thing.data.vertices)
    camera.location = middle + camera.matrix_world.to_3x3().col[2] * 10
    scene.camera = camera
    bpy.context.view_layer.update()
    return thing, sun, camera


def settle(scene):
    """One sample in the middle of each pixel, and colours as they are."""
    render = scene.render
    render.resolution_x = render.resolution_y = SIZE
    render.resolution_percentage, render.film_transparent, render.dither_intensity, render.filter_size = 100, True, 0, 0
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.view_settings.view_transform = "Raw"
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = 1, False, False
    scene.cycles.pixel_filter_type, scene.cycles.filter_width, scene.cycles.device = "BOX", 0.01, "CPU"
    scene.eevee.taa_render_samples = 1


def render(scene, node, picture, path):
    usual = {name: node.inputs[name].default_value for name in picture["inputs"]}
    for name, value in picture["inputs"].items():
        node.inputs[name].default_value = value
    scene.render.engine, scene.render.filepath = picture["engine"], str(path.with_suffix(".exr"))
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    image.colorspace_settings.name = "Non-Color"
    pixels = numpy.empty(SIZE * SIZE * 4, numpy.float32)
    image.pixels.foreach_get(pixels)
    numpy.save(path.with_suffix(".npy"), pixels.reshape(SIZE, SIZE, 4))
    for name, value in usual.items():
        node.inputs[name].default_value = value


def main():
    addons, asset, name_of_folder, pictures = sys.argv[sys.argv.index("--") + 1:]
    folder = pathlib.Path(name_of_folder)
    thing, sun, camera = build(addons, asset)
    scene = bpy.context.scene
    settle(scene)
    material = thing.material_slots[0].material
    node = next(node for node in material.node_tree.nodes if node.type == "GROUP" and "cloudbake_version" in node.node_tree)
    rows = lambda matrix: [list(row) for row in matrix]
    (folder / "place.json").write_text(json.dumps({
        "object": rows(thing.matrix_world), "camera": rows(camera.matrix_world), "ortho_scale": camera.data.ortho_scale,
        "to_sun": list(sun.matrix_world.to_3x3().col[2].normalized()),
        "inputs": {name: list(socket.default_value) if hasattr(socket.default_value, "__len__") else socket.default_value
                   for name, socket in node.inputs.items()}}))
    for name, picture in json.loads(pathlib.Path(pictures).read_text()).items():
        render(scene, node, picture, folder / name)


run(main)
if not bpy.app.background:
    sys.stdout.flush()
    os._exit(0)  # Blender's own way to quit crashes in a script
