# Written by scripts/python_stub from the table of options.
import dataclasses
import os
from typing import Any, Callable, Dict, List, Literal, Optional, Sequence, Tuple, Union

import numpy
import numpy.typing
from numpy.typing import ArrayLike

from .errors import Error as Error, InputError as InputError, IoError as IoError, UsageError as UsageError

__version__: str
__all__ = [
    "Asset", "Bake", "BakeWarning", "Error", "InputError", "IoError", "UsageError", "bake", "bake_file", "check", "fit",
    "grow", "presets", "read", "transmittance", "write",
]

_Floats = numpy.typing.NDArray[numpy.float32]
_Path = Union[str, bytes, os.PathLike[str], os.PathLike[bytes]]
_Range = Tuple[float, float]
_Progress = Callable[[int, int, str], object]

def __dir__() -> List[str]: ...

@dataclasses.dataclass(frozen=True)
class BakeWarning:
    kind: str
    count: int
    first: str

@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Bake:
    lobes: _Floats
    exponent: float
    bias: float
    extinction: float
    info: Dict[str, Any]
    glb: bytes
    warnings: Tuple[BakeWarning, ...]
    report: Dict[str, Any]
    summary: str
    def transmittance(self, to_light: ArrayLike) -> _Floats: ...

@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Asset:
    positions: _Floats
    triangles: numpy.typing.NDArray[numpy.uint32]
    normals: _Floats
    lobes: _Floats
    exponent: float
    bias: float
    extinction: float
    info: Dict[str, Any]
    harmonics: Optional[_Floats]
    def transmittance(self, to_light: ArrayLike) -> _Floats: ...

