"""What the checks of whole GLB files share: the two chunks, and a node's matrix."""

import json
import struct


def read_glb(path):
    """The JSON document, and the bytes of the binary chunk."""
    data = path.read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + size]), data[28 + size:]


def multiply(a, b):
    """Product of two 4x4 matrices, as rows."""
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def node_matrix(node):
    """A node's own transform: its matrix, or T·R·S; rows."""
    if "matrix" in node:
        return [[node["matrix"][4 * column + row] for column in range(4)] for row in range(4)]
    (x, y, z, w), s, t = node.get("rotation", [0, 0, 0, 1]), node.get("scale", [1, 1, 1]), node.get("translation", [0, 0, 0])
    turn = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return [[turn[i][j] * s[j] for j in range(3)] + [t[i]] for i in range(3)] + [[0, 0, 0, 1]]
