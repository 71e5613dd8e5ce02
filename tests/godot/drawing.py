"""What the tests of the kits for Godot share: assets and cameras as numbers, Godot 3 without a screen, and text of shaders."""

import argparse
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tests/cli"))
from bench import judge, run as run_once, skip, temporary_folder, verdict
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


def import_assets(project, names, driver="GLES2"):
    """Godot imports the assets with the kit's script."""
    said = godot(project, "--editor", "--quit", driver=driver)  # Godot 3.2 ends with an error, after the import
    materials = [(project / f"{name}_cloud.tres").exists() for name in names]
    judge(all(materials) and not has_errors(said), "Godot imports the assets with the kit's script", said)


def picture(file):
    return np.asarray(Image.open(file).convert("RGB")).astype(int)


# ---- shaders of Godot 4 -----------------------------------------------------------------------------------------------------------------

SETS = re.compile(r"\tvec2 sets\[8\] = \{ .* \};\n")
# What Godot gives to the stages of a shader, as GLSL.
GIVEN = {"vertex": "const mat4 MODEL_MATRIX = mat4(1.0), INV_VIEW_MATRIX = mat4(1.0), PROJECTION_MATRIX = mat4(1.0);"
                   "const vec2 VIEWPORT_SIZE = vec2(1.0); vec3 VERTEX; in vec3 NORMAL; in vec2 UV, UV2; in vec4 CUSTOM0, CUSTOM1, CUSTOM2;"
                   "out vec4 POSITION;",
         "fragment": "const mat4 INV_VIEW_MATRIX = mat4(1.0), INV_PROJECTION_MATRIX = mat4(1.0); in vec3 VERTEX, NORMAL, VIEW;"
                     "in vec2 SCREEN_UV; in vec4 FRAGCOORD; uniform float TIME; out vec3 ALBEDO; out float ALPHA; out vec4 COLOR;"}


def glsl_of(shader, stage, renderer):
    """A shader of Godot 4 as a stage of GLSL 4.5, for a compiler. `renderer`: the number of Godot's renderer; 0 is Compatibility."""
    head = f"#version 450\n#define RENDERER_COMPATIBILITY 0\n#define CURRENT_RENDERER {renderer}\n{GIVEN[stage]}"
    text = re.sub(r"render_mode .*;", "", re.sub(r"shader_type .*;", head, shader))
    other = "fragment" if stage == "vertex" else "vertex"
    text = re.sub(rf"void {other}\(\) \{{.*?\n\}}\n", "", text, flags=re.S)
    text = text.replace("varying ", "out " if stage == "vertex" else "in ").replace(f"void {stage}()", "void main()")
    return re.sub(r" : (hint|filter)_\w+(\([^)]*\))?(, \w+)*", "", text)


def compile_godot4(kit, folder):
    """All shaders of a kit, by glslangValidator, for both kinds of depth."""
    faults = []
    for file in sorted(kit.rglob("*.gdshader")):
        text = file.read_text()
        for stage, suffix in (("vertex", "vert"), ("fragment", "frag")):
            if f"void {stage}()" not in text:
                continue
            for renderer in (0, 2):
                (folder / f"godot4.{suffix}").write_text(glsl_of(text, stage, renderer))
                result = subprocess.run(["glslangValidator", folder / f"godot4.{suffix}"], capture_output=True, text=True, check=False)
                faults += [f"{file.name}, {stage}: {result.stdout}"] if result.returncode else []
    judge(not faults, f"the {len(list(kit.rglob('*.gdshader')))} shaders of Godot 4 compile", "\n".join(faults))


def as_godot3(shader):
    """A shader of Godot 4 in the language of Godot 3: other names, no arrays, no preprocessor, the depths of OpenGL."""
    shader = re.sub(r"uniform sampler2D screen_depth.*;\n", "", SETS.sub("", shader)).replace("screen_depth", "DEPTH_TEXTURE")
    shader = re.sub(r" : filter_\w+, repeat_disable;", ";", shader)
    shader = re.sub(r"#if CURRENT_RENDERER == RENDERER_COMPATIBILITY\n(.*?)#endif\n", r"\1", shader, flags=re.S)
    for old, new in (("MODEL_MATRIX", "WORLD_MATRIX"), ("INV_VIEW_MATRIX", "CAMERA_MATRIX"),
                     ("vec4(VERTEX.xy, 1.0, 1.0)", "vec4(VERTEX.xy, 0.0, 1.0)"), ("sets[first_set], sets[first_set + 1]", "UV, UV2"),
                     ("CUSTOM0.xy", "UV"), ("texelFetch(sequence_keys, ivec2(at), 0)",
                                            "textureLod(sequence_keys, (at + 0.5) / vec2(textureSize(sequence_keys, 0)), 0.0)")):
        shader = shader.replace(old, new)
    return shader


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


