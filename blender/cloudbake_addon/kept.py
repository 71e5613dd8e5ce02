"""What glTF has no place for, but an artist wants back: names of UV maps and slots, collections, custom properties. Exports write it to
asset.extras.cloudbake_blender and to the extras of nodes, meshes, materials and the scene; the add-on's import restores it."""

import math

import bpy

KEY = "cloudbake_blender"
OWN = {"cloudbake", "cloudbake_constants", "cloudbake_nodes", "cloudbake_plain", "cloudbake_slot", "cloudbake_source", KEY}
BLENDERS = {"_RNA_UI", "cycles", "cycles_visibility", "cycles_curves", "glTF2ExportSettings"}

# ---- custom properties ------------------------------------------------------------------------------------------------------------------


def plain(value):
    """A custom property's value as JSON can hold it; None if it cannot."""
    if isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if hasattr(value, "to_dict"):
        value = value.to_dict()
    if hasattr(value, "to_list"):
        value = value.to_list()
    if isinstance(value, dict):
        found = {key: plain(inner) for key, inner in value.items()}
        return None if None in found.values() else found
    if isinstance(value, (list, tuple)):
        rows = [plain(inner) for inner in value]
        return None if None in rows else rows
    return None


def extras_of(block, words):
    """The custom properties of an object, a mesh, a material or a scene. `words` gets those that JSON cannot hold."""
    extras = {}
    for key in block.keys():
        if key in OWN or key in BLENDERS or key in block.bl_rna.properties:
            continue
        extras[key] = plain(block[key])
        if extras[key] is None:
            del extras[key]
            words.append(f"custom property '{key}' of '{block.name}' is left out: it is neither a finite number, a text nor a list of them")
    return extras


# ---- objects ----------------------------------------------------------------------------------------------------------------------------


def collections_of(thing, scene):
    """The names of an object's collections. The collection of the scene has none."""
    return [None if collection == scene.collection else collection.name for collection in thing.users_collection]


def parents_of_collections(scene):
    """The names of the collections of a scene, with those of the collections that hold them, outer ones first."""
    found: dict[str, list[str | None]] = {}

    def visit(collection, name):
        for child in collection.children:
            found.setdefault(child.name, []).append(name)
            visit(child, child.name)

    visit(scene.collection, None)
    return found


def layers_of(mesh):
    """The names of a mesh's UV maps, and those of the active one and the one that renders show."""
    layers = mesh.uv_layers
    return {"maps": layers.keys(), "active": layers.active.name if layers.active else None,
            "render": next((layer.name for layer in layers if layer.active_render), None)}


def slots_of(thing):
    """Those of the artist: materials that the add-on made for empty slots are left out."""
    if thing.data.get("cloudbake_slot"):
        return []
    names = [slot.material.name if slot.material and not slot.material.get("cloudbake_plain") else None for slot in thing.material_slots]
    return [{"material": name, "link": slot.link} for name, slot in zip(names, thing.material_slots)]


def texture_nodes(material):
    return [node for node in material.node_tree.nodes if node.type == "TEX_IMAGE" and node.image] if material.node_tree else []


def map_node_before(node):
    """The node that names the UV map which a texture is read from; None if the texture is read from the one that renders show."""
    for link in node.inputs["Vector"].links if "Vector" in node.inputs else ():
        if link.from_node.type == "UVMAP":
            return link.from_node
        return map_node_before(link.from_node)
    return None


def reads_of(material):
    """The UV maps that textures are read from, by the names of their images."""
    return {node.image.name: (before.uv_map or None) if (before := map_node_before(node)) else None for node in texture_nodes(material)}


def restore_reads(material, kept):
    """kept: of reads_of. Blender's importer numbers UV maps."""
    tree = material.node_tree
    for node in texture_nodes(material):
        name, before = node.image.name, map_node_before(node)
        name = name if name in kept else name.rpartition(".")[0]
        if name not in kept:
            continue
        if kept[name] is None and before:
            tree.nodes.remove(before)
        elif kept[name] is not None:
            if before is None:
                before = tree.nodes.new("ShaderNodeUVMap")
                before.location = (node.location.x - 250, node.location.y)
                tree.links.new(before.outputs["UV"], first_input(node))
            before.uv_map = kept[name]


def first_input(node):
    """The input at the beginning of what feeds a texture's vector: it may be mapped."""
    socket = node.inputs["Vector"]
    return first_input(socket.links[0].from_node) if socket.is_linked and "Vector" in socket.links[0].from_node.inputs else socket


def restore_layers(mesh, kept):
    """kept: of layers_of, None for a map that only fills a place in the file."""
    if len(kept["maps"]) != len(mesh.uv_layers):
        return
    for number, name in enumerate(kept["maps"]):  # first names that cannot be in the way
        mesh.uv_layers[number].name = f"cloudbake {number}"
    for number, name in enumerate(kept["maps"]):
        mesh.uv_layers[f"cloudbake {number}"].name = name or f"cloudbake {number}"
    for number, name in enumerate(kept["maps"]):
        if name is None:
            mesh.uv_layers.remove(mesh.uv_layers[f"cloudbake {number}"])
    layers = mesh.uv_layers
    if kept["active"] in layers:
        layers.active = layers[kept["active"]]
    if kept["render"] in layers:
        layers[kept["render"]].active_render = True


def restore_slots(thing, kept, faces, materials):
    """kept: of slots_of. faces: how many triangles each slot has, in the order of the file. materials: imported ones by their old names."""
    mesh = thing.data
    if not kept:
        mesh.materials.clear()
        return
    if sum(count for _, count in faces) != len(mesh.polygons) or any(slot >= len(kept) for slot, _ in faces):
        return
    mesh.materials.clear()
    for _ in kept:
        mesh.materials.append(None)
    for slot, old in zip(thing.material_slots, kept):
        slot.link = old["link"]
        slot.material = materials.get(old["material"])
    mesh.polygons.foreach_set("material_index", [slot for slot, count in faces for _ in range(count)])
    mesh.update()


def restore_collections(thing, names, parents, scene):
    """Puts an object into the collections of those names, which are made where the scene has none."""
    wanted = [collection_of(name, parents, scene) for name in names]
    if not wanted:
        return
    for collection in wanted:
        if thing.name not in collection.objects:
            collection.objects.link(thing)
    for collection in tuple(thing.users_collection):
        if collection not in wanted:
            collection.objects.unlink(thing)


def collection_of(name, parents, scene):
    if name is None:
        return scene.collection
    there = {child.name: child for child in scene.collection.children_recursive}
    if name in there:
        return there[name]
    made = bpy.data.collections.new(name)
    for parent in parents.get(name, [None]):
        collection_of(parent, parents, scene).children.link(made)
    return made
