"""What cloudbake and readers made by others find in sculpts, each in its own conventions, which scripts/readers_agree undoes."""

import json
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from glb import drawn_at_nodes, read_glb, transformed
from shapes import Part, read_shape

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
SECONDS = 300  # after which a reader hangs
MOST_MEMORY = 4 << 30  # bytes, of assimp, which takes what a damaged file claims
MOST_EARLY = 3  # files in a row, from the first on, at which a process that takes many may end early
DEBIAN_PYTHON = pathlib.Path("/usr/bin/python3")  # which has Debian's packages
SYSTEM_PYTHON = str(DEBIAN_PYTHON) if DEBIAN_PYTHON.exists() else sys.executable
CHEAP = ["--rays", "4", "--threads", "1", "-q"]
UNSTATED = {".ply", ".obj", ".stl", ".off", ".3ds", ".x3d", ".zgl", ".x"}  # formats that do not say their unit and axes


class Refused(Exception):
    """The reader does not read the file; its words."""


def words_of(done):
    """Why a command failed."""
    if done.returncode < 0:
        return f"ended by signal {-done.returncode}"
    lines = [line for line in (done.stderr + done.stdout).splitlines() if line.strip()]
    return lines[-1].strip() if lines else f"exit {done.returncode}"


# Blender takes its Python from the first python3 of the search path; its own is Debian's.
DEBIAN_FIRST = {**os.environ, "PATH": "/usr/bin:" + os.environ.get("PATH", "")}


def command(*words):
    try:
        return subprocess.run([*map(str, words)], capture_output=True, text=True, errors="replace", timeout=SECONDS, env=DEBIAN_FIRST,
                              check=False)
    except subprocess.TimeoutExpired:
        return subprocess.CompletedProcess(words, 124, "", f"took more than {SECONDS} s")


class Reader:
    """A program or library. Those without formats read every file."""
    name = ""
    formats: set[str] | None = None

    def version(self):
        """None if it is not installed."""
        raise NotImplementedError


# ---- cloudbake --------------------------------------------------------------------------------------------------------------------------

TYPES = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
LARGEST = {"b": 127, "B": 255, "h": 32767, "H": 65535}


def rows_of(document, binary, view, offset, letter, count, width):
    view = document["bufferViews"][view]
    layout = struct.Struct(f"<{width}{letter}")
    start, stride = view.get("byteOffset", 0) + offset, view.get("byteStride", layout.size)
    if stride == layout.size:
        return list(layout.iter_unpack(memoryview(binary)[start:start + count * stride]))
    return [layout.unpack_from(binary, start + i * stride) for i in range(count)]


def elements(document, binary, number):
    """The tuples of an accessor, as numbers of glTF 2.0, 3.6.2: normalized, sparse."""
    accessor = document["accessors"][number]
    letter, count, width = TYPES[accessor["componentType"]], accessor["count"], WIDTHS[accessor["type"]]
    rows = [(0,) * width] * count
    if "bufferView" in accessor:
        rows = rows_of(document, binary, accessor["bufferView"], accessor.get("byteOffset", 0), letter, count, width)
    if "sparse" in accessor:
        where, what = accessor["sparse"]["indices"], accessor["sparse"]["values"]
        size = accessor["sparse"]["count"]
        places = rows_of(document, binary, where["bufferView"], where.get("byteOffset", 0), TYPES[where["componentType"]], size, 1)
        for (i,), row in zip(places, rows_of(document, binary, what["bufferView"], what.get("byteOffset", 0), letter, size, width)):
            rows[i] = row
    if accessor.get("normalized"):
        return [tuple(max(-1, value / LARGEST[letter]) for value in row) for row in rows]
    return rows


def triangle_corners(indices, mode):
    """glTF 2.0, 3.7.2.1: lists, strips and fans as lists."""
    if mode == 4:
        return indices[:len(indices) // 3 * 3]
    if mode == 5:
        turned = lambda i: (indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2])
    else:
        turned = lambda i: (indices[i + 1], indices[i + 2], indices[0])
    return [corner for i in range(len(indices) - 2) for corner in turned(i)] if mode in (5, 6) else []


