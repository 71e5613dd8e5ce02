"""The picture of a baked asset by a camera without perspective, computed in double from the four floats, the formula of
docs/asset_format.md and the place of everything in Blender's scene. It shares no code with the add-on."""

import numpy as np

from gltf_scene import Gltf, lobe_floats

TO_BLENDER = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], float)  # from glTF's axes


class Asset:
    """One primitive under one node, in Blender's axes, with its lobes as they are stored."""

    def __init__(self, path, place):
        gltf = Gltf(path)
        node = next(node for node in gltf.json["nodes"] if "mesh" in node)
        primitive = gltf.json["meshes"][node["mesh"]]["primitives"][0]
        attributes = primitive["attributes"]
        matrix = np.array(place["object"])
        self.linear = matrix[:3, :3]
        self.points = gltf.floats(attributes["POSITION"]) @ (self.linear @ TO_BLENDER).T + matrix[:3, 3]
        self.normals = gltf.floats(attributes["NORMAL"]) @ TO_BLENDER.T @ np.linalg.inv(self.linear)
        self.lobes = lobe_floats(gltf, attributes)
        self.triangles = gltf.stored(primitive["indices"])[:, 0].astype(int).reshape(-1, 3)


def first_hits(asset, place, x, y):
    """The nearest triangle of each ray (-1: none) and its barycentric coordinates. x, y: in the camera's plane."""
    camera = np.array(place["camera"])
    seen = (asset.points - camera[:3, 3]) @ camera[:3, :3]  # x, y, and -depth
    a, b, c = (seen[asset.triangles[:, i]] for i in range(3))
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    found, weights = np.full(len(x), -1), np.zeros((len(x), 3))
    for rows in np.array_split(np.arange(len(x)), max(1, len(x) // 256)):
        px, py = x[rows, None], y[rows, None]
        u = ((px - a[:, 0]) * (c[:, 1] - a[:, 1]) - (py - a[:, 1]) * (c[:, 0] - a[:, 0])) / area
        v = ((b[:, 0] - a[:, 0]) * (py - a[:, 1]) - (b[:, 1] - a[:, 1]) * (px - a[:, 0])) / area
        height = a[:, 2] + u * (b[:, 2] - a[:, 2]) + v * (c[:, 2] - a[:, 2])
        height = np.where((u >= 0) & (v >= 0) & (u + v <= 1) & (height < 0), height, -np.inf)
        nearest = height.argmax(axis=1)
        take = np.arange(len(rows)), nearest
        found[rows] = np.where(np.isfinite(height[take]), nearest, -1)
        weights[rows] = np.column_stack([1 - u[take] - v[take], u[take], v[take]])
    return found, weights


def transmittance(o, d, light, inputs):
    half = np.maximum(0, o @ light / 2 + 0.5)
    return np.exp(-inputs["Extinction"] * np.maximum(0, half ** inputs["Exponent"] * d + inputs["Bias"]))


def colors(asset, place, inputs, found, weights):
    """Linear colours at the hits, 0 where there is none."""
    corners = asset.triangles[np.maximum(found, 0)]
    lobes = (asset.lobes[corners] * weights[:, :, None]).sum(axis=1)
    moved = (lobes[:, :3] * lobes[:, 3:]) @ (asset.linear @ TO_BLENDER).T
    d = np.linalg.norm(moved, axis=1)
    o = moved / np.maximum(d, 1e-30)[:, None]
    camera, to_sun = np.array(place["camera"]), np.array(inputs["Sun direction"])
    normal = (asset.normals[corners] * weights[:, :, None]).sum(axis=1)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    normal *= np.where(normal @ camera[:3, 2] < 0, -1, 1)[:, None]  # Blender turns normals to the eye
    facing, half_lambert = normal @ to_sun * 0.5 + 0.5, inputs["Half Lambert"]
    sun = transmittance(o, d, to_sun, inputs) * (half_lambert + (1 - half_lambert) * facing)
    sky = transmittance(o, d, np.array([0, 0, 1.0]), inputs)
    g, cosine = inputs["Phase asymmetry"], -camera[:3, 2] @ to_sun
    phase = min((1 - g * g) / (1 + g * g - 2 * g * cosine) ** 1.5, inputs["Phase limit"])
    bright = np.array(inputs["Sun color"][:3]) * (1 + inputs["Phase share"] * (phase - 1))
    ground, above = (np.array(inputs[name][:3]) for name in ("Ambient ground", "Ambient sky"))
    lit = ground + (bright - ground) * sun[:, None] + ground + (above - ground) * sky[:, None]
    return np.where((found >= 0)[:, None], lit, 0)


class View:
    """What each pixel sees, for any values of the node group's inputs."""

    def __init__(self, path, place, size):
        self.asset, self.place, self.size = Asset(path, place), place, size
        at = ((np.arange(size) + 0.5) / size - 0.5) * place["ortho_scale"]
        x, y = (values.ravel() for values in np.meshgrid(at, at))
        camera, shift = np.array(place["camera"]), place["ortho_scale"] / size / 20
        seen = ((self.asset.points - camera[:3, 3]) @ camera[:3, :2])
        self.rows = np.flatnonzero((np.abs(np.column_stack([x, y]) - (seen.max(axis=0) + seen.min(axis=0)) / 2)
                                    <= np.ptp(seen, axis=0) / 2 + 2 * shift).all(axis=1))
        self.hits = [first_hits(self.asset, place, x[self.rows] + dx * shift, y[self.rows] + dy * shift)
                     for dx, dy in ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1))]

    def picture(self, inputs):
        """size×size colours, rows from below; where there is cloud; where the colours are certain, because a shift by 1/20 pixel changes
        nothing that can be seen."""
        images = np.array([colors(self.asset, self.place, {**self.place["inputs"], **inputs}, *hit) for hit in self.hits])
        covered = np.array([found >= 0 for found, _ in self.hits])
        certain = covered.all(axis=0) & (np.abs(images[1:] - images[0]).max(axis=(0, 2)) < 0.01)
        return self.whole(images[0]), self.whole(covered[0]), self.whole(certain)

    def whole(self, values):
        image = np.zeros((self.size * self.size, *values.shape[1:]), values.dtype)
        image[self.rows] = values
        return image.reshape(self.size, self.size, *values.shape[1:])
