"""Renders glTF files with their own materials, by a sun and a camera without perspective, from above and from below.

  blender --background --factory-startup --python tests/blender/refined_picture.py -- FILE.glb ...

FILE.above.png and FILE.below.png are written beside each file. Cycles sees only direct light by one sample in the middle of each pixel,
so that nothing is left to chance."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from in_blender import bpy, run
from mathutils import Euler, Vector

SIZE = 160
VIEWS = {"above": Euler((1.0, 0, 0.6)), "below": Euler((2.2, 0, 3.6))}


def settle(scene):
    render, cycles = scene.render, scene.cycles
    render.engine, render.film_transparent, render.dither_intensity = "CYCLES", True, 0
    render.resolution_x = render.resolution_y = SIZE
    render.resolution_percentage, render.image_settings.file_format, render.image_settings.color_mode = 100, "PNG", "RGBA"
    scene.view_settings.view_transform = "Standard"
    cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling, cycles.max_bounces = 1, False, False, 0
    cycles.pixel_filter_type, cycles.filter_width, cycles.device, cycles.seed = "BOX", 0.01, "CPU", 1


def draw(path):
    """The scene from each view, into `path` with the view's name."""
    scene = bpy.context.scene
    settle(scene)
    for material in bpy.data.materials:
        material.cycles.sample_as_light = False  # the sun alone lights, so that no light is chosen by chance
    corners = [thing.matrix_world @ Vector(corner) for thing in scene.objects if thing.type == "MESH" for corner in thing.bound_box]
    middle = sum(corners, Vector()) / len(corners)
    radius = max((corner - middle).length for corner in corners)
    sun, camera = (bpy.data.objects.new(name, data)
                   for name, data in (("sun", bpy.data.lights.new("sun", "SUN")), ("camera", bpy.data.cameras.new("camera"))))
    sun.data.energy, sun.data.angle, sun.data.cycles.cast_shadow = 3, 0, False  # Cycles moves shadows by the size of triangles
    camera.data.type, camera.data.ortho_scale, camera.data.clip_end, scene.camera = "ORTHO", 2 * radius, 4 * radius, camera
    for thing in (sun, camera):
        scene.collection.objects.link(thing)
    for name, turn in VIEWS.items():
        camera.rotation_euler, sun.rotation_euler = turn, Euler((turn.x - 0.4, 0, turn.z + 0.5))
        camera.location = middle + turn.to_matrix().col[2] * 2 * radius
        scene.render.filepath = str(path.with_suffix(f".{name}.png"))
        bpy.ops.render.render(write_still=True)


def main():
    for path in map(pathlib.Path, sys.argv[sys.argv.index("--") + 1:]):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.ops.import_scene.gltf(filepath=str(path))
        draw(path)


if __name__ == "__main__":
    run(main)
