"""The bake of triangles to lobes, by the Python module `cloudbake` if it can be imported, else by the program, else in Node."""

import contextlib
import importlib
import json
import os
import pathlib
import shlex
import shutil
import signal
import subprocess
import tempfile
import threading
from typing import Any

import numpy

from . import glb


class BakeError(Exception):
    """What is wrong, and what to do, in one line."""


class Lobes:
    """What a bake gives. lobes: #V×4 float32 (o.x, o.y, o.z, d) in the space of the points that were baked. info: the keys of
    asset.extras.cloudbake. vertices and triangles are those of a new mesh, or None if the bake kept the points."""

    def __init__(self, lobes, info, warnings=(), vertices=None, triangles=None):
        self.lobes, self.info, self.warnings = lobes, info, list(warnings)
        self.vertices, self.triangles = vertices, triangles


def bake_triangles(vertices, triangles, options, program="", name="cloud"):
    """vertices: #V×3 in scene space with glTF's axes, triangles: #F×3. options: the command line's names with _ and their values, True
    for a flag. Returns Lobes or throws BakeError."""
    return start(vertices, triangles, options, program, name).result()


def start(vertices, triangles, options, program="", name="cloud"):
    """The same in the background: an object with is_done(), result() and cancel()."""
    points, triangles = numpy.ascontiguousarray(vertices, numpy.float32), numpy.ascontiguousarray(triangles, numpy.uint32)
    module = find_module()
    if module:
        return ModuleJob(module, points, triangles, options)
    return ProgramJob(find_program(program), points, triangles, options, name)


def find_module():
    """None if it is not installed in Blender's Python."""
    try:
        module = importlib.import_module("cloudbake")
    except ImportError:
        return None
    return module if hasattr(module, "bake") else None


ADDON = pathlib.Path(__file__).resolve().parent
NAMES = ("cloudbake.exe", "cloudbake", "cloudbake.mjs") if os.name == "nt" else ("cloudbake", "cloudbake.mjs")  # the last one in Node


def find_program(program=""):
    """An absolute path: `program`, else in the add-on's folder bin, else beside the add-on, else on the search path. Folders of the search
    path that are relative, and on Windows the working folder, do not count."""
    if program:
        folder, name = os.path.split(program)
        found = runnable(folder, name) or os.name == "nt" and runnable(folder, name + ".exe")
        if found:
            return found
        raise BakeError(f"the program cloudbake is not at '{program}': install it, or set its absolute path in the add-on's preferences")
    for folder in [ADDON / "bin", ADDON.parent, *os.get_exec_path()]:
        for name in NAMES:
            if found := runnable(folder, name):
                return found
    raise BakeError(f"the program cloudbake is not on the search path, in '{ADDON / 'bin'}' or beside the add-on: install it, or set its "
                    "absolute path in the add-on's preferences")


def runnable(folder, name):
    """The path of a program, or of the module for Node; None if it is none. Blender unpacks archives without the right to run a file."""
    path = os.path.join(folder, name)
    if not os.path.isabs(folder) or not os.path.isfile(path):
        return None
    if name.endswith(".mjs"):
        return path
    if pathlib.Path(folder) == ADDON / "bin" and not os.access(path, os.X_OK):
        with contextlib.suppress(OSError):
            os.chmod(path, 0o755)
    return shutil.which(path)


def who_bakes(program=""):
    """What a bake would use, in words. Throws BakeError if there is nothing."""
    module = find_module()
    if module:
        return f"Python module {getattr(module, '__version__', '')} ({getattr(module, '__file__', 'built in')})"
    found = pathlib.Path(find_program(program))
    place = ("set in the preferences" if program else "in the add-on" if found.parent == ADDON / "bin" else
             "beside the add-on" if found.parent == ADDON.parent else "on the search path")
    return f"{found} ({place}{', in Node' if found.suffix == '.mjs' else ''})"


def command_of(program, folder, options):
    """The command that bakes cloud.glb of a folder to baked.glb and report.json."""
    source, target, report = (str(folder / name) for name in ("cloud.glb", "baked.glb", "report.json"))
    if program.endswith(".mjs"):
        node = next(filter(None, (shutil.which(os.path.join(place, "node")) for place in os.get_exec_path() if os.path.isabs(place))), None)
        if node is None:
            raise BakeError(f"'{program}' needs Node 18 or newer, which is not on the search path: install it, or use the program "
                            "cloudbake")
        named = {key.replace("_", "-"): value for key, value in options.items()}
        return [node, str(ADDON / "run_module.mjs"), program, source, target, report, json.dumps(named)]
    words = [word for key, value in options.items() for word in ["--" + key.replace("_", "-")] + ([] if value is True else [str(value)])]
    return [program, "bake", source, "-o", target, "-q", *words, "--json", report]


