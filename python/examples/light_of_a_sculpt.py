"""A notebook as a script: bakes a sculpt and draws what was baked. The cells begin with # %%.

    PYTHONPATH=build/release/python python3 python/examples/light_of_a_sculpt.py data/sculpts/wuson.obj light.png
"""

# %% Bake the sculpt as it is.
import sys
from typing import Any

import matplotlib

matplotlib.use("Agg")  # draws into files; leave it out in a notebook
import matplotlib.pyplot as plt
import numpy as np
import numpy.typing
from matplotlib.collections import PolyCollection

import cloudbake

sculpt, picture = sys.argv[1:] if len(sys.argv) == 3 else ("data/sculpts/wuson.obj", "light.png")
baked = cloudbake.bake_file(sculpt)
print(baked.summary)

# %% The asset has the mesh, in scene space. Fitted lobes come nearer to the light that really arrives than mean lobes do, but
# their d is no thickness and their o no mean direction: the upper pictures show the mean lobes, the lower ones the fitted.
asset = cloudbake.read(baked.glb)
fitted = cloudbake.fit(asset.positions, asset.triangles, normals=asset.normals, rays=200)
print(f"{fitted!r}\nseconds: {fitted.report['seconds']}")
corners = asset.positions[asset.triangles]  # #F x 3 x 3

# %% A camera without perspective: it looks along -z after the scene is turned about y.
turn = np.radians(55)
camera = np.array([[np.cos(turn), 0, -np.sin(turn)], [0, 1, 0], [np.sin(turn), 0, np.cos(turn)]])
seen = corners @ camera.T
facing = np.cross(seen[:, 1] - seen[:, 0], seen[:, 2] - seen[:, 0])[:, 2] > 0
order = np.flatnonzero(facing)[np.argsort(seen[facing, :, 2].mean(axis=1))]  # the farthest first


def draw(axes: Any, per_vertex: np.typing.NDArray[Any], title: str, **colours: Any) -> PolyCollection:
    """Draws the mesh with one number, or one colour, per vertex."""
    faces = per_vertex[asset.triangles].mean(axis=1)[order]
    mesh = PolyCollection(seen[order, :, :2], edgecolors="face", linewidths=0.3, **colours)
    mesh.set(**({"facecolors": faces, "edgecolors": faces} if faces.ndim == 2 else {"array": faces}))
    axes.add_collection(mesh)
    axes.autoscale()
    axes.set(title=title, aspect="equal")
    axes.set_axis_off()
    return mesh


# %% What was baked, and the light of two suns. A cloud is lit through: the thin parts glow where the sun is behind them.
suns = {"sun on the right, 30° high": (80, 30), "sun behind, 10° high": (195, 10)}
figure, ((thick, bulk), lit) = plt.subplots(2, 2, figsize=(11, 6.5), constrained_layout=True)
figure.colorbar(draw(thick, asset.lobes[:, 3], "d: thickness along o", cmap="viridis"), ax=thick, shrink=0.8)
draw(bulk, asset.lobes[:, :3] / 2 + 0.5, "o: where the bulk lies, as red, green, blue")
for axes, (title, (azimuth, elevation)) in zip(lit, suns.items()):
    across, up = np.cos(np.radians(elevation)), np.sin(np.radians(elevation))
    to_light = camera.T @ [np.sin(np.radians(azimuth)) * across, up, np.cos(np.radians(azimuth)) * across]
    light = draw(axes, fitted.transmittance(to_light), title, cmap="inferno", clim=(0, 1))
figure.colorbar(light, ax=lit, shrink=0.8, label="T: the light that arrives")
figure.savefig(picture, dpi=80)

# %% All directions at all vertices: how much light arrives in the mean.
directions = np.random.default_rng(1).normal(size=(256, 3))
directions /= np.linalg.norm(directions, axis=1, keepdims=True)
light = cloudbake.transmittance(fitted.lobes[:, None], directions, fitted.exponent, fitted.bias, fitted.extinction)  # #V x 256
print(f"mean light {light.mean():.3f}; the darkest vertex gets {light.mean(axis=1).min():.3f}, the brightest "
      f"{light.mean(axis=1).max():.3f}")
