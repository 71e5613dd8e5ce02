"""The nodes of a file: matrices as translation, rotation and scale, and sheared ones as two nodes."""

import numpy

SHEAR = 1e-6  # of the largest number of a matrix: smaller ones are rounding


def turn_of(matrix):
    """The quaternion (x, y, z, w) of a rotation: the eigenvector of Bar-Itzhack's matrix (2000) with the largest eigenvalue."""
    m = matrix
    k = numpy.array([[m[0, 0] - m[1, 1] - m[2, 2], m[1, 0] + m[0, 1], m[2, 0] + m[0, 2], m[2, 1] - m[1, 2]],
                     [m[1, 0] + m[0, 1], m[1, 1] - m[0, 0] - m[2, 2], m[2, 1] + m[1, 2], m[0, 2] - m[2, 0]],
                     [m[2, 0] + m[0, 2], m[2, 1] + m[1, 2], m[2, 2] - m[0, 0] - m[1, 1], m[1, 0] - m[0, 1]],
                     [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], m[0, 0] + m[1, 1] + m[2, 2]]])
    return numpy.linalg.eigh(k / 3)[1][:, 3].tolist()


def turn_and_scale(linear):
    """A 3×3 matrix as a rotation and three scales; None if it is sheared."""
    scale = numpy.linalg.norm(linear, axis=0)
    gram = linear.T @ linear
    if not scale.min() > 0 or numpy.abs(gram - numpy.diag(numpy.diag(gram))).max() > SHEAR * scale.max() ** 2:
        return None
    if numpy.linalg.det(linear) < 0:
        scale = -scale
    u, _, v = numpy.linalg.svd(linear / scale)
    return u @ v, scale


def add_node(document, matrix, parent, content):
    """Adds a node with that 4×4 matrix below the node with the number `parent`, or to the scene if that is None. content: its name, its
    mesh and its extras. Translation, rotation and scale cannot hold a sheared matrix. Two nodes can: M = U·S·Vᵀ, a turn and a scale, then
    a turn, whose node has the content. Returns the number of that node."""
    place, parts = matrix[:3, 3].tolist(), turn_and_scale(matrix[:3, :3])
    if parts is not None:
        return append(document, parent, {**content, **keys(place, *parts)})
    u, s, v = numpy.linalg.svd(matrix[:3, :3])
    if numpy.linalg.det(v) < 0:
        v, s = v * [[-1], [1], [1]], s * [-1, 1, 1]
    if numpy.linalg.det(u) < 0:
        u, s = u * [-1, 1, 1], s * [-1, 1, 1]
    outer = append(document, parent, {"name": content["name"] + ".shear", **keys(place, u, s)})
    return append(document, outer, {**content, **keys([0, 0, 0], v, numpy.ones(3))})


def keys(place, turn, scale):
    """Of a node. Those that change nothing are left out."""
    found = {"translation": place, "rotation": turn_of(turn), "scale": scale.tolist()}
    usual = {"translation": [0, 0, 0], "rotation": [0, 0, 0, 1], "scale": [1, 1, 1]}
    return {key: value for key, value in found.items() if numpy.abs(numpy.array(value) - usual[key]).max() > 0}


def append(document, parent, node):
    number = len(document["nodes"])
    document["nodes"].append(node)
    if parent is None:
        document["scenes"][0]["nodes"].append(number)
    else:
        document["nodes"][parent].setdefault("children", []).append(number)
    return number
