"""cloudbake bakes mesh clouds: per vertex, where the cloud's bulk lies and how thick the cloud is there, four floats.

    import cloudbake
    baked = cloudbake.bake(positions, triangles, rays=200)     # numpy arrays: #V x 3 floats, #F x 3 indices
    baked.lobes                                                # #V x 4: o.x, o.y, o.z, d
    baked.transmittance((0, 1, 0))                             # #V: the light that arrives from above
    cloudbake.write("cloud.glb", baked)

bake, bake_file, fit and grow take the options of the commands `cloudbake bake` and `cloudbake grow` as keyword arguments. Equal
input and options give the same bytes as the command, for any number of threads. With progress=FUNCTION they say how far they are.
"""

from __future__ import annotations

import dataclasses
import json
import os
from typing import Any

import numpy

from . import _cloudbake, _options
from .errors import Error, InputError, IoError, UsageError

__version__ = _cloudbake.version
__all__ = ["Asset", "Bake", "BakeWarning", "Error", "InputError", "IoError", "UsageError", "bake", "bake_file", "check", "fit",
           "grow", "presets", "read", "transmittance", "write"]


def __dir__():
    return [*__all__, "__all__", "__doc__", "__file__", "__name__", "__version__"]


@dataclasses.dataclass(frozen=True)
class BakeWarning:
    """Something that was dropped, assumed or undefined."""

    kind: str
    count: int
    first: str


class _Lit:
    lobes: Any
    exponent: float
    bias: float
    extinction: float
    info: dict[str, Any]

    def transmittance(self, to_light):
        """The light that arrives at the vertices: cloudbake.transmittance with these lobes and constants."""
        return transmittance(self.lobes, to_light, self.exponent, self.bias, self.extinction)

    def __repr__(self):
        return (f"<cloudbake.{type(self).__name__}: {len(self.lobes)} vertices, {self.info['lobe']} lobes, exponent {self.exponent:g}, "
                f"bias {self.bias:g}, extinction {self.extinction:g}>")


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Bake(_Lit):
    """The result of a bake.

    lobes       float32, #V x 4: o.x, o.y, o.z (into the bulk, unit length) and d (thickness), in scene space
    exponent    k of the lobe formula
    bias        b, world units
    extinction  sigma, per world unit
    info        what the asset records about its bake
    glb         the asset, as docs/asset_format.md describes it: the bytes that the command writes
    warnings    what was dropped, assumed or undefined
    report      what `--json` of the command writes
    summary     the lines that the command prints
    """

    lobes: numpy.ndarray
    exponent: float
    bias: float
    extinction: float
    info: dict
    glb: bytes
    warnings: tuple
    report: dict
    summary: str


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Asset(_Lit):
    """A baked GLB that was read: all its parts as one mesh, in scene space.

    positions   float32, #V x 3
    triangles   uint32, #F x 3
    normals     float32, #V x 3
    lobes       float32, #V x 4: o.x, o.y, o.z and d
    exponent, bias, extinction, info   as in Bake
    harmonics   float32, #V x (order + 1)^2 coefficients of the transmittance, or None
    """

    positions: numpy.ndarray
    triangles: numpy.ndarray
    normals: numpy.ndarray
    lobes: numpy.ndarray
    exponent: float
    bias: float
    extinction: float
    info: dict
    harmonics: numpy.ndarray | None


def _made(kind, result):
    for name in ("info", "report"):
        if name in result:
            result[name] = json.loads(result[name])
    if "warnings" in result:
        result["warnings"] = tuple(BakeWarning(*warning) for warning in result["warnings"])
    return kind(**result)


def _array(values, what):
    if isinstance(values, numpy.ma.MaskedArray) and numpy.ma.is_masked(values):
        raise UsageError(f"{what}: some values are masked: leave them out, or fill them (numpy.ma.filled)")
    try:
        return numpy.asarray(values)
    except ValueError as error:
        raise UsageError(f"{what}: {error}") from None