def bake(
    positions: ArrayLike,
    triangles: ArrayLike,
    *,
    normals: Optional[ArrayLike] = ...,
    progress: Optional[_Progress] = ...,
    as_published: Optional[bool] = ...,
    method: Optional[Literal["sweep", "rays"]] = ...,
    field: Optional[Literal["auto", "coverage", "levelset"]] = ...,
    rays: Optional[int] = ...,
    sampler: Optional[Literal["stratified", "fibonacci", "uniform"]] = ...,
    fixed_directions: Optional[bool] = ...,
    quadrature: Optional[Literal["crossing", "midpoint", "end"]] = ...,
    steps: Optional[int] = ...,
    ray_length: Optional[float] = ...,
    voxels: Optional[int] = ...,
    voxel_size: Optional[float] = ...,
    bake_voxels: Optional[int] = ...,
    target_error: Optional[Union[float, str]] = ...,
    seed: Optional[int] = ...,
    lobe: Optional[Literal["fit", "mean"]] = ...,
    fit_to: Optional[Literal["volume", "transmittance"]] = ...,
    view_extinction: Optional[float] = ...,
    octaves: Optional[Union[int, str, Tuple[int, float, float]]] = ...,
    phase: Optional[float] = ...,
    exponent: Optional[Union[float, Literal["fit"]]] = ...,
    bias: Optional[Union[float, str]] = ...,
    extinction: Optional[Union[float, str, _Range]] = ...,
    sun_arc: Optional[Union[str, Tuple[_Range, _Range]]] = ...,
    basis: Optional[Literal["lobe", "sh1", "sh2", "sh3"]] = ...,
    smooth: Optional[int] = ...,
    vertices: Optional[int] = ...,
    remesh: Optional[Union[float, str]] = ...,
    refine: Optional[Union[float, Literal["auto"]]] = ...,
    repair: Optional[Union[str, Sequence[str]]] = ...,
    close: Optional[Literal["auto", "wrap", "reject"]] = ...,
    separate: Optional[bool] = ...,
    inspect: Optional[bool] = ...,
    uv_set: Optional[int] = ...,
    attribute: Optional[bool] = ...,
    pack: Optional[Literal["16", "8"]] = ...,
    pack_as: Optional[Literal["list", "strip", "meshopt"]] = ...,
    keep_alive_texture: Optional[Literal["auto", "force", "off"]] = ...,
    threads: Optional[int] = ...,
    memory: Optional[str] = ...,
    strict: Optional[bool] = ...,
) -> Bake: ...
def fit(
    positions: ArrayLike,
    triangles: ArrayLike,
    *,
    normals: Optional[ArrayLike] = ...,
    progress: Optional[_Progress] = ...,
    as_published: Optional[bool] = ...,
    method: Optional[Literal["sweep", "rays"]] = ...,
    field: Optional[Literal["auto", "coverage", "levelset"]] = ...,
    rays: Optional[int] = ...,
    sampler: Optional[Literal["stratified", "fibonacci", "uniform"]] = ...,
    fixed_directions: Optional[bool] = ...,
    quadrature: Optional[Literal["crossing", "midpoint", "end"]] = ...,
    steps: Optional[int] = ...,
    ray_length: Optional[float] = ...,
    voxels: Optional[int] = ...,
    voxel_size: Optional[float] = ...,
    bake_voxels: Optional[int] = ...,
    target_error: Optional[Union[float, str]] = ...,
    seed: Optional[int] = ...,
    fit_to: Optional[Literal["volume", "transmittance"]] = ...,
    view_extinction: Optional[float] = ...,
    octaves: Optional[Union[int, str, Tuple[int, float, float]]] = ...,
    phase: Optional[float] = ...,
    exponent: Optional[Union[float, Literal["fit"]]] = ...,
    bias: Optional[Union[float, str]] = ...,
    extinction: Optional[Union[float, str, _Range]] = ...,
    sun_arc: Optional[Union[str, Tuple[_Range, _Range]]] = ...,
    basis: Optional[Literal["lobe", "sh1", "sh2", "sh3"]] = ...,
    smooth: Optional[int] = ...,
    vertices: Optional[int] = ...,
    remesh: Optional[Union[float, str]] = ...,
    refine: Optional[Union[float, Literal["auto"]]] = ...,
    repair: Optional[Union[str, Sequence[str]]] = ...,
    close: Optional[Literal["auto", "wrap", "reject"]] = ...,
    separate: Optional[bool] = ...,
    inspect: Optional[bool] = ...,
    uv_set: Optional[int] = ...,
    attribute: Optional[bool] = ...,
    pack: Optional[Literal["16", "8"]] = ...,
    pack_as: Optional[Literal["list", "strip", "meshopt"]] = ...,
    keep_alive_texture: Optional[Literal["auto", "force", "off"]] = ...,
    threads: Optional[int] = ...,
    memory: Optional[str] = ...,
    strict: Optional[bool] = ...,
) -> Bake: ...
def bake_file(
    path: _Path,
    *,
    progress: Optional[_Progress] = ...,
    as_published: Optional[bool] = ...,
    method: Optional[Literal["sweep", "rays"]] = ...,
    field: Optional[Literal["auto", "coverage", "levelset"]] = ...,
    rays: Optional[int] = ...,
    sampler: Optional[Literal["stratified", "fibonacci", "uniform"]] = ...,
    fixed_directions: Optional[bool] = ...,
    quadrature: Optional[Literal["crossing", "midpoint", "end"]] = ...,
    steps: Optional[int] = ...,
    ray_length: Optional[float] = ...,
    voxels: Optional[int] = ...,
    voxel_size: Optional[float] = ...,
    bake_voxels: Optional[int] = ...,
    target_error: Optional[Union[float, str]] = ...,
    seed: Optional[int] = ...,
    lobe: Optional[Literal["fit", "mean"]] = ...,
    fit_to: Optional[Literal["volume", "transmittance"]] = ...,
    view_extinction: Optional[float] = ...,
    octaves: Optional[Union[int, str, Tuple[int, float, float]]] = ...,
    phase: Optional[float] = ...,
    exponent: Optional[Union[float, Literal["fit"]]] = ...,
    bias: Optional[Union[float, str]] = ...,
    extinction: Optional[Union[float, str, _Range]] = ...,
    sun_arc: Optional[Union[str, Tuple[_Range, _Range]]] = ...,
    basis: Optional[Literal["lobe", "sh1", "sh2", "sh3"]] = ...,
    smooth: Optional[int] = ...,
    vertices: Optional[int] = ...,
    remesh: Optional[Union[float, str]] = ...,
    refine: Optional[Union[float, Literal["auto"]]] = ...,
    repair: Optional[Union[str, Sequence[str]]] = ...,
    close: Optional[Literal["auto", "wrap", "reject"]] = ...,
    separate: Optional[bool] = ...,
    inspect: Optional[bool] = ...,
    allow_outside: Optional[bool] = ...,
    scene_index: Optional[int] = ...,
    units: Optional[float] = ...,
    up: Optional[Literal["x", "y", "z"]] = ...,
    grid: Optional[str] = ...,
    iso: Optional[float] = ...,
    uv_set: Optional[int] = ...,
    attribute: Optional[bool] = ...,
    pack: Optional[Literal["16", "8"]] = ...,
    pack_as: Optional[Literal["list", "strip", "meshopt"]] = ...,
    keep_alive_texture: Optional[Literal["auto", "force", "off"]] = ...,
    threads: Optional[int] = ...,
    memory: Optional[str] = ...,
    strict: Optional[bool] = ...,
) -> Bake: ...
def grow(
    preset_or_file: _Path,
    *,
    progress: Optional[_Progress] = ...,
    as_published: Optional[bool] = ...,
    method: Optional[Literal["sweep", "rays"]] = ...,
    field: Optional[Literal["auto", "coverage", "levelset"]] = ...,
    rays: Optional[int] = ...,
    sampler: Optional[Literal["stratified", "fibonacci", "uniform"]] = ...,
    fixed_directions: Optional[bool] = ...,
    quadrature: Optional[Literal["crossing", "midpoint", "end"]] = ...,
    steps: Optional[int] = ...,
    ray_length: Optional[float] = ...,
    voxels: Optional[int] = ...,
    voxel_size: Optional[float] = ...,
    bake_voxels: Optional[int] = ...,
    target_error: Optional[Union[float, str]] = ...,
    seed: Optional[int] = ...,
    lobe: Optional[Literal["fit", "mean"]] = ...,
    fit_to: Optional[Literal["volume", "transmittance"]] = ...,
    view_extinction: Optional[float] = ...,
    octaves: Optional[Union[int, str, Tuple[int, float, float]]] = ...,
    phase: Optional[float] = ...,
    exponent: Optional[Union[float, Literal["fit"]]] = ...,
    bias: Optional[Union[float, str]] = ...,
    extinction: Optional[Union[float, str, _Range]] = ...,
    sun_arc: Optional[Union[str, Tuple[_Range, _Range]]] = ...,
    basis: Optional[Literal["lobe", "sh1", "sh2", "sh3"]] = ...,
    smooth: Optional[int] = ...,
    vertices: Optional[int] = ...,
    uv_set: Optional[int] = ...,
    attribute: Optional[bool] = ...,
    pack: Optional[Literal["16", "8"]] = ...,
    pack_as: Optional[Literal["list", "strip", "meshopt"]] = ...,
    keep_alive_texture: Optional[Literal["auto", "force", "off"]] = ...,
    blend: Optional[Union[float, str]] = ...,
    flat_base: Optional[float] = ...,
    base_softness: Optional[Union[float, str]] = ...,
    base_bumps: Optional[Union[float, str]] = ...,
    base_bump_size: Optional[Union[float, str]] = ...,
    noise: Optional[Union[float, str]] = ...,
    noise_size: Optional[Union[float, str]] = ...,
    noise_octaves: Optional[int] = ...,
    explain: Optional[bool] = ...,
    threads: Optional[int] = ...,
    memory: Optional[str] = ...,
    strict: Optional[bool] = ...,
    variable: Optional[Union[str, Dict[str, float], Sequence[str]]] = ...,
    premise: Optional[str] = ...,
    generations: Optional[float] = ...,
    context_ignore: Optional[str] = ...,
    context_includes_siblings: Optional[bool] = ...,
    max_modules: Optional[int] = ...,
    max_passes: Optional[int] = ...,
    max_steps: Optional[int] = ...,
    max_depth: Optional[int] = ...,
    max_points: Optional[int] = ...,
    max_spheres: Optional[int] = ...,
    step: Optional[float] = ...,
    step_scale: Optional[float] = ...,
    angle: Optional[float] = ...,
    angle_scale: Optional[float] = ...,
    thickness: Optional[float] = ...,
    thickness_scale: Optional[float] = ...,
    gravity: Optional[float] = ...,
    random_scale: Optional[float] = ...,
    random_scale_all: Optional[bool] = ...,
    segments: Optional[int] = ...,
    continuous_length: Optional[bool] = ...,
    continuous_angles: Optional[bool] = ...,
    continuous_width: Optional[bool] = ...,
    pitch_up: Optional[bool] = ...,
    uv_increment: Optional[float] = ...,
    vertical_increment: Optional[float] = ...,
    start_position: Optional[Union[str, Tuple[float, float, float]]] = ...,
    start_rotation: Optional[Union[str, Tuple[float, float, float]]] = ...,
    emit: Optional[Literal["points", "leaves", "both"]] = ...,
    size: Optional[float] = ...,
    leaf_size: Optional[float] = ...,
    width_power: Optional[float] = ...,
    generation_power: Optional[float] = ...,
    radius_min: Optional[float] = ...,
    radius_max: Optional[float] = ...,
    top_falloff: Optional[float] = ...,
    jitter: Optional[float] = ...,
    base: Optional[Union[float, Literal["none"]]] = ...,
    squash: Optional[float] = ...,
    ceiling: Optional[Union[float, Literal["none"]]] = ...,
    flat: Optional[Union[float, Literal["none"]]] = ...,
    count: Optional[Union[int, Literal["none"]]] = ...,
    domain: Optional[Union[str, Tuple[float, float, float]]] = ...,
    connect: Optional[bool] = ...,
) -> Bake: ...
def check(
    path: _Path,
    *,
    progress: Optional[_Progress] = ...,
    close: Optional[Literal["auto", "wrap", "reject"]] = ...,
    truth_vertices: Optional[int] = ...,
    against: Optional[_Path] = ...,
    certificate: Optional[bool] = ...,
    with_lattice: Optional[_Path] = ...,
    max_angle: Optional[float] = ...,
    max_transmittance_rms: Optional[float] = ...,
    max_surface_rms: Optional[float] = ...,
    threads: Optional[int] = ...,
    memory: Optional[str] = ...,
    strict: Optional[bool] = ...,
) -> Dict[str, Any]: ...
def read(path_or_bytes: Union[str, os.PathLike[str], bytes, bytearray, memoryview]) -> Asset: ...
def write(path: _Path, bake_or_bytes: Union[Bake, bytes, bytearray, memoryview]) -> None: ...
def transmittance(lobes: ArrayLike, to_light: ArrayLike, exponent: float, bias: float, extinction: float) -> _Floats: ...
def presets() -> List[str]: ...
