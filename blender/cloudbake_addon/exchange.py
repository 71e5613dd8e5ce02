"""Baked assets in and out: GLB files by Blender's own importer and exporter, with what those leave to do."""

import json
import os
import pathlib
import struct
import tempfile
import zlib
from typing import Any

import bpy
import numpy

from . import bake, glb, nodes
from .engine import BakeError

# ---- import -----------------------------------------------------------------------------------------------------------------------------


def prepare_numpy():
    """Blender 3.4 asks for a name that numpy 1.24 has dropped, as in Debian 12."""
    if "bool" not in numpy.__dict__:
        setattr(numpy, "bool", bool)


def info_of_file(path):
    try:
        document = glb.read_glb(path)[0] if path.lower().endswith(".glb") else json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
    except (OSError, ValueError, struct.error) as error:
        raise BakeError(f"'{path}' cannot be read: {error}") from None
    info = glb.asset_info(document)
    if info is None:
        raise BakeError(f"'{path}' is not a baked asset: it has no asset.extras.cloudbake of layout 'lobe-uv' 1")
    for name in ("exponent", "bias", "extinction"):
        value = info.get(name)
        if not isinstance(value, (int, float)) or not abs(value) <= numpy.finfo(numpy.float32).max:
            raise BakeError(f"'{path}' cannot be lit: asset.extras.cloudbake.{name} is {value!r}, not a finite number in 32 bits: bake "
                            f"it again")
    return info


def import_asset(path, sun):
    """Imports the file and gives its clouds their material. Returns the clouds."""
    info = info_of_file(path)
    prepare_numpy()
    before = set(bpy.data.objects)
    if "FINISHED" not in bpy.ops.import_scene.gltf(filepath=path):
        raise BakeError(f"Blender could not import '{path}'")
    new = [thing for thing in bpy.data.objects if thing not in before and thing.type == "MESH"]
    clouds = [thing for thing in new if nodes.name_maps(thing.data, info["uv_sets"][0])]
    if not clouds:
        raise BakeError(f"no object of '{path}' has the UV maps of the lobes")
    material = nodes.cloud_material(f"Cloudbake {pathlib.Path(path).stem}", info["exponent"], info["bias"], info["extinction"])
    nodes.follow_sun(material, sun)
    for thing in clouds:
        bake.set_info(thing.data, info, bake=f"{path} {info.get('input_hash', '')}", objects=len(clouds), shape="evaluated")
        nodes.put_material(thing, material)
    return clouds


# ---- export -----------------------------------------------------------------------------------------------------------------------------


def exported_info(things):
    """The metadata of the file, its first UV set, whether modifiers are applied, and words."""
    if not things:
        raise BakeError("there is no cloud to export: select one that is baked")
    infos = []
    for thing in things:
        info = bake.get_info(thing.data)
        names = [layer.name for layer in thing.data.uv_layers]
        if info is None or not set(nodes.MAPS) <= set(names):
            raise BakeError(f"'{thing.name}' is not baked yet")
        if names.index(nodes.MAPS[1]) != names.index(nodes.MAPS[0]) + 1:
            raise BakeError(f"the UV maps of '{thing.name}' are not beside each other any more: bake it again")
        infos.append((info, names.index(nodes.MAPS[0])))
    assets = [info["asset"] for info, _ in infos]
    if any(asset[key] != assets[0][key] for asset in assets for key in ("exponent", "bias", "extinction")):
        raise BakeError("these objects were baked apart, with other k, b and extinction: bake them together, or export each to its own "
                        "file")
    if len({info["shape"] for info, _ in infos}) > 1:
        raise BakeError("some of these objects were baked without their modifiers and some with them: bake them together")
    first, bakes = max(first for _, first in infos), {info["bake"] for info, _ in infos}
    asset: dict[str, Any] = {**assets[0], "uv_sets": [first, first + 1]}
    if len(bakes) > 1:
        asset["separate"] = True
    is_part = len(bakes) == 1 and infos[0][0]["objects"] > len(things)
    if is_part or len(bakes) > 1:
        asset.pop("seal", None)  # which is that of all objects of one bake
    words = []
    if is_part:
        words.append(f"these are {len(things)} of {infos[0][0]['objects']} objects that were baked together: the others shade them")
    return asset, first, infos[0][0]["shape"] == "evaluated", words


