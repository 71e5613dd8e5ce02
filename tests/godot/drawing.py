"""What the tests of the kits for Godot share: assets and cameras as numbers, Godot 3 without a screen, and text of shaders."""

import json
import math
import os
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tests/cli"))
from bench import judge, skip
from glb import node_matrix

for program in ("godot3", "Xvfb", "glslangValidator"):
    if not shutil.which(program):
        skip(f"no {program}; scripts/setup --engines installs it")
try:
    import numpy as np
    from PIL import Image
except ImportError as missing:
    skip(missing)


def direction(angles):
    azimuth, elevation = map(math.radians, angles)
    return [math.cos(elevation) * math.sin(azimuth), math.sin(elevation), math.cos(elevation) * math.cos(azimuth)]


def angles(pair):
    return f"{pair[0]},{pair[1]}"


def axes_of(camera, height):
    """Right, up and forward of the camera, and the side of a pixel at distance 1."""
    forward = np.subtract(camera["target"], camera["eye"])
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0, 1, 0])
    right /= np.linalg.norm(right)
    return right, np.cross(right, forward), forward, 2 * math.tan(math.radians(camera["fov"] / 2)) / height


def placed_parts(asset):
    """Of every node: its primitive, its matrix, the triangles, and their corners in the world."""
    for node in asset.document["nodes"]:
        matrix = np.array(node_matrix(node))[:3]
        for primitive in asset.document["meshes"][node["mesh"]]["primitives"]:
            positions = np.array(asset.read(primitive["attributes"]["POSITION"])) @ matrix[:, :3].T + matrix[:, 3]
            triangles = triangles_of(asset, primitive["indices"])
            yield primitive, matrix[:, :3], triangles, positions[triangles]


def triangles_of(asset, number):
    accessor = asset.document["accessors"][number]
    view = asset.document["bufferViews"][accessor["bufferView"]]
    kind = {5123: np.uint16, 5125: np.uint32}[accessor["componentType"]]
    at = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    return np.frombuffer(asset.binary, kind, accessor["count"], at).reshape(-1, 3).astype(np.uint32)


def replaced(text, *changes):
    for old, new in changes:
        if old not in text:
            sys.exit(f"godot: the shader has no '{old}'")
        text = text.replace(old, new)
    return text


def godot(project, *words, driver="GLES2"):
    """What Godot says."""
    read, write = os.pipe()
    with subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "640x480x24", "-nolisten", "tcp"], pass_fds=[write],
                          stderr=subprocess.DEVNULL) as screen:
        try:
            os.close(write)
            with os.fdopen(read) as pipe:
                display = pipe.readline().strip()
            environment = {**os.environ, "DISPLAY": f":{display}", "LIBGL_ALWAYS_SOFTWARE": "1", "HOME": str(project.parent)}
            command = ["godot3", "--video-driver", driver, "--audio-driver", "Dummy", "--path", project, *words]
            result = subprocess.run(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        finally:
            screen.terminate()
    return result.stdout


def has_errors(said):
    return "SHADER ERROR" in said or "SCRIPT ERROR" in said or "Parse Error" in said


def import_assets(project, names):
    """Godot imports the assets with the kit's script."""
    said = godot(project, "--editor", "--quit")  # Godot 3.2 ends with an error, after the import
    materials = [(project / f"{name}_cloud.tres").exists() for name in names]
    judge(all(materials) and not has_errors(said), "Godot imports the assets with the kit's script", said)


def picture(file):
    return np.asarray(Image.open(file).convert("RGB")).astype(int)


# ---- scenes in linear colours -----------------------------------------------------------------------------------------------------------

HALF_FLOATS = 15  # the format of Godot's Image


def draw_scenes(project, jobs):
    """Has tests/godot/scenes.gd draw jobs, in GLES3."""
    shutil.copy(ROOT / "tests/godot/scenes.gd", project)
    (project / "jobs.json").write_text(json.dumps(jobs))
    said = godot(project, "-s", "res://scenes.gd", driver="GLES3")
    judge(not has_errors(said), f"Godot draws {len(jobs)} scenes without an error", said[-3000:])


def linear_picture(project, name):
    """#rows × #columns × 4, top row first."""
    data = (project / f"{name}.raw").read_bytes()
    width, height, form = np.frombuffer(data[:12], np.uint32)
    numbers = np.frombuffer(data[12:], np.float16 if form == HALF_FLOATS else np.uint8)
    return numbers.reshape(height, width, -1)[::-1].astype(float)


def encoded(linear):
    """The sRGB transfer function, 0 to 1."""
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)


def on_screen(linear):
    """The 8-bit values of a linear picture by the tone curve and the dither of the previewer (preview/mesh_clouds/render.h)."""
    color = linear[..., :3]
    film = np.minimum(1, color * (2.51 * color + 0.03) / (color * (2.43 * color + 0.59) + 0.14))
    y, x = np.mgrid[:color.shape[0], :color.shape[1]]
    rank = np.zeros_like(x)
    for bit in range(3):
        rank = (rank << 2) | ((((x ^ y) >> bit) & 1) << 1) | ((y >> bit) & 1)
    return np.floor(255 * encoded(film) + (rank[..., None] + 0.5) / 64).astype(int)


def fade_between(x, start, end):
    """fadeBetween of shaders/functions/soft.glsl."""
    if start == end:
        return np.where(x < start, 0.0, 1.0)
    t = np.clip((x - start) / (end - start), 0, 1)
    return t * t * (3 - 2 * t)
