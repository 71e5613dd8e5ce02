"""What can be done to a baked asset after its bake: changes of its lobes, mesh, constants and nodes, for tests/cli/tampered_assets.

Each function takes a GlbEditor and a random.Random. The assets have one pair of UV sets, TEXCOORD_0 and TEXCOORD_1."""

import math
import struct

FIRST, SECOND = "TEXCOORD_0", "TEXCOORD_1"


def lobes(change):
    """`change(directions, thicknesses, random)` of every primitive gives both anew."""
    def tamper(editor, random):
        for attributes in editor.attributes():
            first, second = editor.read(attributes[FIRST]), editor.read(attributes[SECOND])
            o, d = change([(a, b, c) for (a, b), (c, _) in zip(first, second)], [v for _, v in second], random)
            editor.write(attributes[FIRST], [v[:2] for v in o])
            editor.write(attributes[SECOND], [(v[2], t) for v, t in zip(o, d)])
    return tamper


def directions(change):
    """`change(direction, index, random)`."""
    return lobes(lambda o, d, random: ([change(v, i, random) for i, v in enumerate(o)], d))


def thicknesses(change):
    """`change(thickness, index, random)`."""
    return lobes(lambda o, d, random: (o, [change(t, i, random) for i, t in enumerate(d)]))


def unit(v):
    length = math.sqrt(sum(x * x for x in v)) or 1
    return tuple(x / length for x in v)


def permuted(values, random):
    return random.sample(values, len(values))


def all_permuted(o, d, random):
    order = permuted(range(len(d)), random)
    return [o[i] for i in order], [d[i] for i in order]


def noise(degrees):
    """Every direction turned by so much, each about another axis."""
    def change(v, _, random):
        draw = [random.gauss(0, 1) for _ in range(3)]
        along = sum(a * b for a, b in zip(v, draw))
        across = unit([a - along * b for a, b in zip(draw, v)])
        return unit([a + math.tan(math.radians(degrees)) * b for a, b in zip(v, across)])
    return directions(change)


