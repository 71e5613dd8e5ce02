"""GLB files: their two chunks, tables of numbers in them, and what an asset says about its lobes."""

import json
import os
import pathlib
import struct
from typing import Any

import numpy

TYPES = {5121: numpy.uint8, 5123: numpy.uint16, 5125: numpy.uint32, 5126: numpy.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


def read_glb(path):
    """The JSON document, and the bytes of the binary chunk."""
    return parse_glb(pathlib.Path(path).read_bytes())


def parse_glb(data):
    if data[:4] != b"glTF" or data[16:20] != b"JSON":
        raise ValueError("it is not a GLB file")
    size = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + size]), bytearray(data[28 + size:])


def write_glb(path, document, binary):
    """The two chunks as a file, which is replaced whole or not at all."""
    binary = bytes(binary) + b"\0" * (-len(binary) % 4)
    document["buffers"] = [{"byteLength": len(binary)}]
    text = json.dumps(document, ensure_ascii=False).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(binary), len(text), 0x4E4F534A)
    path = pathlib.Path(path)
    temporary = path.with_name(path.name + ".part")
    try:
        temporary.write_bytes(head + text + struct.pack("<II", len(binary), 0x004E4942) + binary)
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def table(document, binary, number):
    """An accessor as an array of rows. Interleaved and sparse ones are left to other readers."""
    accessor = document["accessors"][number]
    view = document["bufferViews"][accessor["bufferView"]]
    width = WIDTHS[accessor["type"]]
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    return numpy.frombuffer(binary, TYPES[accessor["componentType"]], accessor["count"] * width, start).reshape(-1, width)


def add_bytes(document, binary, data):
    """The number of a new buffer view."""
    binary += b"\0" * (-len(binary) % 4)
    views = document.setdefault("bufferViews", [])
    views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)})
    binary += data
    return len(views) - 1


def add_table(document, binary, rows, **more):
    """The number of a new accessor."""
    kinds = {numpy.dtype(kind): number for number, kind in TYPES.items()}
    width = next(name for name, size in WIDTHS.items() if size == rows.shape[1])
    accessors = document.setdefault("accessors", [])
    accessors.append({"bufferView": add_bytes(document, binary, rows.tobytes()), "componentType": kinds[rows.dtype], "count": len(rows),
                      "type": width, **more})
    return len(accessors) - 1


def write_triangles(path, name, points, triangles):
    """One mesh as a GLB. points: #V×3 in glTF's axes."""
    document: dict[str, Any] = {"asset": {"version": "2.0", "generator": "cloudbake for Blender"}}
    binary = bytearray()
    points = numpy.ascontiguousarray(points, numpy.float32)
    box = {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()}
    attributes = {"POSITION": add_table(document, binary, points, **box)}
    indices = add_table(document, binary, numpy.ascontiguousarray(triangles, numpy.uint32).reshape(-1, 1))
    document["meshes"] = [{"name": name, "primitives": [{"attributes": attributes, "indices": indices}]}]
    document.update(nodes=[{"name": name, "mesh": 0}], scenes=[{"nodes": [0]}], scene=0)
    write_glb(path, document, binary)


def asset_info(document):
    """asset.extras.cloudbake; None if the file is not a baked asset."""
    extras = document.get("asset", {}).get("extras")
    info = extras.get("cloudbake") if isinstance(extras, dict) else None
    return info if isinstance(info, dict) and info.get("layout") in ("lobe-uv", PACKED) and info.get("version") == 1 else None


PACKED = "lobe-packed"  # docs/asset_format.md