def is_cloud(linear):
    return np.abs(linear[..., :3] - BACKGROUND).max(axis=2) > 0.02


def fade_between(x, start, end):
    """fadeBetween of shaders/engines/soft.glsl."""
    if start == end:
        return np.where(x < start, 0.0, 1.0)
    t = np.clip((x - start) / (end - start), 0, 1)
    return t * t * (3 - 2 * t)


# What the image chain adds to a scene is left out.
BARE = """[fog]
density = 0
[chain]
near_width = 0
far_width = 0
depth_spread = 0
swirl_strength = 0
dark = 1
detail_shrink = 0
detail_darkening = 0
"""
SIZE = (360, 240)
BACKGROUND = [0.2, 0.35, 0.6]
SUN = (130, 28)


def scene_text(asset, camera, more=""):
    colors = "".join(f"{name} = {BACKGROUND}\n" for name in ("zenith", "low_sky", "horizon", "ground"))
    fog = "" if "[fog]" in more else "[fog]\ncolor = [1.6, 1.8, 1.9]\n"
    return f"""[camera]
azimuth = {camera[0]}
elevation = {camera[1]}
[sun]
azimuth = {SUN[0]}
elevation = {SUN[1]}
[sky]
disc = "none"
glow = 0
[sky.colors]
{colors}{fog}{more}[[cloud]]
file = "{asset}.glb"
"""


def view_of(run, folder, look):
    """The camera of scene.toml, from the page of `view`."""
    run("view", "--scene", "scene.toml", "--look", look, "-o", "page.html")
    [shown] = json.loads(re.search('id="page">(.*)</script>', (folder / "page.html").read_text())[1])["scenes"]
    camera, towards = shown["camera"], direction((shown["view"]["azimuth"], shown["view"]["elevation"]))
    away = camera["distance"] * max(1, camera["aspect"] * SIZE[1] / SIZE[0])
    return {"eye": [at + away * d for at, d in zip(camera["at"], towards)], "target": camera["at"], "fov": camera["fov"]}


class Bench:
    """A project with the kit and two assets, and what preview draws of scenes with them."""

    def __init__(self, run, folder):
        self.run, self.folder, self.project = run, folder, folder / "project"
        run("grow", "mediocris", "--vertices", "4000", "-o", "cloud.glb")
        run("bake", ROOT / "data/sculpts/wuson.obj", "--lods", "50%,25%", "-o", "sculpt.glb")
        self.write_kit(scene_text("cloud", (0, 0)), self.project)
        assets = [file.stem for file in folder.glob("*.glb")]
        for name in assets:
            (self.project / f"{name}.glb").write_bytes((folder / f"{name}.glb").read_bytes())
        import_assets(self.project, assets)
        run("shader", "godot4", "cloud.glb", "--scene", "kit.toml", "-o", "godot4")
        self.jobs = []

    def write_kit(self, scene, project):
        (self.folder / "kit.toml").write_text(scene)
        self.run("shader", "godot3", "cloud.glb", "--scene", "kit.toml", "-o", project / "cloudbake")
        for file in (project / "cloudbake/example").glob("*"):
            (project / file.name).write_bytes(file.read_bytes())

    def preview(self, scene):
        """The picture, and the view that it has."""
        (self.folder / "scene.toml").write_text(scene)
        size = "x".join(map(str, SIZE))
        self.run("preview", "--scene", "scene.toml", "--look", "painted", "--size", size, "-o", "truth.png")
        return picture(self.folder / "truth.png"), view_of(self.run, self.folder, "painted")

    def add(self, name, view, asset="cloud", **more):
        """A scene to draw (tests/godot/scenes.gd has the keys)."""
        self.jobs.append({"name": name, "size": SIZE, "background": [float(x) for x in encoded(np.array(BACKGROUND))],
                          "clouds": [{"asset": asset}], **view, **more})

    def paint(self, name, view, asset="cloud", painted=None, **more):
        """A scene to draw in the painted look, with those settings."""
        settings = {"time_scale": 0, "samples_per_side": 4, **(painted or {})}
        self.add(name, view, asset, **{"scripts": {"cloudbake_painted": settings}, **more})

    def draw(self):
        draw_scenes(self.project, self.jobs)
        self.jobs = []

    def shown(self, name):
        return linear_picture(self.project, name)[..., :3]


def main(doc, test):
    """Runs test(run, folder), where run(words…) is the program in that folder."""
    parser = argparse.ArgumentParser(description=doc.splitlines()[0])
    parser.add_argument("cloudbake", type=pathlib.Path)
    parser.add_argument("--keep", type=pathlib.Path, metavar="FOLDER", help="work there and keep the files")
    options = parser.parse_args()
    binary = options.cloudbake.resolve()
    with temporary_folder(options.keep) as folder:
        test(lambda *words: run_once(binary, *words, cwd=folder), folder)
    verdict()
