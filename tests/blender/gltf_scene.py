"""Where a glTF puts its vertices and lobes, worked out from the specification and docs/asset_format.md alone: nodes, skins, morph targets,
sparse and quantised accessors, instances of EXT_mesh_gpu_instancing. Needs numpy. The program under test shares no line with it."""

import base64
import json
import pathlib
import sys
import urllib.parse
from typing import Any

import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from glb import chunks_of

COMPONENTS = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class Gltf:
    """A document and its buffers."""

    def __init__(self, path):
        path = pathlib.Path(path)
        data = path.read_bytes()
        self.json, chunk = chunks_of(data) if data[:4] == b"glTF" else (json.loads(data), None)
        self.buffers = [self._buffer(path, buffer, chunk) for buffer in self.json.get("buffers", [])]

    @staticmethod
    def _buffer(path, buffer, chunk):
        uri = buffer.get("uri")
        if uri is None:
            return chunk
        if uri.startswith("data:"):
            return base64.b64decode(uri.split(",", 1)[1])
        return (path.parent / urllib.parse.unquote(uri)).read_bytes()

    def _read(self, view, offset, component, count, width):
        """Rows of an interleaved or packed buffer view."""
        view = self.json["bufferViews"][view]
        kind = np.dtype(COMPONENTS[component]).newbyteorder("<")
        stride = view.get("byteStride", 0) or kind.itemsize * width
        start = view.get("byteOffset", 0) + offset
        raw = np.frombuffer(self.buffers[view["buffer"]], np.uint8)
        return np.ndarray((count, width), kind, raw.data, start, (stride, kind.itemsize)).copy()

    def stored(self, number):
        """The elements of an accessor as they are stored, sparse ones in place."""
        accessor = self.json["accessors"][number]
        count, width, component = accessor["count"], WIDTHS[accessor["type"]], accessor["componentType"]
        if "bufferView" in accessor:
            values = self._read(accessor["bufferView"], accessor.get("byteOffset", 0), component, count, width)
        else:
            values = np.zeros((count, width), COMPONENTS[component])
        if "sparse" in accessor:
            sparse = accessor["sparse"]
            where, what = sparse["indices"], sparse["values"]
            rows = self._read(where["bufferView"], where.get("byteOffset", 0), where["componentType"], sparse["count"], 1)[:, 0]
            values[rows] = self._read(what["bufferView"], what.get("byteOffset", 0), component, sparse["count"], width)
        return values

    def floats(self, number):
        """As numbers: normalised integers are converted."""
        values = self.stored(number)
        if self.json["accessors"][number].get("normalized") and values.dtype.kind in "iu":
            return np.maximum(values / np.iinfo(values.dtype).max, -1.0)
        return values.astype(float)


def turn_matrix(rotation):
    x, y, z, w = rotation
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def placed(translation, rotation, scale):
    """Translation · rotation · scale."""
    matrix = np.eye(4)
    matrix[:3, :3] = turn_matrix(rotation) * np.asarray(scale)
    matrix[:3, 3] = translation
    return matrix


def node_matrix(node):
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    return placed(node.get("translation", (0, 0, 0)), node.get("rotation", (0, 0, 0, 1)), node.get("scale", (1, 1, 1)))


def world_matrices(gltf, roots):
    """The matrix of every node below the roots, depth first."""
    worlds, visits = {}, [(root, np.eye(4)) for root in reversed(roots)]
    while visits:
        number, parent = visits.pop()
        worlds[number] = parent @ node_matrix(gltf.json["nodes"][number])
        visits += [(child, worlds[number]) for child in reversed(gltf.json["nodes"][number].get("children", []))]
    return worlds


def instance_matrices(gltf, node):
    """One identity, or a matrix for every instance of EXT_mesh_gpu_instancing."""
    extension = node.get("extensions", {}).get("EXT_mesh_gpu_instancing")
    if extension is None:
        return [np.eye(4)]
    columns = {name: gltf.floats(number) for name, number in extension["attributes"].items()}
    count = len(next(iter(columns.values())))
    column = lambda name, usual: columns.get(name, np.tile(np.array(usual, float), (count, 1)))
    return [placed(*row) for row in zip(column("TRANSLATION", (0, 0, 0)), column("ROTATION", (0, 0, 0, 1)), column("SCALE", (1, 1, 1)))]