def _rows(values, what, width, kind, wanted):
    """An array of `width` columns whose numbers are of one of these kinds (numpy's dtype.kind)."""
    array = _array(values, what)
    if array.ndim != 2 or array.shape[1] != width:
        raise UsageError(f"{what} have the shape {array.shape}: an array of #{wanted} x {width} numbers is needed")
    if array.size and array.dtype.kind not in kind:
        raise UsageError(f"{what} are of type {array.dtype}: {'whole ' if kind == 'iu' else ''}numbers are needed")
    return array


def _floats(values, what):
    with numpy.errstate(over="ignore"):  # what no float32 can hold becomes infinite, and is refused as such
        return numpy.ascontiguousarray(_rows(values, what, 3, "fiu", "V"), dtype=numpy.float32)


def _vectors(values, what, width):
    """Vectors of so many finite numbers along the last axis."""
    array = _array(values, what)
    if array.ndim == 0 or array.shape[-1] != width:
        raise UsageError(f"{what} has the shape {array.shape}: its last axis must have {width} numbers")
    if array.size and array.dtype.kind not in "fiu":
        raise UsageError(f"{what} is of type {array.dtype}: numbers are needed")
    with numpy.errstate(over="ignore"):
        array = array.astype(numpy.float32, copy=False)
    wrong = numpy.argwhere(~numpy.isfinite(array))
    if len(wrong):
        raise UsageError(f"{what}{wrong[0].tolist()} is not a finite number")
    return array


def _constant(value, what):
    if not isinstance(value, (int, float, numpy.number)) or not numpy.isfinite(value) or numpy.iscomplexobj(value):
        raise UsageError(f"{what} is {value!r}: a finite number is needed, such as that of a Bake or an Asset")
    return float(value)


def _indices(values, count):
    array = _rows(values, "triangles", 3, "iu", "F")
    wrong = numpy.argwhere((array < 0) | (array >= count))
    if len(wrong):
        row, column = wrong[0]
        raise InputError(f"triangle {row} has the index {array[row, column]}: indices are 0 to {count - 1}", "mesh")
    return numpy.ascontiguousarray(array, dtype=numpy.uint32)


def _teller(progress):
    if progress is not None and not callable(progress):
        raise UsageError(f"progress is a {type(progress).__name__}: give a function that takes (done, total, stage)")
    return progress


def _baked(function, positions, triangles, normals, progress, options):
    _teller(progress)
    texts = _options.texts(function, options)
    points = _floats(positions, "positions")
    if not len(points):
        raise InputError("there are no positions: give an array of #V x 3 numbers", "mesh")
    corners = _indices(triangles, len(points))
    sides = _floats(numpy.empty((0, 3)) if normals is None else normals, "normals")
    if normals is not None and len(sides) != len(points):
        raise UsageError(f"there are {len(sides)} normals for {len(points)} positions: give one for each, or none")
    if function == "fit":
        texts.append(("lobe", "fit"))
    return _made(Bake, _cloudbake.bake_mesh(points, corners, sides, texts, progress))


def bake(positions, triangles, *, normals=None, progress=None, **options):
    return _baked("bake", positions, triangles, normals, progress, options)


def fit(positions, triangles, *, normals=None, progress=None, **options):
    return _baked("fit", positions, triangles, normals, progress, options)


def bake_file(path, *, progress=None, **options):
    return _made(Bake, _cloudbake.bake_file(os.fsencode(path), _options.texts("bake_file", options), _teller(progress)))


def grow(preset_or_file, *, progress=None, **options):
    return _made(Bake, _cloudbake.grow(os.fsencode(preset_or_file), _options.texts("grow", options), _teller(progress)))


def check(path, *, progress=None, **options):
    return json.loads(_cloudbake.check(os.fsencode(path), _options.texts("check", options), _teller(progress)))


def read(path_or_bytes):
    """Reads a baked GLB: a file's name or its bytes, such as those of Bake.glb. Returns an Asset in scene space."""
    if isinstance(path_or_bytes, (bytes, bytearray, memoryview)):
        return _made(Asset, _cloudbake.read(bytes(path_or_bytes), "asset.glb"))
    return _made(Asset, _cloudbake.read(None, os.fsencode(path_or_bytes)))


