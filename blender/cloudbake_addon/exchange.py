"""Baked assets in and out: GLB files by Blender's own importer and exporter, with what those leave to do."""

import contextlib
import json
import os
import pathlib
import struct
import tempfile
import zlib
from typing import Any

import bpy
import numpy

from . import bake, glb, gltf_nodes, kept, nodes
from .engine import BakeError

# ---- import -----------------------------------------------------------------------------------------------------------------------------


def prepare_numpy():
    """Blender 3.4 asks for a name that numpy 1.24 has dropped, as in Debian 12."""
    if "bool" not in numpy.__dict__:
        setattr(numpy, "bool", bool)


def read_asset(path):
    """The JSON document of a file, its binary chunk (None of a .gltf), and asset.extras.cloudbake, whose numbers can be shown."""
    try:
        if path.lower().endswith(".glb"):
            document, binary = glb.read_glb(path)
        else:
            document, binary = json.loads(pathlib.Path(path).read_text(encoding="utf-8")), None
    except (OSError, ValueError, struct.error) as error:
        raise BakeError(f"'{path}' cannot be read: {error}") from None
    info = glb.asset_info(document)
    if info is None:
        raise BakeError(f"'{path}' is not a baked asset: it has no asset.extras.cloudbake of layout 'lobe-uv' or 'lobe-packed', "
                        "version 1")
    for name in ("exponent", "bias", "extinction", *(["density_max"] if info["layout"] == glb.PACKED else [])):
        value = info.get(name)
        if not isinstance(value, (int, float)) or not abs(value) <= numpy.finfo(numpy.float32).max:
            raise BakeError(f"'{path}' cannot be lit: asset.extras.cloudbake.{name} is {value!r}, not a finite number in 32 bits: bake "
                            f"it again")
    if info["layout"] == glb.PACKED and not info["density_max"] > 0:
        raise BakeError(f"'{path}' cannot be lit: asset.extras.cloudbake.density_max is {info['density_max']!r}, not above 0: bake it "
                        f"again")
    return document, binary, info


NUMBER = "cloudbake_number"  # in extras: of a node or a material in the file


def import_asset(context, path, sun):
    """Imports the file and gives its clouds their material. Returns words for the user."""
    document, binary, info = read_asset(path)
    is_packed = info["layout"] == glb.PACKED
    prepare_numpy()
    kind, before = {"node": bpy.data.objects, "material": bpy.data.materials}, (set(bpy.data.objects), set(bpy.data.materials))
    facts = document["asset"]["extras"].get(kept.KEY)
    if binary is None or not isinstance(facts, dict):
        import_file(path)
        facts = None
    else:  # numbers lead from what Blender makes back to the file
        for number, element in [*enumerate(document["nodes"]), *enumerate(document.get("materials", []))]:
            element.setdefault("extras", {})[NUMBER] = number
        unbind_white_texture(document, facts.get("white", []))
        with tempfile.TemporaryDirectory(prefix="cloudbake-") as folder:
            marked = os.path.join(folder, pathlib.Path(path).name)
            glb.write_glb(marked, document, binary)
            import_file(marked)
    made, materials = ([block for block in blocks if block not in old] for blocks, old in zip(kind.values(), before))
    density_max = info["density_max"] if is_packed else 0
    clouds = [thing for thing in made if thing.type == "MESH" and nodes.take_maps(thing.data, info["uv_sets"][0], density_max)]
    if not clouds:
        raise BakeError(f"no object of '{path}' has the UV maps of the lobes")
    if is_packed:
        info = {key: value for key, value in info.items() if key not in ("density_max", "certificate", "seal")} | {"layout": "lobe-uv"}
    if facts is not None:
        restore(context, document, facts, made, materials)
    depsgraph = context.evaluated_depsgraph_get()
    for number, thing in enumerate(clouds):
        part = bake.part_of(thing, depsgraph, False)
        alone = bool(info.get("separate"))
        name = f"{path} {info.get('input_hash', '')}{f' {number}' if alone else ''}"
        bake.set_info(thing.data, info, bake=name, objects=1 if alone else len(clouds), part=number, source=None, **bake.record_of(part))
    for thing in clouds:
        for material in nodes.set_up(thing, f"Cloudbake {pathlib.Path(path).stem}", bake.constants_of(info)):
            nodes.follow_sun(material, sun)
    return [f"'{path}' is packed: its lobes are four floats in Blender, and an export writes them as such"] if is_packed else []


