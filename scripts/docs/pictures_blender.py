"""Draws docs/pictures/blender.jpg: a baked cloud in Eevee, with the add-on's material, lit by a sun lamp.

  xvfb-run -a blender --factory-startup --python scripts/docs/pictures_blender.py -- ASSET.glb PICTURE.png"""

import math
import os
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "blender"), str(ROOT / "tests/blender")]
from in_blender import bpy, run
from mathutils import Euler, Vector

SIZE, FOV = (960, 640), math.radians(35)
ZENITH, HORIZON = (0.05, 0.16, 0.48, 1), (0.4, 0.58, 0.76, 1)


def add(name, data, rotation):
    thing = bpy.data.objects.new(name, data)
    thing.rotation_euler = Euler(map(math.radians, rotation))
    bpy.context.scene.collection.objects.link(thing)
    return thing


def sky(world):
    """From the horizon to the zenith, by the height of a view."""
    world.use_nodes = True
    nodes, link = world.node_tree.nodes, world.node_tree.links.new
    view, parts, ramp = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeSeparateXYZ"), nodes.new("ShaderNodeValToRGB")
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = HORIZON, ZENITH
    ramp.color_ramp.elements[1].position = 0.5
    link(view.outputs["Generated"], parts.inputs[0])
    link(parts.outputs["Z"], ramp.inputs[0])
    link(ramp.outputs["Color"], nodes["Background"].inputs["Color"])


def main():
    asset, picture = sys.argv[sys.argv.index("--") + 1:]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="cloudbake_addon")
    add("sun", bpy.data.lights.new("sun", "SUN"), (62, 0, 122))
    bpy.ops.cloudbake.import_asset(filepath=asset)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("sky")
    sky(scene.world)

    bpy.context.view_layer.update()
    corners = [thing.matrix_world @ Vector(corner) for thing in scene.objects if thing.type == "MESH" for corner in thing.bound_box]
    low, high = (Vector(pick(corner[i] for corner in corners) for i in range(3)) for pick in (min, max))
    camera = add("camera", bpy.data.cameras.new("camera"), (100, 0, 0))
    camera.data.angle = FOV
    camera.location = (low + high) / 2 + camera.rotation_euler.to_matrix().col[2] * (high - low).length * 1.25
    scene.camera = camera

    render = scene.render
    render.engine, render.filepath, render.resolution_percentage = "BLENDER_EEVEE", picture, 100
    render.resolution_x, render.resolution_y = SIZE
    scene.view_settings.view_transform, scene.view_settings.exposure = "Standard", 0.3
    bpy.ops.render.render(write_still=True)


run(main)
sys.stdout.flush()
os._exit(0)  # Blender's own way to quit crashes in a script