def joint_blend(gltf, skin, attributes, worlds):
    """A matrix per vertex: the sum of its weights · world of the joint · inverse bind matrix, with weights that add up to 1."""
    joints = skin["joints"]
    bind = np.tile(np.eye(4), (len(joints), 1, 1))
    if "inverseBindMatrices" in skin:
        bind = gltf.floats(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
    moved = np.array([worlds[joint] for joint in joints]) @ bind
    matrices: Any = 0.0
    total: Any = 0.0
    number = 0
    while f"JOINTS_{number}" in attributes:
        index, weight = gltf.stored(attributes[f"JOINTS_{number}"]), gltf.floats(attributes[f"WEIGHTS_{number}"])
        matrices = matrices + np.einsum("vi,vijk->vjk", weight, moved[index])
        total = total + weight.sum(axis=1)
        number += 1
    return matrices / total[:, None, None]


class Part:
    """A primitive in scene space: points (V×3), triangles, vectors o·d (V×3; None without lobes)."""

    def __init__(self, name, points, triangles, lobes):
        self.name, self.points, self.triangles, self.lobes = name, points, triangles, lobes


def morphed(gltf, primitive, weights):
    points = gltf.floats(primitive["attributes"]["POSITION"])
    for weight, target in zip(weights, primitive.get("targets", [])):
        if weight and "POSITION" in target:
            points = points + weight * gltf.floats(target["POSITION"])
    return points


def lobe_floats(gltf, attributes):
    """The rows (o, d) of a primitive, in the mesh's own space. In packed assets the lower half of the octahedron lies outside the square
    |u| + |v| = 1, mirrored at its sides."""
    info = gltf.json["asset"]["extras"]["cloudbake"]
    first, second = (gltf.floats(attributes[f"TEXCOORD_{n}"]) for n in info["uv_sets"])
    if info["layout"] != "lobe-packed":
        return np.column_stack([first, second])
    u, v = first.T
    is_below = abs(u) + abs(v) > 1
    x = np.where(is_below, np.copysign(1 - abs(v), u), u)
    y = np.where(is_below, np.copysign(1 - abs(u), v), v)
    o = np.column_stack([x, y, 1 - abs(u) - abs(v)])
    return np.column_stack([o / np.linalg.norm(o, axis=1)[:, None], info["density_max"] * second[:, 1] ** 2])


def stored_lobes(gltf, attributes):
    """o·d in the mesh's own space; None if the file or the primitive has no lobes, as in a node that is left out."""
    info = gltf.json["asset"].get("extras", {}).get("cloudbake")
    if info is None or f"TEXCOORD_{info['uv_sets'][0]}" not in attributes:
        return None
    lobes = lobe_floats(gltf, attributes)
    return lobes[:, :3] * lobes[:, 3:]


def triangles_of(gltf, primitive, count):
    corners = gltf.stored(primitive["indices"])[:, 0] if "indices" in primitive else np.arange(count)
    return corners.astype(int).reshape(-1, 3)


def scene_parts(gltf, scene=None):
    """Every triangle list of a scene, by default the one that the file shows. Nodes that squash space to a sheet or less are left out."""
    scene = gltf.json.get("scene", 0) if scene is None else scene
    worlds, parts = world_matrices(gltf, gltf.json["scenes"][scene]["nodes"]), []
    for number, world in worlds.items():
        node = gltf.json["nodes"][number]
        if "mesh" not in node:
            continue
        mesh = gltf.json["meshes"][node["mesh"]]
        weights = node.get("weights", mesh.get("weights", []))
        for primitive in mesh["primitives"]:
            assert primitive.get("mode", 4) == 4, f"{mesh.get('name')}: not a triangle list"
            attributes = primitive["attributes"]
            points, lobes = morphed(gltf, primitive, weights), stored_lobes(gltf, attributes)
            for instance in instance_matrices(gltf, node):
                if "skin" in node:
                    matrices = joint_blend(gltf, gltf.json["skins"][node["skin"]], attributes, worlds)
                else:
                    matrices = np.tile(world @ instance, (len(points), 1, 1))
                    if np.linalg.det(matrices[0, :3, :3]) == 0:
                        continue
                triangles = triangles_of(gltf, primitive, len(points))
                if np.linalg.det(matrices[0, :3, :3]) < 0:  # a mirrored mesh shows its triangles the other way round
                    triangles = triangles[:, ::-1]
                turned = None if lobes is None else np.einsum("vij,vj->vi", matrices[:, :3, :3], lobes)
                parts.append(Part(node.get("name", ""), np.einsum("vij,vj->vi", matrices[:, :3, :3], points) + matrices[:, :3, 3],
                                  triangles, turned))
    return parts


def write_obj(path, parts):
    """The parts as a flat OBJ. Vertices at one place become one vertex, as in the mesh that was split at seams."""
    lines, base = [], 1
    for part in parts:
        points, row = np.unique(part.points, axis=0, return_inverse=True)
        lines += [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in points]
        lines += ["f " + " ".join(str(base + row[corner]) for corner in triangle) for triangle in part.triangles]
        base += len(points)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
