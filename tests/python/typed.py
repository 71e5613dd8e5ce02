"""Uses of the module that mypy --strict accepts, and on the lines that say so, uses that it refuses. The test `package` runs mypy on it."""

import pathlib

import numpy
import numpy.typing

import cloudbake

Floats = numpy.typing.NDArray[numpy.float32]

positions = numpy.zeros((3, 3))
triangles = [[0, 1, 2]]

baked: cloudbake.Bake = cloudbake.bake(positions, triangles, normals=None, rays=64, voxels=32, threads=None, attribute=True)
lobes: Floats = baked.lobes
first: cloudbake.BakeWarning = baked.warnings[0]
count: int = first.count
cloudbake.fit(positions, triangles, extinction=(0.5, 2), sun_arc=((0, 90), (0, 360)), exponent="fit", bias="-1%", octaves=(2, 0.5, 0.5))
cloudbake.bake_file(pathlib.Path("a.obj"), repair=("orient", "fill"), up="z", units=0.01, lobe="fit")
cloudbake.grow("humilis", seed=3, domain=(4, 2, 4), variable={"b": 1.5}, base="none", connect=True, premise="A")
report: dict[str, object] = cloudbake.check("a.glb", max_angle=2.5, against=pathlib.Path("b.glb"))
asset: cloudbake.Asset = cloudbake.read(baked.glb)
cloudbake.write("a.glb", baked)
cloudbake.write(pathlib.Path("a.glb"), baked.glb)
cloudbake.bake(positions, triangles, progress=lambda done, total, stage: print(done / total, stage.upper()))


def show(done: int, total: int, stage: str) -> None:
    """Shows how far a call is."""


cloudbake.grow("humilis", progress=show)
light: Floats = cloudbake.transmittance(asset.lobes[:, None], numpy.eye(3), asset.exponent, asset.bias, asset.extinction)
names: list[str] = cloudbake.presets()
try:
    pass
except cloudbake.Error as error:
    place: tuple[str, int, int, str, int] = (error.file, error.line, error.column, error.message, error.exit_code)
except OSError:
    pass

cloudbake.bake(positions, triangles, rayz=64)  # refused
cloudbake.bake(positions, triangles, rays=0.5)  # refused
cloudbake.bake(positions, triangles, lobe="fitted")  # refused
cloudbake.bake(positions, triangles, units=1)  # refused
cloudbake.bake(positions)  # refused
cloudbake.fit(positions, triangles, lobe="mean")  # refused
cloudbake.grow("humilis", vertices="many")  # refused
cloudbake.check("a.glb", json="a.json")  # refused
cloudbake.write("a.glb", 3)  # refused
text: str = baked.glb  # refused
cloudbake.bake(positions, triangles, progress=lambda done: None)  # refused
doubles: numpy.typing.NDArray[numpy.float64] = baked.transmittance((0, 1, 0))  # refused
baked.exponent = 3  # refused
