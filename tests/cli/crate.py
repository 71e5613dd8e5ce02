#!/usr/bin/env python3
"""Writes a sculpt of few triangles for the tests of --refine: a crate whose sides have a texture of their own from an atlas, vertex
colours and hard edges, with a lid of a second material.

  tests/cli/crate.py [--rig | --round] OUT.glb

--rig: also a banner with a skin and a jelly with a morph target, both boxes. --round: an octahedron with soft edges in place of the
crate."""

import argparse
import itertools
import math
import pathlib
import struct
import sys
import zlib
from typing import Any

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from glb import write_glb

COMPONENTS = {"f": 5126, "H": 5123, "B": 5121}
TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
ATLAS = 96, 64  # pixels, in 3 × 2 cells


class Writer:
    """A document that grows."""

    def __init__(self):
        self.binary = bytearray()
        self.document: dict[str, Any] = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [],
                         "meshes": [], "accessors": [], "bufferViews": []}

    def view(self, data):
        self.binary += b"\0" * (-len(self.binary) % 4)
        self.document["bufferViews"].append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)})
        self.binary += data
        return len(self.document["bufferViews"]) - 1

    def accessor(self, rows, letter="f", **more):
        view = self.view(b"".join(struct.pack(f"<{len(row)}{letter}", *row) for row in rows))
        self.document["accessors"].append({"bufferView": view, "componentType": COMPONENTS[letter], "count": len(rows),
                                           "type": TYPES[len(rows[0])], **more})
        return len(self.document["accessors"]) - 1

    def places(self, points):
        return self.accessor(points, min=[min(axis) for axis in zip(*points)], max=[max(axis) for axis in zip(*points)])

    def primitive(self, points, faces, material, **attributes):
        attributes = {"POSITION": self.places(points), **{name: self.accessor(rows) for name, rows in attributes.items()}}
        return {"attributes": attributes, "indices": self.accessor([(corner,) for face in faces for corner in face], "H"),
                "material": material}

    def node(self, name, primitives, **more):
        self.document["meshes"].append({"name": name, "primitives": primitives})
        self.document["nodes"].append({"name": name, "mesh": len(self.document["meshes"]) - 1, **more})
        self.document["scenes"][0]["nodes"].append(len(self.document["nodes"]) - 1)

    def save(self, path):
        self.document["buffers"] = [{"byteLength": len(self.binary) + -len(self.binary) % 4}]
        write_glb(path, self.document, self.binary)


