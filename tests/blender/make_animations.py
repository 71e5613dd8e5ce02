"""Makes animated scenes in Blender, exports each as GLB and FBX, and writes what Blender shows at some frames as OBJ, its twins.

  blender --background --factory-startup --threads 1 --python tests/blender/make_animations.py -- FOLDER [SCULPT.fbx]

For each scene FOLDER gets NAME.glb, NAME.fbx and NAME.FRAME.obj: every mesh as Blender poses it, in world space, +Y up. Blender's exporters
store a key per frame. SCULPT is imported, and gets twins too. FOLDER/animations.json lists the scenes: their files, the frames of their
twins, counted from 0, and the frames per second."""

import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from in_blender import bpy, run
from make_rigs import armature, column, empty, lump, skin, write_twin
from mathutils import Euler

LAST, STEP = 12, 4  # frames
SCENES = []


def scene(function):
    SCENES.append(function)
    return function


def animate(thing, path, **frames):
    """Keys of a property, such as f0=(0, 0, 0)."""
    for frame, value in frames.items():
        setattr(thing, path, value)
        thing.keyframe_insert(path, frame=int(frame[1:]))


def turn(thing, **frames):
    thing.rotation_mode = "QUATERNION"
    animate(thing, "rotation_quaternion", **{frame: Euler(angles).to_quaternion() for frame, angles in frames.items()})


def swell(thing):
    thing.shape_key_add(name="Basis")
    for name, stretch in (("tall", (1, 1, 1.8)), ("wide", (1.5, 1, 1))):
        key = thing.shape_key_add(name=name)
        for point in key.data:
            point.co = [x * s for x, s in zip(point.co, stretch)]
    keys = thing.data.shape_keys.key_blocks
    animate(keys["tall"], "value", f0=0, f7=1, f12=0.3)
    animate(keys["wide"], "value", f0=0.5, f12=0)
    return thing


def wave(bones):
    for i, bone in enumerate(bones.pose.bones):
        turn(bone, f0=(0, 0, 0), f5=(0.4 + 0.2 * i, 0.3, 0), f12=(-0.5, 0, 0.4 * i))
    animate(bones.pose.bones[0], "location", f0=(0, 0, 0), f12=(0.3, 0.2, 0.1))
    animate(bones.pose.bones[1], "scale", f0=(1, 1, 1), f12=(1.2, 1.2, 1.2))
    return bones


@scene
def moved():
    parent = empty("parent", scale=(1.5, 1.5, 1.5))
    turn(parent, f0=(0, 0, 0), f6=(0.5, 1, 0), f12=(0.5, 2.5, 1))
    child = lump("child", 1, parent=parent, location=(1, 0, 0))
    animate(child, "location", f0=(1, 0, 0), f12=(0, 2, 1))
    animate(child, "scale", f0=(1, 1, 1), f12=(1, 0.5, 2))
    lump("at rest", 2, subdivisions=3, location=(0, -2, 0))


@scene
def skinned():
    bones = wave(armature("rig", location=(1, 2, 0), rotation=(0.2, 0, 0.3)))
    animate(bones, "location", f0=(1, 2, 0), f12=(0, 2, 1))
    skin(column("cloud", 3), bones)


@scene
def morphed():
    swell(lump("cloud", 4, rotation=(0.3, 0, 0), scale=(1, 1.5, 1)))


@scene
def skinned_and_morphed():
    skin(swell(column("cloud", 5)), wave(armature("rig")))


@scene
def on_a_bone():
    bones = wave(armature("crane", bones=2, rotation=(0, 0.3, 0)))
    made = lump("load", 6, parent=bones, location=(0, 0.4, 0), rotation=(0.3, 0, 0), scale=(1, 0.7, 1))
    made.parent_type, made.parent_bone = "BONE", "bone 1"


def write_twins(folder, name, frames):
    for frame in frames:
        bpy.context.scene.frame_set(bpy.context.scene.frame_start + frame)
        bpy.context.view_layer.update()
        write_twin(folder / f"{name}.{frame}.obj", bpy.context.scene, False)


def make(folder, function):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    name, view = function.__name__, bpy.context.scene
    view.frame_start, view.frame_end = 0, LAST
    function()
    frames = list(range(0, LAST + 1, STEP))
    write_twins(folder, name, frames)
    view.frame_set(0)
    bpy.ops.export_scene.gltf(filepath=str(folder / f"{name}.glb"), export_format="GLB", export_nla_strips=False)
    bpy.ops.export_scene.fbx(filepath=str(folder / f"{name}.fbx"), bake_anim_use_nla_strips=False, bake_anim_use_all_actions=False,
                             bake_anim_simplify_factor=0)
    return {"name": name, "files": [f"{name}.glb", f"{name}.fbx"], "frames": frames, "fps": view.render.fps}


def imported(folder, file):
    """Its keys are those of the file, one per frame."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.fbx(filepath=str(file), anim_offset=0)
    view = bpy.context.scene
    ends = [action.frame_range[:] for action in bpy.data.actions]
    view.frame_start, last = 0, int(max(end for _, end in ends))
    frames = [0, last // 3, last // 2, last]
    write_twins(folder, file.stem, frames)
    return {"name": file.stem, "files": [str(file)], "frames": frames, "fps": view.render.fps / view.render.fps_base}


def main():
    folder, *sculpts = map(pathlib.Path, sys.argv[sys.argv.index("--") + 1:])
    folder.mkdir(parents=True, exist_ok=True)
    entries = [make(folder, function) for function in SCENES] + [imported(folder, file) for file in sculpts]
    (folder / "animations.json").write_text(json.dumps(entries, indent=1) + "\n")


if __name__ == "__main__":
    run(main)