def export_asset(context, things, path):
    """Writes the objects as one asset. Returns words for the user."""
    asset, first, applied, words = exported_info(things)
    matrices = {thing.name: bake.AXES @ numpy.array(thing.matrix_world, dtype=float)[:3, :3] @ bake.AXES.T for thing in things}
    with tempfile.TemporaryDirectory(prefix="cloudbake-") as folder:
        plain = os.path.join(folder, "plain.glb")
        export_selected(context, things, plain, applied)
        document, binary = glb.read_glb(plain)
    lobe_sets = {thing.name: [layer.name for layer in thing.data.uv_layers].index(nodes.MAPS[0]) for thing in things}
    align_sets(document, binary, lobe_sets, first)
    restore_shears(document, matrices)
    bind_white_texture(document, binary, first, {slot.material.name for thing in things for slot in thing.material_slots if slot.material})
    document["asset"].setdefault("extras", {})["cloudbake"] = asset
    try:
        glb.write_glb(path, document, binary)
    except OSError as error:
        raise BakeError(f"'{path}' cannot be written: {error.strerror}") from None
    return words


def export_selected(context, things, path, applied):
    """By Blender's exporter, which takes the selection. The selection is as it was afterwards."""
    layer = context.view_layer
    selected, active = [thing for thing in layer.objects if thing.select_get()], layer.objects.active
    for thing in selected:
        thing.select_set(False)
    try:
        for thing in things:
            thing.select_set(True)
            if not thing.select_get():
                raise BakeError(f"'{thing.name}' is hidden: show it first")
        bpy.ops.export_scene.gltf(filepath=path, export_format="GLB", use_selection=True, export_apply=applied, export_skins=False,
                                  export_animations=False, export_texcoords=True, export_yup=True)
    finally:
        for thing in layer.objects:
            thing.select_set(thing in selected)
        layer.objects.active = active


def align_sets(document, binary, lobe_sets, first):
    """Moves the lobes of all primitives to the sets `first` and `first` + 1. Lower sets that are missing become zeros."""
    nodes_of_clouds = [node for node in document["nodes"] if "mesh" in node and node.get("name") in lobe_sets]
    moved = {node["mesh"]: (node["name"], lobe_sets[node["name"]]) for node in nodes_of_clouds}
    for number, (name, own) in moved.items():
        for primitive in document["meshes"][number]["primitives"] if own != first else ():
            attributes = primitive["attributes"]
            if f"TEXCOORD_{own + 2}" in attributes:
                raise BakeError(f"'{name}' has UV maps behind those of the lobes: bake it again after you removed '{nodes.MAPS[0]}'")
            pair = [attributes.pop(f"TEXCOORD_{own + i}") for i in range(2)]
            for missing in range(own, first):
                zeros = numpy.zeros((document["accessors"][pair[0]]["count"], 2), numpy.float32)
                attributes[f"TEXCOORD_{missing}"] = glb.add_table(document, binary, zeros)
            attributes.update({f"TEXCOORD_{first + i}": accessor for i, accessor in enumerate(pair)})


def turn_matrix(turn):
    x, y, z, w = turn
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def turn_of(matrix):
    """The quaternion (x, y, z, w) of a rotation: the eigenvector of Bar-Itzhack's matrix (2000) with the largest eigenvalue."""
    m = matrix
    k = numpy.array([[m[0, 0] - m[1, 1] - m[2, 2], m[1, 0] + m[0, 1], m[2, 0] + m[0, 2], m[2, 1] - m[1, 2]],
                     [m[1, 0] + m[0, 1], m[1, 1] - m[0, 0] - m[2, 2], m[2, 1] + m[1, 2], m[0, 2] - m[2, 0]],
                     [m[2, 0] + m[0, 2], m[2, 1] + m[1, 2], m[2, 2] - m[0, 0] - m[1, 1], m[1, 0] - m[0, 1]],
                     [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], m[0, 0] + m[1, 1] + m[2, 2]]])
    return numpy.linalg.eigh(k / 3)[1][:, 3].tolist()