def environment():
    """What the program may know of Blender's environment, which has libraries and modules of its own."""
    names = ("PATH", "LD_LIBRARY_PATH", "HOME", "TMPDIR", "LANG", "LC_ALL", "SYSTEMROOT", "TEMP", "TMP")
    return {name: os.environ[name] for name in names if name in os.environ}


def parse_options(text):
    """'--seed 3 --as-published' as a dictionary."""
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise BakeError(f"more options: {error}") from None
    options: dict[str, str | bool] = {}
    while words:
        name = words.pop(0)
        if not name.startswith("--") or len(name) < 3:
            raise BakeError(f"more options: '{name}' is not an option; write --NAME VALUE")
        name, has_value, value = name[2:].partition("=")
        is_flag = not has_value and (not words or words[0].startswith("--"))
        options[name.replace("-", "_")] = True if is_flag else value if has_value else words.pop(0)
    return options


def lobes_of_asset(data, points, warnings):
    """Reads a baked GLB of one mesh. points: those that were baked."""
    document, binary = glb.parse_glb(data)
    primitives = [primitive for mesh in document["meshes"] for primitive in mesh["primitives"]]
    if len(primitives) != 1:
        raise ValueError(f"{len(primitives)} primitives")
    attributes, info = primitives[0]["attributes"], glb.asset_info(document)
    if info["layout"] == glb.PACKED:
        raise ValueError("a packed asset: leave out --pack, which is for files")
    names = ["POSITION"] + [f"TEXCOORD_{number}" for number in info["uv_sets"]]
    places, first, second = (glb.table(document, binary, attributes[name]) for name in names)
    new = () if numpy.array_equal(places, points) else (places, glb.table(document, binary, primitives[0]["indices"]).reshape(-1, 3))
    return Lobes(numpy.hstack([first, second]), info, warnings, *new)


class ModuleJob:
    """A call of the module in a thread. It cannot be stopped, so after cancel() its result is dropped."""

    def __init__(self, module, points, triangles, options):
        self.points = points
        self.found: Any = None
        self.error: Exception | None = None
        self.thread = threading.Thread(target=self.run, args=(module, triangles, options), daemon=True)
        self.thread.start()

    def run(self, module, triangles, options):
        try:
            self.found = module.bake(self.points, triangles, **options)
        except Exception as error:  # whatever the module throws becomes a line for the user
            self.error = error

    def is_done(self):
        return not self.thread.is_alive()

    def result(self):
        self.thread.join()
        if self.error is not None:
            raise BakeError(str(self.error).removeprefix("mesh: "))
        warnings = [f"{warning.first} ({warning.count} in all)" for warning in self.found.warnings]
        return lobes_of_asset(self.found.glb, self.points, warnings)

    def cancel(self):
        pass


class ProgramJob:
    """A run of the program on a file in a folder of its own, which is removed at the end."""

    def __init__(self, program, points, triangles, options, name):
        self.program, self.points, self.folder = program, points, pathlib.Path(tempfile.mkdtemp(prefix="cloudbake-"))
        try:
            command = command_of(program, self.folder, options)
            glb.write_triangles(self.folder / "cloud.glb", name, points, triangles)
            with open(self.folder / "errors.txt", "wb") as errors:
                self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=errors, stderr=errors, env=environment(),
                                                creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0))  # which is Windows's
        except OSError as error:
            self.remove()
            raise BakeError(f"'{program}' cannot be run: {error.strerror}") from None
        except BakeError:
            self.remove()
            raise

    def is_done(self):
        return self.process.poll() is not None

    def result(self):
        try:
            code = self.process.wait()
            if code != 0:
                raise BakeError(self.failure(code))
            report = json.loads((self.folder / "report.json").read_text(encoding="utf-8"))
            warnings = [f"{warning['first']} ({warning['count']} in all)" for warning in report["warnings"]]
            return lobes_of_asset((self.folder / "baked.glb").read_bytes(), self.points, warnings)
        except (OSError, ValueError, KeyError, TypeError, IndexError) as error:
            raise BakeError(f"the asset of '{self.program}' cannot be read: {error}") from None
        finally:
            self.remove()

    def cancel(self):
        self.process.terminate()
        try:
            self.process.wait(5)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.remove()

    def remove(self):
        shutil.rmtree(self.folder, ignore_errors=True)

    def failure(self, code):
        if code < 0:  # what it wrote before, such as warnings, is not the cause
            return f"the program was ended by a signal ({signal.strsignal(-code)}): bake again, or with fewer voxels if memory ran out"
        with contextlib.suppress(OSError, ValueError, KeyError):
            return json.loads((self.folder / "report.json").read_text(encoding="utf-8"))["message"].removeprefix("cloud.glb: ")
        lines = (self.folder / "errors.txt").read_text(encoding="utf-8", errors="replace").strip().splitlines()
        text = lines[-1] if lines else "the program ended without a word"
        return f"{text.removeprefix('cloudbake: ').replace(str(self.folder / 'cloud.glb') + ': ', '')} (exit {code})"
