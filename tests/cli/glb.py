"""Reads and writes GLBs without a library: the two chunks, the numbers of an accessor, what a scene draws, and attributes to write over."""

import json
import struct

LETTERS = {5120: "b", 5122: "h", 5121: "B", 5123: "H", 5125: "I", 5126: "f"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


def chunks_of(data):
    """The JSON document, and the bytes of the binary chunk."""
    size = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + size]), data[28 + size:]


def glb_of(document, binary):
    """The two chunks as a file."""
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary = bytes(binary) + b"\0" * (-len(binary) % 4)
    return struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(binary), len(text),
                       0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary


def read_glb(path):
    return chunks_of(path.read_bytes())


def write_glb(path, document, binary):
    path.write_bytes(glb_of(document, binary))


def place(document, number):
    """First byte of an accessor, its number of elements, their layout, and the bytes from one to the next."""
    accessor = document["accessors"][number]
    view = document["bufferViews"][accessor["bufferView"]]
    layout = struct.Struct(f"<{WIDTHS[accessor['type']]}{LETTERS[accessor['componentType']]}")
    return view.get("byteOffset", 0) + accessor.get("byteOffset", 0), accessor["count"], layout, view.get("byteStride", layout.size)


def values(document, binary, number):
    """The tuples of an accessor."""
    at, count, layout, stride = place(document, number)
    return [layout.unpack_from(binary, at + i * stride) for i in range(count)]


class GlbEditor:
    """The attributes of a GLB, to read and to write over."""

    def __init__(self, path):
        self.document, binary = read_glb(path)
        self.binary = bytearray(binary)

    def attributes(self):
        """Those of every primitive."""
        return [primitive["attributes"] for mesh in self.document["meshes"] for primitive in mesh["primitives"]]

    def read(self, accessor):
        return values(self.document, self.binary, accessor)

    def write(self, accessor, elements):
        """As many as there were."""
        at, count, layout, stride = place(self.document, accessor)
        for i, element in zip(range(count), elements, strict=True):
            layout.pack_into(self.binary, at + i * stride, *element)

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


def drawn_at_nodes(document):
    """The number of a node, a primitive that the scene draws there, and its matrix, depth first."""
    visits = [(node, node_matrix({})) for node in reversed(document["scenes"][document.get("scene", 0)]["nodes"])]
    while visits:
        number, parent = visits.pop()
        node = document["nodes"][number]
        matrix = multiply(parent, node_matrix(node))
        visits += [(child, matrix) for child in reversed(node.get("children", []))]
        for primitive in document["meshes"][node["mesh"]]["primitives"] if "mesh" in node else []:
            yield number, primitive, matrix


def drawn(document):
    """Every primitive that the scene draws, with its matrix, depth first."""
    for _, primitive, matrix in drawn_at_nodes(document):
        yield primitive, matrix


def transformed(matrix, point, w=1):
    return [sum(row[k] * point[k] for k in range(3)) + w * row[3] for row in matrix[:3]]