def glb_parts(path):
    document, binary = read_glb(path)
    lobes = document["asset"]["extras"]["cloudbake"]["uv_sets"]
    parts = []
    for node, primitive, matrix in drawn_at_nodes(document):
        attributes = primitive["attributes"]
        points = [tuple(transformed(matrix, point)) for point in elements(document, binary, attributes["POSITION"])]
        indices = [i for (i,) in elements(document, binary, primitive["indices"])] if "indices" in primitive else list(range(len(points)))
        corners = triangle_corners(indices, primitive.get("mode", 4))
        pick = lambda rows: [rows[i] for i in corners]
        sets = sum(key.startswith("TEXCOORD_") for key in attributes)
        uvs = [pick(elements(document, binary, attributes[f"TEXCOORD_{i}"])) for i in range(sets) if i not in lobes]
        colors = pick(elements(document, binary, attributes["COLOR_0"])) if "COLOR_0" in attributes else []
        material = primitive.get("material")
        named = material is not None and document["materials"][material].get("name") != "cloud"  # its own, of parts without a material
        parts.append(Part(str(node), str(material) if named else None, pick(points), uvs, [(*c, 1.0)[:4] for c in colors]))
    return parts


class Cloudbake(Reader):
    name = "cloudbake"

    def __init__(self, binary):
        self.binary = binary

    def version(self):
        return command(self.binary, "--version").stdout.split()[1] if pathlib.Path(self.binary).exists() else None

    def read(self, path, folder):
        kind = path.suffix.lower()
        frame = ["--units", "1", "--up", "y"] if kind in UNSTATED else []
        voxels = [] if kind == ".vdb" else ["--voxels", "16"]  # a VDB has its own
        asset = folder / "cloudbake.glb"
        bake = [self.binary, "bake", path, *frame, *voxels, *CHEAP, "-o", asset]
        done = command(*bake)
        if done.returncode and "--close wrap" in done.stderr:  # a flat sheet is read, but not baked
            done = command(*bake, "--close", "wrap")
        if done.returncode:
            raise Refused(words_of(done).replace("cloudbake: ", "").replace(f"{path}: ", "").replace(str(path), path.name))
        try:
            return glb_parts(asset)
        finally:
            asset.unlink()


# ---- assimp -----------------------------------------------------------------------------------------------------------------------------


class AssbinScanner:
    """A dump of assimp's scene, before any of its steps: code/AssetLib/Assbin/AssbinFileWriter.cpp of assimp 5.2 writes it."""

    def __init__(self, data):
        self.data, self.at = data, 512

    def take(self, layout):
        values = struct.unpack_from("<" + layout, self.data, self.at)
        self.at += struct.calcsize("<" + layout)
        return values

    def word(self):
        size, = self.take("I")
        self.at += size
        return self.data[self.at - size:self.at].decode("utf-8", "replace")

    def rows(self, count, width):
        return list(zip(*[iter(self.take(f"{count * width}f"))] * width))

    def chunk(self):
        """Its end."""
        _, size = self.take("II")
        return self.at + size

    def nodes(self, above, path, found):
        """Pairs of a mesh and where it is drawn: its node and matrix, as rows."""
        end = self.chunk()
        self.word()
        own = self.take("16f")
        matrix = [[sum(above[i][k] * own[4 * k + j] for k in range(4)) for j in range(4)] for i in range(4)]
        children, meshes, _ = self.take("III")
        found += [(mesh, path, matrix) for mesh in self.take(f"{meshes}I")]
        for i in range(children):
            self.nodes(matrix, f"{path}/{i}", found)
        self.at = end

    def mesh(self):
        """Material, and by corner of each triangle: points, UV sets, colours."""
        end = self.chunk()
        _, vertices, faces, _, material, parts = self.take("IIIIII")
        points = self.rows(vertices, 3) if parts & 1 else []
        for bit, rows in ((2, 1), (4, 2)):  # normals; tangents and bitangents
            if parts & bit:
                self.at += 12 * vertices * rows
        colors = [self.rows(vertices, 4) for i in range(8) if parts & (0x10000 << i)]
        uvs = []
        for i in range(8):
            if parts & (0x100 << i):
                self.take("I")
                uvs.append([row[:2] for row in self.rows(vertices, 3)])
        corners: list[int] = []
        letter = "H" if vertices < 65536 else "I"
        for _ in range(faces):
            size, = self.take("H")
            face = self.take(f"{size}{letter}")
            corners += [corner for i in range(1, size - 1) for corner in (face[0], face[i], face[i + 1])]
        self.at = end
        pick = lambda rows: [rows[i] for i in corners]
        return material, pick(points), [pick(rows) for rows in uvs], pick(colors[0]) if colors else []

    def material(self):
        """Its name."""
        end = self.chunk()
        count, = self.take("I")
        name = ""
        for _ in range(count):
            last = self.chunk()
            if self.word() == "?mat.name":
                self.take("IIII")
                name = self.word()
            self.at = last
        self.at = end
        return name