def import_file(path):
    try:
        result = bpy.ops.import_scene.gltf(filepath=path, **known_options(bpy.ops.import_scene.gltf, {"import_scene_as_collection": False}))
    except RuntimeError as error:
        raise BakeError(f"Blender's glTF importer failed: {str(error).strip().splitlines()[-1]}") from None
    if "FINISHED" not in result:
        raise BakeError(f"Blender could not import '{path}'")


def known_options(operator, wanted):
    """Those that this version of Blender's operator has."""
    known = operator.get_rna_type().properties.keys()
    return {name: value for name, value in wanted.items() if name in known}


def restore(context, document, facts, made, materials):
    """What the exporter of the add-on wrote beside the glTF: kept.py has the list. made and materials: what Blender made of the file."""
    by_name = merge_materials(document, materials)
    for name, material in by_name.items():
        kept.restore_reads(material, facts["reads"].get(name, {}))
    for thing in made:
        number = thing.pop(NUMBER, None)
        node = document["nodes"][number] if number is not None else {}
        old = facts["objects"].get(node.get("name"))
        if old is None:
            continue
        kept.restore_collections(thing, old["collections"], facts["collections"], context.scene)
        if thing.type == "MESH" and "layers" in old:
            kept.restore_layers(thing.data, old["layers"])
            kept.restore_slots(thing, old["slots"], faces_of(document, node["mesh"], old["primitives"]), by_name)
    for material in [material for material in by_name.values() if not material.users]:  # which filled empty slots
        bpy.data.materials.remove(material)
    context.view_layer.update()


def merge_materials(document, materials):
    """Blender's exporter writes a material once for each number of a UV map that it reads. The first is kept, by the name in the file."""
    by_name: dict[str, Any] = {}
    for material in sorted((material for material in materials if NUMBER in material), key=lambda material: material[NUMBER]):
        first = by_name.setdefault(document["materials"][material.pop(NUMBER)]["name"], material)
        if first != material:
            material.user_remap(first)
            bpy.data.materials.remove(material)
    return by_name


