"""Makes glTF files whose primitives share one vertex buffer, as exporters write them for materials and pieces of a mesh."""

import array
import math
from typing import Any

from glb import write_glb


def ball(rings):
    """Corners and triangles of a ball, in order from pole to pole: 2·rings² + 2 corners."""
    around = 2 * rings
    corners = [(0.0, 1.0, 0.0)]
    for ring in range(1, rings + 1):
        slope = math.pi * ring / (rings + 1)
        for step in range(around):
            turn = 2 * math.pi * step / around
            corners.append((math.sin(slope) * math.cos(turn), math.cos(slope), math.sin(slope) * math.sin(turn)))
    corners.append((0.0, -1.0, 0.0))
    at = lambda ring, step: 1 + ring * around + step % around
    triangles = [(0, at(0, step + 1), at(0, step)) for step in range(around)]
    for ring in range(rings - 1):
        for step in range(around):
            a, b, c, d = at(ring, step), at(ring, step + 1), at(ring + 1, step), at(ring + 1, step + 1)
            triangles += [(a, b, c), (b, d, c)]
    triangles += [(len(corners) - 1, at(rings - 1, step), at(rings - 1, step + 1)) for step in range(around)]
    return corners, triangles


def write_pieces(path, rings, pieces, nodes=False):
    """A ball cut into `pieces` primitives over one buffer of positions and normals: of one mesh, or each under a node of its own."""
    corners, triangles = ball(rings)
    numbers = array.array("f", [x for corner in corners for x in corner]).tobytes()
    binary = bytearray(numbers)
    document: dict[str, Any] = {"asset": {"version": "2.0"}, "scene": 0}
    document["bufferViews"] = [{"buffer": 0, "byteLength": len(numbers), "target": 34962}]
    document["accessors"] = [{"bufferView": 0, "componentType": 5126, "count": len(corners), "type": "VEC3",
                              "min": [min(corner[i] for corner in corners) for i in range(3)],
                              "max": [max(corner[i] for corner in corners) for i in range(3)]}]
    document["accessors"].append({**document["accessors"][0]})
    primitives = []
    for piece in range(pieces):
        own = triangles[piece * len(triangles) // pieces:(piece + 1) * len(triangles) // pieces]
        indices = array.array("I", [v for triangle in own for v in triangle]).tobytes()
        document["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(indices), "target": 34963})
        document["accessors"].append({"bufferView": piece + 1, "componentType": 5125, "count": 3 * len(own), "type": "SCALAR"})
        primitives.append({"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": piece + 2})
        binary += indices
    document["meshes"] = [{"primitives": [primitive]} for primitive in primitives] if nodes else [{"primitives": primitives}]
    document["nodes"] = [{"mesh": mesh} for mesh in range(len(document["meshes"]))]
    document["scenes"] = [{"nodes": list(range(len(document["nodes"])))}]
    document["buffers"] = [{"byteLength": len(binary)}]
    write_glb(path, document, binary)