def png(width, height, color):
    """color(x, y): three bytes."""
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + bytes(itertools.chain(*(color(x, y) for x in range(width)))) for y in range(height))
    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + header + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def atlas_color(x, y):
    """A ramp with a checker in each cell, so that every flip and every wrong cell shows."""
    cell = x // 32 + 3 * (y // 32)
    checker = 40 * ((x // 8 + y // 8) % 2)
    return 60 + 25 * cell + checker, 40 + 5 * (x % 32) + checker // 2, 215 - 5 * (y % 32)


def box(low, high):
    """Four corners for each side, counter-clockwise from outside, with their normals and their places in the atlas."""
    points: list[tuple[float, ...]] = []
    normals, uvs, faces = [], [], []
    for side, (axis, end) in enumerate(itertools.product(range(3), (0, 1))):
        first = len(points)
        for u, v in (0, 0), (1, 0), (1, 1), (0, 1):
            place = [0, 0, 0]
            for where, far in ((axis, end), ((axis + 1) % 3, u if end else v), ((axis + 2) % 3, v if end else u)):
                place[where] = (low, high)[far][where]
            points.append(tuple(place))
            normals.append(tuple((2 * end - 1) * float(i == axis) for i in range(3)))
            uvs.append(((side % 3 + 0.05 + 0.9 * u) / 3, (side // 3 + 0.05 + 0.9 * v) / 2))
        faces += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
    return points, normals, uvs, faces


def octahedron():
    """Two sides of a seam at each corner of the equator, normals that point away from the middle."""
    points = [(math.cos(i * math.pi / 2), 0, math.sin(i * math.pi / 2)) for i in range(5)] + [(0, 1, 0), (0, -1, 0)]
    uvs = [(i / 4, 0.5) for i in range(5)] + [(0.5, 0), (0.5, 1)]
    faces = [face for i in range(4) for face in ((i + 1, i, 5), (i, i + 1, 6))]
    return points, points, uvs, faces


def colors(points):
    return [(0.6 + 0.4 * math.sin(3 * x), 0.7 + 0.3 * math.sin(5 * y + 1), 0.8 + 0.2 * math.sin(4 * z + 2), 1) for x, y, z in points]


def add_materials(writer):
    image = writer.view(png(*ATLAS, atlas_color))
    texture = lambda uv_set: {"index": 0, "texCoord": uv_set}
    writer.document |= {
        "images": [{"name": "atlas", "bufferView": image, "mimeType": "image/png"}], "samplers": [{"magFilter": 9729, "minFilter": 9729}],
        "textures": [{"source": 0, "sampler": 0}],
        "materials": [{"name": "painted",
                       "pbrMetallicRoughness": {"baseColorTexture": texture(0), "metallicFactor": 0, "roughnessFactor": 0.8},
                       "emissiveTexture": texture(1), "emissiveFactor": [0.2, 0.2, 0.2]},
                      {"name": "brass",
                       "pbrMetallicRoughness": {"baseColorFactor": [0.9, 0.6, 0.2, 1], "metallicFactor": 0.4, "roughnessFactor": 0.5}}]}


def add_painted(writer, name, shape, *more):
    points, normals, uvs, faces = shape
    painted = writer.primitive(points, faces, 0, NORMAL=normals, TEXCOORD_0=uvs, TEXCOORD_1=[(1 - v, u) for u, v in uvs],
                               COLOR_0=colors(points))
    writer.node(name, [painted, *more], rotation=[0, 0.5, 0, math.sqrt(0.75)])


def add_rig(writer):
    points, normals, _, faces = box((2, -1, -0.2), (3, 1, 0.2))
    banner = writer.primitive(points, faces, 1, NORMAL=normals, WEIGHTS_0=[(1, 0, 0, 0)] * len(points))
    banner["attributes"]["JOINTS_0"] = writer.accessor([(0, 0, 0, 0)] * len(points), "B")
    writer.document["nodes"].append({"name": "bone", "translation": [0, 0.25, 0]})
    writer.document["scenes"][0]["nodes"].append(len(writer.document["nodes"]) - 1)
    writer.document["skins"] = [{"joints": [len(writer.document["nodes"]) - 1]}]
    writer.node("Banner", [banner], skin=0)
    points, normals, _, faces = box((-3, -1, -0.5), (-2, 0.5, 0.5))
    jelly = writer.primitive(points, faces, 1, NORMAL=normals)
    jelly["targets"] = [{"POSITION": writer.places([(0, 0.2 * y, 0.1 * z) for _, y, z in points])}]
    writer.node("Jelly", [jelly])
    writer.document["meshes"][-1]["weights"] = [0.5]


def write_crate(path, rig=False, soft=False):
    writer = Writer()
    add_materials(writer)
    if soft:
        add_painted(writer, "Pebble", octahedron())
    else:
        points, normals, _, faces = box((-0.8, 0.7, -0.5), (0.8, 0.9, 0.5))
        lid = writer.primitive(points, faces, 1, NORMAL=normals, COLOR_0=colors(points))
        add_painted(writer, "Crate", box((-1, -0.7, -0.6), (1, 0.7, 0.6)), lid)
    if rig:
        add_rig(writer)
    writer.save(pathlib.Path(path))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rig", action="store_true")
    parser.add_argument("--round", action="store_true")
    parser.add_argument("path")
    arguments = parser.parse_args()
    write_crate(arguments.path, arguments.rig, arguments.round)


if __name__ == "__main__":
    main()
