"""What the checks of whole GLB files share: the two chunks, and a node's matrix."""

import json
import struct


def read_glb(path):
    """The JSON document, and the bytes of the binary chunk."""
    data = path.read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + size]), data[28 + size:]


def write_glb(path, document, binary):
    """The two chunks as a file."""
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary = bytes(binary) + b"\0" * (-len(binary) % 4)
    path.write_bytes(struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(binary), len(text), 0x4E4F534A)
                     + text + struct.pack("<II", len(binary), 0x004E4942) + binary)


class GlbEditor:
    """The float32 attributes of a GLB's only mesh, to read and to write over."""

    def __init__(self, path):
        self.document, binary = read_glb(path)
        self.binary = bytearray(binary)

    def attributes(self):
        """Those of every primitive."""
        return [primitive["attributes"] for mesh in self.document["meshes"] for primitive in mesh["primitives"]]

    def place(self, accessor):
        """First byte, number of elements, floats of each."""
        accessor = self.document["accessors"][accessor]
        view = self.document["bufferViews"][accessor["bufferView"]]
        return view.get("byteOffset", 0) + accessor.get("byteOffset",
                                                        0), accessor["count"], {"VEC2": 2, "VEC3": 3, "VEC4": 4}[accessor["type"]]

    def read(self, accessor):
        """Tuples of floats."""
        at, count, width = self.place(accessor)
        return [struct.unpack_from(f"<{width}f", self.binary, at + 4 * width * i) for i in range(count)]

    def write(self, accessor, values):
        """As many as there were."""
        at, count, width = self.place(accessor)
        for i, value in zip(range(count), values, strict=True):
            struct.pack_into(f"<{width}f", self.binary, at + 4 * width * i, *value)

    def change(self, name, function):
        """Every element of an attribute of that name."""
        for number in {attributes[name] for attributes in self.attributes() if name in attributes}:
            self.write(number, [function(*value) for value in self.read(number)])

    def save(self, path):
        """Under another name."""
        write_glb(path, self.document, self.binary)


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