def faces_of(document, mesh, slots):
    """The slot and the number of triangles of each primitive."""
    return [(slot, document["accessors"][primitive["indices"]]["count"] // 3)
            for slot, primitive in zip(slots, document["meshes"][mesh]["primitives"])]


# ---- export -----------------------------------------------------------------------------------------------------------------------------


def exported_info(things, depsgraph):
    """The metadata of the file, the names of the artist's UV maps in it (None: they are numbered object by object), and words."""
    if not things:
        raise BakeError("there is no cloud to export: select one that is baked")
    for thing in things:
        if bake.get_info(thing.data) is None or not set(nodes.MAPS) <= set(thing.data.uv_layers.keys()):
            raise BakeError(f"'{thing.name}' is not baked yet: press Bake")
        if bake.other_maps(thing.data) + 2 > bake.MAX_UV_MAPS:
            raise BakeError(f"'{thing.name}' has more than {bake.MAX_UV_MAPS} UV maps: delete some")
        bake.check_unchanged(thing, depsgraph)
    bake.check_places(things, depsgraph)
    infos = [bake.get_info(thing.data) for thing in things]
    assets = [info["asset"] for info in infos]
    if any(asset[key] != assets[0][key] for asset in assets for key in ("exponent", "bias", "extinction")):
        raise BakeError("these objects were baked apart, with other k, b and extinction: bake them together, or export each to its own "
                        "file")
    bakes, maps = bake.bakes_of(things), maps_of_file(things)
    asset: dict[str, Any] = {**assets[0], "uv_sets": [len(maps), len(maps) + 1]}
    if len(bakes) > 1:
        asset["separate"] = True
    is_part = len(bakes) == 1 and infos[0]["objects"] > len(things)
    if is_part or len(bakes) > 1:
        asset.pop("seal", None)  # which is that of all objects of one bake
    words = []
    if is_part:
        words.append(f"these are {len(things)} of {infos[0]['objects']} objects that were baked together: the others shade them")
    if None in maps:
        words.append(f"these objects have UV maps of more than {bake.MAX_UV_MAPS - 2} names, which a file has no room for: materials that "
                     "objects with other UV maps share may read another map")
    return asset, maps, words


def maps_of_file(things):
    """A UV map of one name has one number in all objects, because materials read it by that. If there are too many names, the maps are
    numbered object by object."""
    rows = [[name for name in thing.data.uv_layers.keys() if name not in nodes.MAPS] for thing in things]
    names = list(dict.fromkeys(name for row in rows for name in row))
    return names if len(names) + 2 <= bake.MAX_UV_MAPS else [None] * max(map(len, rows))


def export_asset(context, things, path):
    """Writes the objects as one asset. Returns words for the user."""
    depsgraph = context.evaluated_depsgraph_get()
    asset, order, words = exported_info(things, depsgraph)
    materials = {slot.material for thing in things for slot in thing.material_slots if slot.material}
    clones = {material: artists_material(material) for material in materials}
    copies = [plain_copy(context.scene, thing, depsgraph, order, clones) for thing in things]
    try:
        with tempfile.TemporaryDirectory(prefix="cloudbake-") as folder, filled_slots():
            plain = os.path.join(folder, "plain.glb")
            export_copies(context, copies, plain)
            document, binary = glb.read_glb(plain)
        meshes = {node["name"]: node["mesh"] for node in document["nodes"] if "mesh" in node}
        numbers = [meshes[copy.name] for copy in copies]
        primitives = [sorted(set(bake.table(copy.data.polygons, "material_index", 1, numpy.int32)[:, 0].tolist())) for copy in copies]
        maps, by_name = [copy.data.uv_layers.keys() for copy in copies], {clone.name: material for material, clone in clones.items()}
    finally:
        for copy in copies:
            bpy.data.meshes.remove(copy.data)  # and with it the object
        for clone in clones.values():
            bpy.data.materials.remove(clone)
    names = name_objects(things)
    for element in document.get("materials", []):
        material = by_name.get(element.get("name"))
        element["name"] = material.name if material else element.get("name", "")
        put_extras(element, material, words)
    write_nodes(document, context.scene, depsgraph, things, numbers, names, words)
    white = bind_white_texture(document, binary, len(order))
    document["asset"].setdefault("extras", {}).update({"cloudbake": asset, kept.KEY: {
        "version": 1, "collections": kept.parents_of_collections(context.scene), "white": white,
        "reads": {material.name: kept.reads_of(material) for material in materials},
        "objects": facts_of(context.scene, depsgraph, things, names, primitives, maps)}})
    try:
        glb.write_glb(path, document, binary)
    except OSError as error:
        raise BakeError(f"'{path}' cannot be written: {error.strerror}") from None
    return words


def name_objects(things):
    """The names of objects in the file. One whose modifiers were applied has the name of the object with the modifiers."""
    names = {thing: thing.name for thing in things}
    for thing in things:
        source = bake.source_of(thing)
        if source and source.name not in names.values():
            names[thing] = source.name
    return names


def plain_copy(scene, thing, depsgraph, order, clones):
    """An object with the mesh that was baked and nothing else, with its UV maps in the order of maps_of_file and its lobes behind. Whatever
    the exporter does with modifiers, shape keys and skins, it cannot change this mesh."""
    info = bake.get_info(thing.data)
    mesh = thing.data.copy() if info.get("base", info.get("shape") == "base") else bake.evaluated_mesh(thing, depsgraph)
    copy = bpy.data.objects.new("cloudbake export", mesh)
    copy.shape_key_clear()
    scene.collection.objects.link(copy)
    set_maps(mesh, thing.data, order)
    set_slots(mesh, thing, clones)
    return copy


def set_maps(mesh, own, order):
    """The artist's UV maps in that order, zeros for those that the mesh lacks, then the lobes."""
    names = [name for name in own.uv_layers.keys() if name not in nodes.MAPS]
    if None in order:
        order = names + order[len(names):]
    render = next((layer.name for layer in own.uv_layers if layer.active_render), None)
    source = {name: mesh if name in mesh.uv_layers and name not in nodes.MAPS else own for name in [*names, *nodes.MAPS]}
    values = {name: bake.table(source[name].uv_layers[name].data, "uv", 2, numpy.float32) for name in source}
    zeros = numpy.tile(numpy.array([0, 1], numpy.float32), len(mesh.loops))  # as glTF has them: Blender's exporter turns v over
    while mesh.uv_layers:
        mesh.uv_layers.remove(mesh.uv_layers[0])
    for number, name in enumerate([*order, *nodes.MAPS]):
        layer = mesh.uv_layers.new(name=name or f"cloudbake {number}", do_init=False)
        layer.data.foreach_set("uv", values.get(name, zeros).ravel())
    if render in mesh.uv_layers:
        mesh.uv_layers[render].active_render = True


def set_slots(mesh, thing, clones):
    """The clones of the materials of the object's slots, wherever they are linked."""
    faces = bake.table(mesh.polygons, "material_index", 1, numpy.int32)
    mesh.materials.clear()
    for slot in thing.material_slots:
        mesh.materials.append(clones.get(slot.material))
    mesh.polygons.foreach_set("material_index", numpy.minimum(faces, max(len(thing.material_slots) - 1, 0)).ravel())


def artists_material(material):
    """A clone of a material as the artist made it, without what shows the lobes. Only exported meshes use it, because Blender's exporter
    numbers the UV map of a texture by any mesh that uses the material."""
    clone = material.copy()
    if nodes.ADDED_KEY in clone:
        nodes.remove_group(clone)
    return clone


@contextlib.contextmanager
def filled_slots():
    """Blender 3.4's exporter of materials that name a UV map fails on empty slots of any mesh in the file: they have a material meanwhile.
    In exported meshes it also gets the white texture that keeps the UV sets."""
    filler = bpy.data.materials.new("Cloudbake white")
    filler.diffuse_color = (1, 1, 1, 1)
    meshes = [mesh for mesh in bpy.data.meshes if not mesh.library]
    empty = [(mesh, number) for mesh in meshes for number, material in enumerate(mesh.materials) if not material]
    for mesh, number in empty:
        mesh.materials[number] = filler
    try:
        yield
    finally:
        for mesh, number in empty:
            mesh.materials[number] = None
        bpy.data.materials.remove(filler)


def export_copies(context, copies, path):
    """By Blender's exporter, which takes the selection. The selection is as it was afterwards."""
    layer = context.view_layer
    selected, active = [thing for thing in layer.objects if thing.select_get()], layer.objects.active
    wanted = {"export_format": "GLB", "use_selection": True, "use_active_scene": True, "export_apply": False, "export_skins": False,
              "export_morph": False, "export_animations": False, "export_extras": False, "export_texcoords": True, "export_normals": True,
              "export_yup": True}
    for thing in selected:
        thing.select_set(False)
    try:
        for copy in copies:
            copy.select_set(True)
        bpy.ops.export_scene.gltf(filepath=path, **known_options(bpy.ops.export_scene.gltf, wanted))
    except RuntimeError as error:
        raise BakeError(f"Blender's glTF exporter failed: {str(error).strip().splitlines()[-1]}") from None
    finally:
        for copy in copies:
            copy.select_set(False)
        for thing in selected:
            thing.select_set(True)
        layer.objects.active = active


def put_extras(element, block, words):
    if block is not None and (extras := kept.extras_of(block, words)):
        element["extras"] = extras


def write_nodes(document, scene, depsgraph, things, meshes, names, words):
    """The objects below their parents, which become nodes without a mesh if they are no clouds of this file. Materials and meshes are those
    of Blender's exporter; nodes are not, because it has no place for sheared matrices and for parents that are not exported."""
    document.update(nodes=[], scenes=[{"name": scene.name, "nodes": []}], scene=0)
    put_extras(document["scenes"][0], scene, words)
    turn = numpy.eye(4)
    turn[:3, :3] = bake.AXES
    mesh_of, done = dict(zip(things, meshes)), {}

    def world(thing):
        return turn @ numpy.array(thing.evaluated_get(depsgraph).matrix_world, dtype=float) @ turn.T

    def visit(thing):
        if thing not in done:
            above = visit(thing.parent) if thing.parent else None
            if above is not None and abs(numpy.linalg.det(world(thing.parent))) < 1e-30:
                above = None  # a scale of 0, which has no inverse
            local = numpy.linalg.solve(world(thing.parent), world(thing)) if above is not None else world(thing)
            content = {"name": names.get(thing, thing.name)}
            source = bake.source_of(thing) or thing
            if thing in mesh_of:
                content["mesh"] = mesh_of[thing]
                mesh = document["meshes"][mesh_of[thing]]
                mesh["name"] = source.data.name if names[thing] == source.name else thing.data.name
                put_extras(mesh, thing.data, words)
            put_extras(content, thing, words)
            done[thing] = gltf_nodes.add_node(document, local, above, content)
        return done[thing]

    for thing in things:
        visit(thing)


def facts_of(scene, depsgraph, things, names, primitives, maps):
    """By the names of the nodes, what kept.py keeps. primitives: the slots of each object's primitives. maps: of the copies."""
    facts = {}
    for thing, slots, layers in zip(things, primitives, maps):
        own = kept.layers_of(thing.data)
        own["maps"] = [name if name in own["maps"] else None for name in layers]
        facts[names[thing]] = {"collections": kept.collections_of(bake.source_of(thing) or thing, scene), "layers": own,
                               "slots": kept.slots_of(thing), "primitives": slots}
        above = thing.parent
        while above:
            facts.setdefault(names.get(above, above.name), {"collections": kept.collections_of(above, scene)})
            above = above.parent
    return facts


def has_texture(value):
    """Whether a material, or an extension in it, uses a texture: an object with an index under a key ...Texture."""
    if not isinstance(value, dict):
        return False
    return any(key.endswith("Texture") and isinstance(inner, dict) and "index" in inner or key != "extras" and has_texture(inner)
               for key, inner in value.items())


def bind_white_texture(document, binary, first):
    """Optimisers delete UV sets that no texture uses: materials without textures get a white one, of two pixels. Returns their names."""
    bare = [material for material in document.get("materials", []) if not has_texture(material)]
    if not bare:
        return []
    images, textures = document.setdefault("images", []), document.setdefault("textures", [])
    images.append({"name": "white", "mimeType": "image/png", "bufferView": glb.add_bytes(document, binary, white_png())})
    textures.append({"source": len(images) - 1})
    for material in bare:
        material.setdefault("pbrMetallicRoughness", {})["baseColorTexture"] = {"index": len(textures) - 1, "texCoord": first}
        material["occlusionTexture"] = {"index": len(textures) - 1, "texCoord": first + 1}
    return [material["name"] for material in bare]


def unbind_white_texture(document, names):
    """Takes from those materials what bind_white_texture gave them."""
    for material in document.get("materials", []):
        if material.get("name") in names:
            material.get("pbrMetallicRoughness", {}).pop("baseColorTexture", None)
            material.pop("occlusionTexture", None)


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
