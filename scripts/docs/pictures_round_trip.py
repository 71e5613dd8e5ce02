"""Draws docs/pictures/blender_before.jpg and blender_after.jpg: the six clouds of tests/blender/artists_scene.py as the artist left them,
and after a bake, an export and an import, with the light of their lobes. In Cycles, without a window:

  blender --background --factory-startup --python scripts/docs/pictures_round_trip.py -- PROGRAM FOLDER"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "blender"), str(ROOT / "tests/blender")]
from in_blender import bpy, run
from artists_scene import add_light_and_camera, build, render

SIZE, SAMPLES = (720, 480), 64


def start(program):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="cloudbake_addon")
    bpy.context.preferences.addons["cloudbake_addon"].preferences.program = program


def main():
    program, name_of_folder = sys.argv[sys.argv.index("--") + 1:]
    folder = pathlib.Path(name_of_folder)
    start(program)
    own = bpy.context.scene.cloudbake
    own.scope, own.collection = "COLLECTION", build()
    add_light_and_camera()
    render(folder / "blender_before.png", SIZE, SAMPLES)
    bpy.ops.cloudbake.bake()
    bpy.ops.cloudbake.material()
    bpy.ops.cloudbake.export_asset(filepath=str(folder / "clouds.glb"))
    start(program)
    add_light_and_camera()
    bpy.ops.cloudbake.import_asset(filepath=str(folder / "clouds.glb"))
    render(folder / "blender_after.png", SIZE, SAMPLES)


run(main)
