"""What readers found in a sculpt, and the figures in which two of them are compared.

A shape is a list of parts: the triangles of one material at one node, with a point, UVs and a colour per corner. Readers that run in
another process write a shape as a file: the length of the head (uint32), the head (JSON: node, material, corners, UV sets and whether there
are colours, of each part), and the numbers of the parts (float32): points, each UV set, colours (RGBA)."""

import array
import dataclasses
import json
import math
import struct
import sys
from typing import Any

Row = tuple[float, ...]

# Points nearer than this share of the longest side are one place, and UVs nearer than this are one. No number of text with six decimals
# is just as far from another.
POINT_ERROR = 1.5e-6
COUNT_ERROR = 2e-4  # share of places that are as near to each other as POINT_ERROR, so that rounding decides whether they are one
BOUNDS_ERROR, VOLUME_ERROR, UV_ERROR = 1e-5, 1e-4, 1e-5
COLOR_ERROR = 2.1e-3  # half a step of 8 bits, and a little
MEAN_ERROR = 2e-4


@dataclasses.dataclass
class Part:
    node: str
    material: str | None
    points: list[Row]
    uvs: list[list[Row]] = dataclasses.field(default_factory=list)
    colors: list[Row] = dataclasses.field(default_factory=list)


def write_shape(path, parts):
    """Takes numbers as float32."""
    head = [{"node": part.node, "material": part.material, "corners": len(part.points), "uv_sets": len(part.uvs),
             "colors": bool(part.colors)} for part in parts]
    text = json.dumps(head).encode()
    with open(path, "wb") as out:
        out.write(struct.pack("<I", len(text)) + text)
        for part in parts:
            for rows in (part.points, *part.uvs, part.colors):
                numbers = array.array("f", (number for row in rows for number in row))
                if sys.byteorder == "big":
                    numbers.byteswap()
                out.write(numbers.tobytes())


def read_shape(path):
    data = path.read_bytes()
    size = struct.unpack_from("<I", data)[0]
    at = 4 + size

    def rows(count, width):
        nonlocal at
        numbers = struct.unpack_from(f"<{count * width}f", data, at)
        at += 4 * count * width
        return list(zip(*[iter(numbers)] * width))

    parts = []
    for head in json.loads(data[4:at]):
        count = head["corners"]
        parts.append(Part(head["node"], head["material"], rows(count, 3), [rows(count, 2) for _ in range(head["uv_sets"])],
                          rows(count, 4) if head["colors"] else []))
    return parts


class Places:
    """Numbers of places in space: points within an error of each other have one number."""

    def __init__(self, error):
        self.error, self.cell = error, 64 * error
        self.known: dict[Row, int] = {}
        self.cells: dict[Row, list[tuple[Row, int]]] = {}
        self.count = 0

    def number(self, point):
        found = self.known.get(point)
        if found is None:
            found = self.known[point] = self._near(point)
        return found

    def _near(self, point):
        keys: list[Row] = [()]
        home: Row = ()
        for value in point:  # a point near the border of its cell may have its place in the next one
            at = value / self.cell
            low = math.floor(at)
            choices = [low] + ([low - 1] if at - low < 1 / 32 else [low + 1] if at - low > 31 / 32 else [])
            keys, home = [(*key, choice) for key in keys for choice in choices], (*home, low)
        for key in keys:
            for other, number in self.cells.get(key, ()):
                if all(abs(a - b) <= self.error for a, b in zip(point, other)):
                    return number
        self.cells.setdefault(home, []).append((point, self.count))
        self.count += 1
        return self.count - 1


def bounds(rows):
    """Low and high corner in one."""
    columns = list(zip(*rows))
    return [*map(min, columns), *map(max, columns)]


def volume(points, center):
    """Signed, of the triangles of a list of corners."""
    x, y, z = center
    total = 0.0
    corners = iter(points)
    for (ax, ay, az), (bx, by, bz), (cx, cy, cz) in zip(corners, corners, corners):
        ax, ay, az, bx, by, bz, cx, cy, cz = ax - x, ay - y, az - z, bx - x, by - y, bz - z, cx - x, cy - y, cz - z
        total += ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    return total / 6


def means(low, side, pairs):
    """The mean over distinct pairs of a place and a value, of each coordinate of the place within the box times each number of the value.
    It changes if values are given to other places."""
    pairs = list(pairs)
    width = len(pairs[0][1])
    sums = [0.0] * (3 * width)
    for point, value in pairs:
        for i in range(3):
            share = (point[i] - low[i]) / side
            for j in range(width):
                sums[3 * j + i] += share * value[j]
    return [total / len(pairs) for total in sums]