def write(path, bake_or_bytes):
    """Writes a Bake, or the bytes of a GLB, to a file. The file is replaced as a whole or stays as it was."""
    glb = bake_or_bytes.glb if isinstance(bake_or_bytes, Bake) else bytes(memoryview(bake_or_bytes))
    _cloudbake.write(os.fsencode(path), glb)


def transmittance(lobes, to_light, exponent, bias, extinction):
    """How much light arrives, by the lobe formula: exp(-extinction * max(0, max(0, l.o/2 + 1/2)^exponent * d + bias)).

    lobes     ... x 4: o.x, o.y, o.z, d
    to_light  ... x 3: unit vectors towards the light
    The axes before the last are broadcast, as numpy does: one light for all lobes, or a light for each. For many lights at all
    lobes, transmittance(lobes[:, None], lights, ...) is #V x #lights. Returns an array of float32, from 0 (dark) to 1.
    """
    lobes, to_light = _vectors(lobes, "lobes", 4), _vectors(to_light, "to_light", 3)
    constants = [_constant(value, what) for value, what in ((exponent, "exponent"), (bias, "bias"), (extinction, "extinction"))]
    if not numpy.allclose(numpy.linalg.norm(to_light, axis=-1), 1, rtol=0, atol=1e-3):
        raise UsageError("to_light must be unit vectors: divide them by their lengths")
    try:
        shape = numpy.broadcast_shapes(lobes.shape[:-1], to_light.shape[:-1])
    except ValueError:
        raise UsageError(f"lobes of shape {lobes.shape} and to_light of shape {to_light.shape} do not fit together: for all lights at "
                         "all lobes, give lobes[:, None]") from None
    all_lobes, all_lights = (numpy.broadcast_to(array, (*shape, array.shape[-1])) for array in (lobes, to_light))
    return _cloudbake.transmittance(all_lobes, all_lights, *constants)


def presets():
    """The names of the clouds that grow() knows."""
    return _cloudbake.presets()


_PROGRESS = """
    progress    None, or a function that is called with (done, total, stage) now and then, from the thread that called: whole numbers,
                at first 0, at last total, and the name of the stage. What it raises ends the call."""
_ARRAYS = f"""
    positions   #V x 3 floats, any unit, +Y up
    triangles   #F x 3 indices; counter-clockwise triangles face outwards
    normals     #V x 3 unit vectors, or None
{_PROGRESS[1:]}
    The vertices keep their number and order unless an option asks for a new mesh; read(result.glb) has it.
"""
bake.__doc__ = _options.explained("bake", f"""
    Bakes a triangle mesh and returns a Bake.
{_ARRAYS}
    Raises UsageError for a wrong argument or option, InputError for a mesh that cannot be used.""")
fit.__doc__ = _options.explained("fit", f"""
    Bakes a triangle mesh with lobes that are fitted to the light (lobe="fit") and returns a Bake.
{_ARRAYS}
    Raises UsageError for a wrong argument or option, InputError for a mesh that cannot be used.""")
bake_file.__doc__ = _options.explained("bake_file", f"""
    Bakes a sculpt or a volume (glTF, GLB, OBJ, PLY, STL, OFF, FBX, VDB and others) and returns a Bake.
{_PROGRESS}
    Raises UsageError for a wrong option, InputError for a file that cannot be used, IoError if it cannot be read.""")
grow.__doc__ = _options.explained("grow", f"""
    Grows a cloud, bakes it and returns a Bake; read(result.glb) has its mesh.

    preset_or_file   one of presets(), a recipe (.toml), a list of rules (.txt), or points and radii (.ply, .csv)
{_PROGRESS[1:]}
    Raises UsageError for a wrong option, InputError for a file that cannot be used, IoError if it cannot be read.""")
check.__doc__ = _options.explained("check", f"""
    Checks a baked asset and returns a report (docs/check.md): ["sound"] says whether it is right, ["verdict"] what is wrong.
{_PROGRESS}
    Raises UsageError for a wrong option, InputError for a file that is no asset, IoError if it cannot be read.""")