def restore_shears(document, matrices):
    """A node's translation, rotation and scale cannot hold a sheared matrix. Two nodes can: M = U·S·Vᵀ, a turn and a scale, then a turn.
    matrices: the linear part by the name of the object, in scene space."""
    def visit(number, parent):
        node = document["nodes"][number]
        local = turn_matrix(node.get("rotation", (0, 0, 0, 1))) * numpy.array(node.get("scale", (1, 1, 1)))
        wanted = matrices.get(node.get("name")) if "mesh" in node else None
        below = node.get("children", [])
        if wanted is not None and numpy.abs(parent @ local - wanted).max() > 1e-5 * numpy.abs(wanted).max():
            local = numpy.linalg.solve(parent, wanted)
            split_node(document, node, local)
        for child in below:
            visit(child, parent @ local)

    for root in document["scenes"][document.get("scene", 0)]["nodes"]:
        visit(root, numpy.eye(3))


def split_node(document, node, local):
    """The node keeps its place and gets U·S. Its mesh and its children move to a new node below it, which gets Vᵀ and the name."""
    u, s, v = numpy.linalg.svd(local)
    if numpy.linalg.det(v) < 0:
        v, s = v * [[-1], [1], [1]], s * [-1, 1, 1]
    if numpy.linalg.det(u) < 0:
        u, s = u * [-1, 1, 1], s * [-1, 1, 1]
    inner = {key: node.pop(key) for key in ("mesh", "name", "children") if key in node}
    node.update(name=inner["name"] + ".shear", rotation=turn_of(u), scale=s.tolist(), children=[len(document["nodes"])])
    document["nodes"].append({**inner, "rotation": turn_of(v)})


def has_texture(value):
    """Whether a material, or an extension in it, uses a texture: an object with an index under a key ...Texture."""
    if not isinstance(value, dict):
        return False
    return any(key.endswith("Texture") and isinstance(inner, dict) and "index" in inner or key != "extras" and has_texture(inner)
               for key, inner in value.items())


def bind_white_texture(document, binary, first, names):
    """Optimisers delete UV sets that no texture uses: materials of clouds without textures get a white one, of two pixels."""
    bare = [material for material in document.get("materials", []) if material.get("name") in names and not has_texture(material)]
    if not bare:
        return
    images, textures = document.setdefault("images", []), document.setdefault("textures", [])
    images.append({"name": "white", "mimeType": "image/png", "bufferView": glb.add_bytes(document, binary, white_png())})
    textures.append({"source": len(images) - 1})
    for material in bare:
        material.setdefault("pbrMetallicRoughness", {})["baseColorTexture"] = {"index": len(textures) - 1, "texCoord": first}
        material["occlusionTexture"] = {"index": len(textures) - 1, "texCoord": first + 1}


def white_png():
    """Two pixels, of which one is not quite opaque, because a plain image would be turned into a factor."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"\0" + bytes([255, 255, 255, 255, 255, 255, 255, 250])
    head = struct.pack(">IIBBBBB", 2, 1, 8, 6, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def file_names(names):
    """A file name for each object name: characters that some system forbids become _, and equal names get a number."""
    chosen: list[str] = []
    for name in names:
        stem = "".join("_" if letter in '\\/:*?"<>|' or ord(letter) < 32 else letter for letter in name).rstrip(". ") or "_"
        number, candidate = 2, stem
        while candidate.casefold() in {other.casefold() for other in chosen}:
            candidate, number = f"{stem}_{number}", number + 1
        chosen.append(candidate)
    return chosen