def turned(degrees):
    """Every direction turned about the vertical."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return directions(lambda v, i, random: (c * v[0] + s * v[2], v[1], -s * v[0] + c * v[2]))


def inverted(which):
    return directions(lambda v, i, random: tuple(-x for x in v) if which(i) else v)


def of_another(o, d, random):
    """The lobes of a cloud that is the mirror image, turned on its head: plausible, and of another shape."""
    return [(-v[2], -v[1], v[0]) for v in reversed(o)], list(reversed(d))


def positions(change):
    """`change(point, box)` of every position; box: lowest and highest of each axis."""
    def tamper(editor, random):
        for attributes in editor.attributes():
            points = editor.read(attributes["POSITION"])
            box = [(min(p[i] for p in points), max(p[i] for p in points)) for i in range(3)]
            editor.write(attributes["POSITION"], [change(p, box) for p in points])
    return tamper


def twist(p, box):
    angle = 0.8 * (p[1] - box[1][0]) / (box[1][1] - box[1][0])
    c, s = math.cos(angle), math.sin(angle)
    return c * p[0] + s * p[2], p[1], -s * p[0] + c * p[2]


def bulge(p, box):
    """A bump on the side of +x."""
    size = max(high - low for low, high in box)
    middle = [(low + high) / 2 for low, high in box]
    place = (box[0][1], middle[1], middle[2])
    weight = math.exp(-sum((a - b) ** 2 for a, b in zip(p, place)) / (0.2 * size) ** 2)
    return p[0] + 0.25 * size * weight, p[1], p[2]


def far_vertex(editor, random):
    for attributes in editor.attributes():
        points = editor.read(attributes["POSITION"])
        points[len(points) // 3] = (1e30, 1e30, 1e30)
        editor.write(attributes["POSITION"], points)


def indices(change):
    """`change(triangles)` of every primitive, as lists of three; as many as before."""
    def tamper(editor, random):
        for mesh in editor.document["meshes"]:
            for primitive in mesh["primitives"]:
                accessor = editor.document["accessors"][primitive["indices"]]
                at = editor.document["bufferViews"][accessor["bufferView"]].get("byteOffset", 0) + accessor.get("byteOffset", 0)
                layout = f"<{accessor['count']}{ {5123: 'H', 5125: 'I'}[accessor['componentType']]}"
                flat = struct.unpack_from(layout, editor.binary, at)
                triangles = change([list(flat[i:i + 3]) for i in range(0, len(flat), 3)])
                struct.pack_into(layout, editor.binary, at, *[i for triangle in triangles for i in triangle])
    return tamper


def constants(**values):
    """Metadata set by hand."""
    def tamper(editor, random):
        editor.document["asset"]["extras"]["cloudbake"].update(values)
    return tamper


def scaled_constant(key, factor):
    def tamper(editor, random):
        editor.document["asset"]["extras"]["cloudbake"][key] *= factor
    return tamper


def harmonics(change):
    """`change(rows, random)` of every attribute of coefficients."""
    def tamper(editor, random):
        for attributes in editor.attributes():
            for name in [name for name in attributes if name.startswith("_TRANSMITTANCE_SH_")]:
                editor.write(attributes[name], change(editor.read(attributes[name]), random))
    return tamper


# Name, what is done, and the causes that `check` may name.
STALE = {"stale", "node-transform", "part", "units", "too-dense", "rescaled"}
TAMPERINGS = [
    ("d permuted between the vertices", lobes(lambda o, d, random: (o, permuted(d, random))), {"thickness"}),
    ("d the same at all vertices", lobes(lambda o, d, random: (o, [sum(d) / len(d)] * len(d))), {"thickness"}),
    ("d 0 at a tenth of the vertices", thicknesses(lambda t, i, random: 0 if random.random() < 0.1 else t), {"thickness"}),
    ("d x 0.8", thicknesses(lambda t, i, random: 0.8 * t), {"units"}),
    ("d x 1.25", thicknesses(lambda t, i, random: 1.25 * t), {"units", "too-dense"}),
    ("d 1e38 at all vertices", thicknesses(lambda t, i, random: 1e38), {"thickness"}),
    ("d 1e38 at one vertex", thicknesses(lambda t, i, random: 1e38 if i == 100 else t), {"too-dense", "thickness"}),
    ("d infinite at one vertex", thicknesses(lambda t, i, random: math.inf if i == 100 else t), {"not-finite"}),
    ("the second set 1e-45 at all vertices", lobes(lambda o, d, random: ([(v[0], v[1], 1e-45) for v in o], [1e-45] * len(d))),
     {"thickness"}),
    ("o x 1e30", directions(lambda v, i, random: tuple(1e30 * x for x in v)), {"not-unit", "units"}),
    ("o off by 10 degrees, each another way", noise(10), {"direction"}),
    ("o off by 3 degrees, each another way", noise(3), {"direction"}),
    ("o turned by 15 degrees about y", turned(15), {"node-transform", "direction"}),
    ("o inverted at all vertices", inverted(lambda i: True), {"inverted"}),
    ("o inverted at 5 % of the vertices", inverted(lambda i: i % 20 == 7), {"direction"}),
    ("o inverted at all but every tenth vertex", inverted(lambda i: i % 10 != 0), {"inverted", "direction"}),
    ("o.x negated", directions(lambda v, i, random: (-v[0], v[1], v[2])), {"handedness"}),
    ("o constant, downwards", directions(lambda v, i, random: (0, -1, 0)), {"direction"}),
    ("lobes moved on by one vertex", lobes(lambda o, d, random: (o[-1:] + o[:-1], d[-1:] + d[:-1])), {"permuted"}),
    ("lobes permuted between the vertices", lobes(all_permuted), {"permuted"}),
    ("lobes of another cloud", lobes(of_another), {"stale", "permuted"}),
    ("lobes zero at 3 % of the vertices",
     lobes(lambda o, d, random: ([(0, 0, 0) if i % 33 == 5 else v for i, v in enumerate(o)],
                                 [0 if i % 33 == 5 else t for i, t in enumerate(d)])), {"zeros"}),
    ("all lobes zero", lobes(lambda o, d, random: ([(0, 0, 0)] * len(o), [0] * len(d))), {"zeros"}),
    ("V flipped in both sets", lobes(lambda o, d, random: ([(v[0], 1 - v[1], v[2]) for v in o], [1 - t for t in d])), {"v-flipped"}),
    ("the sets swapped", lobes(lambda o, d, random: ([(v[2], t, v[0]) for v, t in zip(o, d)], [v[1] for v in o])), {"sets-swapped"}),
    ("mesh stretched, z x 1.25", positions(lambda p, box: (p[0], p[1], 1.25 * p[2])), STALE),
    ("mesh stretched, y x 1.3", positions(lambda p, box: (p[0], 1.3 * p[1], p[2])), STALE),
    ("mesh twisted", positions(twist), STALE),
    ("mesh with a bump", positions(bulge), STALE),
    ("mesh scaled by 1.3", positions(lambda p, box: tuple(1.3 * x for x in p)), STALE),
    ("mesh flat", positions(lambda p, box: (p[0], 0, p[2])), {"no-volume"}),
    ("one vertex at 1e30", far_vertex, {"no-volume", "odd-metadata", "stale"}),
    ("all indices 0", indices(lambda triangles: [[0, 0, 0]] * len(triangles)), {"no-volume"}),
    ("every tenth triangle gone", indices(lambda triangles: [t if i % 10 else [t[0]] * 3 for i, t in enumerate(triangles)]), STALE),
    ("extinction 0", constants(extinction=0), {"odd-metadata"}),
    ("extinction -1", constants(extinction=-1), {"odd-metadata"}),
    ("extinction 1e39", constants(extinction=1e39), {"odd-metadata"}),
    ("extinction x 20", scaled_constant("extinction", 20), {"odd-metadata"}),
    ("extinction x 3", scaled_constant("extinction", 3), {"odd-metadata", "constants"}),
    ("extinction / 100", scaled_constant("extinction", 0.01), {"odd-metadata"}),
    ("exponent 8", constants(exponent=8), {"constants"}),
    ("exponent -1", constants(exponent=-1), {"odd-metadata"}),
    ("bias + 1", constants(bias=1), {"odd-metadata", "constants"}),
    ("bias 1e30", constants(bias=1e30), {"odd-metadata"}),
    ("ray_length -1", constants(ray_length=-1), {"odd-metadata"}),
    ("another layout", constants(layout="lobe-xy"), {"odd-metadata"}),
    ("another version", constants(version=99), {"odd-metadata"}),
    ("lobe 'meen'", constants(lobe="meen"), {"odd-metadata"}),
    ("harmonics x 0.5", harmonics(lambda rows, random: [tuple(0.5 * x for x in row) for row in rows]), {"harmonics"}),
    ("harmonics permuted between the vertices", harmonics(permuted), {"harmonics"}),
    ("harmonics 0", harmonics(lambda rows, random: [(0, 0, 0, 0)] * len(rows)), {"harmonics"}),
]