def surface(parts):
    """Parts without triangles that have no three places, and without UVs that are all 0, which writers of some formats fill in."""
    every = [point for part in parts for point in part.points]
    if not every:
        return [], [], Places(1)
    box = bounds(every)
    side = max(high - low for low, high in zip(box[:3], box[3:])) or 1
    places = Places(POINT_ERROR * side)
    whole = []
    for part in parts:
        numbers = [places.number(point) for point in part.points]
        kept = [i for i in range(0, len(numbers) - 2, 3) if len({*numbers[i:i + 3]}) == 3]
        pick = lambda rows: [rows[j] for i in kept for j in (i, i + 1, i + 2)]
        uvs = [pick(rows) if any(row not in ((0, 0), (0, 1)) for row in rows) else [] for rows in part.uvs]  # V may have been flipped
        if kept:
            whole.append(Part(part.node, part.material, pick(part.points), uvs, pick(part.colors) if part.colors else []))
    return whole, box, places


def value_figures(parts, places, box, side):
    """Of the UV sets and of the colours."""
    found: dict[str, Any] = {}
    sets = max(len(part.uvs) for part in parts)
    while sets and not any(part.uvs[sets - 1:] and part.uvs[sets - 1] for part in parts):
        sets -= 1
    found["UV sets"] = sets
    for number in range(min(sets, 2)):
        pairs, distinct = {}, Places(POINT_ERROR)
        for part in parts:
            for point, uv in zip(part.points, part.uvs[number] if len(part.uvs) > number else ()):
                pairs[places.number(point), distinct.number(uv)] = point, uv
        name = f"UV set {number}: "
        if pairs:
            hull = bounds([uv for _, uv in pairs.values()])
            found |= {name + "distinct": distinct.count, name + "corners": len(pairs), name + "hull": hull,
                      name + "at places": means(box, side, pairs.values())}
    pairs = {(places.number(point), color): (point, color) for part in parts for point, color in zip(part.points, part.colors)}
    found["colours"] = bounds([color[:3] for _, color in pairs.values()]) if pairs else "none"
    if pairs:
        found["alpha"] = bounds([color[3:] for _, color in pairs.values()])
        found["colours at places"] = means(box, side, [(point, color[:3]) for point, color in pairs.values()])
    return found


def figures(parts):
    """What is compared, by name. A shape without triangles has no figures but their number."""
    parts, _, places = surface(parts)
    if not parts:
        return {"triangles": 0}
    points = [point for part in parts for point in part.points]
    box = bounds(points)
    side = max(high - low for low, high in zip(box[:3], box[3:])) or 1
    by_node: dict[str, int] = {}
    by_material: dict[str, int] = {}
    for part in parts:
        by_node[part.node] = by_node.get(part.node, 0) + len(part.points) // 3
        if part.material is not None:
            by_material[part.material] = by_material.get(part.material, 0) + len(part.points) // 3
    center = [(low + high) / 2 for low, high in zip(box[:3], box[3:])]
    return {"vertices": len({places.number(point) for point in points}), "triangles": len(points) // 3, "objects": len(by_node),
            "triangles of objects": sorted(by_node.values()), "materials": len(by_material),
            "triangles of materials": sorted(by_material.values()), "bounds": box, "volume": volume(points, center) / side**3,
            **value_figures(parts, places, box, side)}


def tolerance(name, value):
    """By how much a number of a figure may differ."""
    largest = max((abs(number) for number in value), default=0)
    if name == "bounds":
        return BOUNDS_ERROR * max(high - low for low, high in zip(value[:3], value[3:]))
    if name.startswith(("colours", "alpha")):
        return COLOR_ERROR * max(1, largest)
    return {"volume": VOLUME_ERROR}.get(name, (UV_ERROR if name.endswith("hull") else MEAN_ERROR) * max(1, largest))


def differs(name, ours, theirs):
    """Whether two values of a figure differ by more than the figure's tolerance."""
    if isinstance(ours, float) and isinstance(theirs, float):
        ours, theirs = [ours], [theirs]
    if name == "vertices" or name.endswith(("distinct", "corners")):
        return isinstance(ours, str) or isinstance(theirs, str) or abs(ours - theirs) > COUNT_ERROR * max(ours, theirs)
    if not isinstance(ours, list) or not isinstance(theirs, list) or "triangles of" in name:
        return ours != theirs
    if len(ours) != len(theirs):
        return True
    most = tolerance(name, ours)
    return not all(abs(a - b) <= most for a, b in zip(ours, theirs))