def assbin_parts(path, nameless):
    """`nameless`: names that assimp gives to the material of what has none."""
    scanner = AssbinScanner(path.read_bytes())
    scanner.chunk()
    _, meshes, materials = scanner.take("III")
    scanner.take("IIII")
    drawn_meshes: list[tuple] = []
    scanner.nodes([[float(i == j) for j in range(4)] for i in range(4)], "", drawn_meshes)
    found = [scanner.mesh() for _ in range(meshes)]
    names = [scanner.material() for _ in range(materials)]
    parts = []
    for mesh, node, matrix in drawn_meshes:
        material, points, uvs, colors = found[mesh]
        named = material < len(names) and names[material] not in nameless
        parts.append(Part(node, str(material) if named else None, [tuple(transformed(matrix, point)) for point in points], uvs, colors))
    return parts


class Assimp(Reader):
    name = "assimp"
    formats = {".ply", ".obj", ".stl", ".off", ".gltf", ".glb", ".dae", ".fbx", ".3ds", ".x3d", ".zgl", ".x"}

    def version(self):
        return package_version("assimp-utils") if shutil.which("assimp") else None

    def read(self, path, folder):
        dump = folder / "assimp.assbin"
        done = command("prlimit", f"--as={MOST_MEMORY}", "assimp", "export", path, dump, "-fassbin")
        if done.returncode or not dump.exists():
            raise Refused(words_of(done).replace(str(path), path.name))
        try:
            return assbin_parts(dump, {"DefaultMaterial", *([] if path.suffix.lower() in (".zgl", ".x3d") else [""])})
        finally:
            dump.unlink()


def package_version(name):
    done = command("dpkg-query", "-W", "-f=${Version}", name)
    return re.split(r"[~+-]", done.stdout)[0] or "of unknown version"


# ---- readers that take many files in one process ----------------------------------------------------------------------------------------


class Batch(Reader):
    """Its process gets FILES.json, paths by number, and a folder. For each file it writes NUMBER.shape, or NUMBER.error with its words. The
    file at which the process ends early is refused, and the next process goes on behind it."""

    def words(self, files, folder):
        raise NotImplementedError

    def read_all(self, paths, folder):
        left, early = dict(enumerate(paths)), 0
        found: dict[pathlib.Path, list[Part] | Refused] = {}
        while left:
            files = folder / "files.json"
            files.write_text(json.dumps({number: str(path) for number, path in left.items()}))
            done = command(*self.words(files, folder))
            for number, path in list(left.items()):
                shape, error = folder / f"{number}.shape", folder / f"{number}.error"
                if shape.exists():
                    found[path] = read_shape(shape)
                    shape.unlink()
                elif error.exists():
                    found[path] = Refused(error.read_text().strip()[:300])
                    error.unlink()
                else:
                    early += 1
                    found[path] = Refused(f"ended with {done.returncode}: {words_of(done)[:200]}")
                    if early == len(found) > MOST_EARLY:
                        raise RuntimeError(f"{self.name} reads nothing: {done.stderr.strip()}")
                    del left[number]
                    break
                del left[number]
        return found


class Blender(Batch):
    name = "Blender"
    formats = {".ply", ".obj", ".stl", ".gltf", ".glb", ".dae", ".fbx", ".x3d"}

    def version(self):
        done = command("blender", "--version") if shutil.which("blender") else None
        return done.stdout.split()[1] if done else None

    def words(self, files, folder):
        script = HERE / "blender_shapes.py"
        return ["blender", "--background", "--factory-startup", "--threads", "1", "--python", script, "--", files, folder]


class Three(Batch):
    name = "three.js"
    formats = {".ply", ".obj", ".stl", ".gltf", ".glb", ".dae", ".fbx", ".3ds"}
    package = ROOT / "node_modules/three/package.json"

    def version(self):
        return json.loads(self.package.read_text())["version"] if shutil.which("node") and self.package.exists() else None

    def words(self, files, folder):
        return ["node", HERE / "three_shapes.mjs", files, folder]


class Meshio(Batch):
    name = "meshio"
    formats = {".ply", ".obj", ".stl", ".off"}

    def version(self):
        done = command(SYSTEM_PYTHON, "-c", "import meshio; print(meshio.__version__)")
        return None if done.returncode else done.stdout.strip()

    def words(self, files, folder):
        return [SYSTEM_PYTHON, HERE / "meshio_shapes.py", files, folder]


class OpenVdb(Batch):
    name = "OpenVDB"
    formats = {".vdb"}

    def version(self):
        done = command(SYSTEM_PYTHON, "-c", "import pyopenvdb; print('.'.join(map(str, pyopenvdb.LIBRARY_VERSION)))")
        return None if done.returncode else done.stdout.strip()

    def words(self, files, folder):
        return [SYSTEM_PYTHON, HERE / "openvdb_shapes.py", files, folder]


SECOND_READERS: list[Reader] = [Assimp(), Blender(), Three(), Meshio(), OpenVdb()]
