"""The shader nodes that light a baked cloud in Cycles and Eevee, with a sun lamp that drives them. Needs only Blender 3.4 or newer."""

import json

import bpy
import numpy

GROUP = "Cloudbake lobe"
GROUP_VERSION = 2
MAPS = ("Cloudbake 1", "Cloudbake 2")  # the UV maps of the lobes, as glTF importers make them: (o.x, 1 - o.y) and (o.z, 1 - d)

# The default colours are those of the previewer's sky by day.
INPUTS = (
    ("Sun direction", "NodeSocketVector", (0.0, 0.0, 1.0)),
    ("Exponent", "NodeSocketFloat", 3.0),
    ("Bias", "NodeSocketFloat", -0.003),
    ("Extinction", "NodeSocketFloat", 7.0),
    ("Sun color", "NodeSocketColor", (1.08, 0.96, 0.78, 1.0)),
    ("Ambient sky", "NodeSocketColor", (0.09, 0.15, 0.27, 1.0)),
    ("Ambient ground", "NodeSocketColor", (0.028, 0.045, 0.082, 1.0)),
    ("Half Lambert", "NodeSocketFloat", 1.0),
    ("Phase share", "NodeSocketFloat", 0.0),
    ("Phase asymmetry", "NodeSocketFloat", 0.7),
    ("Phase limit", "NodeSocketFloat", 6.0),
    ("Base color", "NodeSocketColor", (1.0, 1.0, 1.0, 1.0)),
)
OUTPUTS = (
    ("Emission", "NodeSocketShader"),
    ("Color", "NodeSocketColor"),
    ("Sun", "NodeSocketFloat"),
    ("Sky", "NodeSocketFloat"),
    ("Has lobes", "NodeSocketFloat"),
)


def add_socket(tree, name, kind, default=None):
    """A socket of a group: an input with a default value, an output without one. Blender 4.0 moved them to tree.interface."""
    if hasattr(tree, "interface"):
        socket = tree.interface.new_socket(name=name, in_out="OUTPUT" if default is None else "INPUT", socket_type=kind)
    else:
        socket = (tree.outputs if default is None else tree.inputs).new(kind, name)
    if default is not None:
        socket.default_value = default


class Graph:
    """Adds nodes to a tree. Arguments are sockets or values, results are sockets."""

    def __init__(self, tree):
        self.tree, self.columns, self.rows = tree, {}, {}

    def node(self, kind, *arguments, **settings):
        node = self.tree.nodes.new(kind)
        for name, value in settings.items():
            setattr(node, name, value)
        sources = [self.connect(value, socket) for value, socket in zip(arguments, node.inputs) if value is not None]
        column = 1 + max((self.columns.get(source, 0) for source in sources if source), default=0)
        self.columns[node.name] = column
        self.rows[column] = self.rows.get(column, 0) + 1
        node.location = (200 * column, -180 * self.rows[column])
        return node

    def connect(self, value, socket):
        """The name of the node from which the value comes, if it is a socket."""
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
            return value.node.name
        socket.default_value = value
        return None

    def math(self, operation, *arguments):
        return self.node("ShaderNodeMath", *arguments, operation=operation).outputs[0]

    def vector(self, operation, *arguments):
        node = self.node("ShaderNodeVectorMath", *arguments, operation=operation)
        return node.outputs["Value" if operation in ("DOT_PRODUCT", "LENGTH") else "Vector"]

    def scaled(self, vector, factor):
        node = self.node("ShaderNodeVectorMath", vector, operation="SCALE")
        self.connect(factor, node.inputs["Scale"])
        return node.outputs["Vector"]

    def mixed(self, low, high, share):
        """low + (high - low) * share of two vectors or colours."""
        return self.vector("ADD", low, self.scaled(self.vector("SUBTRACT", high, low), share))


def lobe_in_world(graph):
    """The direction o and the thickness d from the two UV maps, moved by the object's matrix, and 1 where a mesh has the maps, else 0.
    A map that is missing is zero everywhere, which two maps of lobes never are at once."""
    pairs = [graph.node("ShaderNodeUVMap", uv_map=name).outputs["UV"] for name in MAPS]
    has_lobes = graph.math("GREATER_THAN", graph.math("ADD", *(graph.vector("LENGTH", pair) for pair in pairs)), 0.0)
    first, second = (graph.node("ShaderNodeSeparateXYZ", pair) for pair in pairs)
    y = graph.math("SUBTRACT", 1.0, first.outputs["Y"])
    d = graph.math("SUBTRACT", 1.0, second.outputs["Y"])
    # glTF has +Y up, Blender +Z.
    minus_z = graph.math("MULTIPLY", second.outputs["X"], -1.0)
    o = graph.node("ShaderNodeCombineXYZ", first.outputs["X"], minus_z, y).outputs["Vector"]
    moved = graph.node("ShaderNodeVectorTransform", graph.scaled(o, d), vector_type="VECTOR", convert_from="OBJECT", convert_to="WORLD")
    return graph.vector("NORMALIZE", moved.outputs["Vector"]), graph.vector("LENGTH", moved.outputs["Vector"]), has_lobes


def transmittance(graph, o, d, to_light, inputs):
    """T = exp(-sigma * max(0, max(0, l.o / 2 + 1/2)^k * d + b))."""
    half_cosine = graph.math("MAXIMUM", graph.math("MULTIPLY_ADD", graph.vector("DOT_PRODUCT", to_light, o), 0.5, 0.5), 0.0)
    power = graph.math("POWER", half_cosine, inputs["Exponent"])
    thickness = graph.math("MAXIMUM", graph.math("MULTIPLY_ADD", power, d, inputs["Bias"]), 0.0)
    return graph.math("EXPONENT", graph.math("MULTIPLY", graph.math("MULTIPLY", inputs["Extinction"], thickness), -1.0))


def surface_factor(graph, normal, to_sun, half_lambert):
    """The share of the sun that a surface shows: 1 is the lobe alone, less mixes in how the surface faces the sun."""
    facing = graph.math("MULTIPLY_ADD", graph.vector("DOT_PRODUCT", normal, to_sun), 0.5, 0.5)
    return graph.math("MULTIPLY_ADD", graph.math("SUBTRACT", 1.0, half_lambert), facing, half_lambert)


def phase_factor(graph, incoming, to_sun, inputs):
    """1 + share * (min(p, limit) - 1) with p = (1 - g^2) / (1 + g^2 - 2 g cos)^1.5; `incoming` points to the eye."""
    g = inputs["Phase asymmetry"]
    square = graph.math("MULTIPLY", g, g)
    cosine = graph.math("MULTIPLY", graph.vector("DOT_PRODUCT", incoming, to_sun), -1.0)
    below = graph.math("SUBTRACT", graph.math("ADD", square, 1.0), graph.math("MULTIPLY", graph.math("MULTIPLY", g, cosine), 2.0))
    phase = graph.math("DIVIDE", graph.math("SUBTRACT", 1.0, square), graph.math("POWER", below, 1.5))
    limited = graph.math("SUBTRACT", graph.math("MINIMUM", phase, inputs["Phase limit"]), 1.0)
    return graph.math("MULTIPLY_ADD", inputs["Phase share"], limited, 1.0)


def lobe_group():
    """The node group, which is made once per file."""
    for tree in bpy.data.node_groups:
        if tree.get("cloudbake_version") == GROUP_VERSION and tree.library is None:
            return tree
    tree = bpy.data.node_groups.new(GROUP, "ShaderNodeTree")
    tree["cloudbake_version"] = GROUP_VERSION
    for name, kind, default in INPUTS:
        add_socket(tree, name, kind, default)
    for name, kind in OUTPUTS:
        add_socket(tree, name, kind)

    graph = Graph(tree)
    inputs = graph.node("NodeGroupInput").outputs
    geometry = graph.node("ShaderNodeNewGeometry").outputs
    to_sun = graph.vector("NORMALIZE", inputs["Sun direction"])
    o, d, has_lobes = lobe_in_world(graph)
    sun = graph.math("MULTIPLY", transmittance(graph, o, d, to_sun, inputs),
                     surface_factor(graph, geometry["Normal"], to_sun, inputs["Half Lambert"]))
    sky = transmittance(graph, o, d, (0.0, 0.0, 1.0), inputs)
    ground = inputs["Ambient ground"]
    bright = graph.scaled(inputs["Sun color"], phase_factor(graph, geometry["Incoming"], to_sun, inputs))
    light = graph.vector("ADD", graph.mixed(ground, bright, sun), graph.mixed(ground, inputs["Ambient sky"], sky))
    color = graph.vector("MULTIPLY", light, inputs["Base color"])
    emission = graph.node("ShaderNodeEmission", color).outputs["Emission"]
    graph.node("NodeGroupOutput", emission, color, sun, sky, has_lobes)
    return tree


# ---- materials --------------------------------------------------------------------------------------------------------------------------

CONSTANTS = ("Exponent", "Bias", "Extinction")
CONSTANTS_KEY = "cloudbake_constants"  # of a mesh: k, b and sigma, which materials of several bakes read
ADDED_KEY = "cloudbake_nodes"          # of a material: what add_group added to it
PLAIN_KEY = "cloudbake_plain"          # of a material: it was made for objects that have none
SLOT_KEY = "cloudbake_slot"            # of a mesh: it had no slot


def group_nodes(tree):
    """The nodes of the group in a tree and in the groups in it."""
    for node in tree.nodes if tree else ():
        if node.type == "GROUP" and node.node_tree:
            if "cloudbake_version" in node.node_tree:
                yield node
            else:
                yield from group_nodes(node.node_tree)


def group_node(material):
    """The first node of the group in a material; None if there is none."""
    return next(group_nodes(material.node_tree), None)


def cloud_material(name):
    """A material of that name that shows lobes and nothing else. One that has the group already keeps its values."""
    material = next((m for m in bpy.data.materials if m.name == name and m.library is None and group_node(m)), None)
    if material is None:
        material = bpy.data.materials.new(name)
        use_nodes(material)
        material[PLAIN_KEY] = True
        material.node_tree.nodes.clear()
        node = new_group_node(material.node_tree)
        output = material.node_tree.nodes.new("ShaderNodeOutputMaterial")
        output.location = (300, 0)
        material.node_tree.links.new(node.outputs["Emission"], output.inputs["Surface"])
    return material


def use_nodes(material):
    """Whether it had none. From Blender 5.0 on every material has nodes."""
    had = material.node_tree is not None and (bpy.app.version >= (5, 0, 0) or material.use_nodes)
    if not had:
        material.use_nodes = True
    return not had


def new_group_node(tree):
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree, node.name, node.width = lobe_group(), GROUP, 220
    return node


def artists_outputs(tree):
    """The outputs that Eevee and Cycles use, which may be one and the same."""
    found = [tree.get_output_node(target) for target in ("EEVEE", "CYCLES")]
    return [node for number, node in enumerate(found) if node and node not in found[:number]]


def shader_before(output):
    """The first shader with a base colour that feeds an output's surface; None without one."""
    waiting = [link.from_node for link in output.inputs["Surface"].links] if output else []
    for node in waiting:  # which grows
        if node.type not in ("GROUP", "BSDF_TRANSPARENT") and base_color_input(node):
            return node
        waiting += [link.from_node for socket in node.inputs if socket.type == "SHADER" for link in socket.links if
                    link.from_node not in waiting]
    return None


def base_color_input(node):
    return node.inputs.get("Base Color") or (node.inputs.get("Color") if node.outputs and node.outputs[0].type == "SHADER" else None)


def opacity_before(output, shader):
    """The input that says how opaque a surface is, and whether it says the opposite: the Fac of a mix with a transparent shader, or the
    Alpha of the shader. None without one."""
    mix = next((link.from_node for link in output.inputs["Surface"].links), None) if output else None
    if mix and mix.type == "MIX_SHADER":
        clear = [any(link.from_node.type == "BSDF_TRANSPARENT" for link in socket.links) for socket in mix.inputs[1:]]
        if any(clear):
            return mix.inputs[0], clear[1]
    alpha = shader.inputs.get("Alpha") if shader else None
    return (alpha, False) if alpha and (alpha.is_linked or alpha.default_value < 1) else (None, False)


def feed(tree, target, source, value=None):
    """What feeds one input feeds another too: a link, or a value."""
    for link in tuple(target.links):
        tree.links.remove(link)
    if source is not None and source.is_linked:
        tree.links.new(source.links[0].from_socket, target)
    elif source is not None or value is not None:
        target.default_value = source.default_value if source is not None else value


def add_group(material):
    """Shows lobes in a material of the artist's: adds the group and an output beside the artist's own nodes, which stay as they are. The
    base colour and the opacity of the artist's shader are kept. A mesh without lobes shows the artist's shader. A second call follows what
    the artist has changed."""
    kept = material.get(ADDED_KEY)
    if kept is None and (material.get(PLAIN_KEY) or group_node(material)):
        return  # the artist placed the group
    record = json.loads(kept) if kept is not None else {"no_nodes": use_nodes(material)}
    tree = material.node_tree
    group = next((node for node in group_nodes(tree) if node.name == record.get("group")), None)
    take_nodes(material, record, keep=group)
    group = group or new_group_node(tree)
    outputs = artists_outputs(tree)
    record.update(group=group.name, added=[], outputs={})

    def add(kind, place, *sources):
        node = tree.nodes.new(kind)
        node.name, node.location = f"Cloudbake {node.name}", place
        record["added"].append(node.name)
        for source, socket in zip(sources, node.inputs):
            if source is not None:
                tree.links.new(source, socket)
        return node

    shader = None if record["no_nodes"] else shader_before(outputs[0] if outputs else None)
    feed(tree, group.inputs["Base color"], base_color_input(shader) if shader else None,
         tuple(material.diffuse_color) if record["no_nodes"] else None)
    surface, (opacity, is_opposite) = group.outputs["Emission"], opacity_before(outputs[0] if outputs else None, shader)
    record["colored"] = bool(shader or record["no_nodes"])
    right = max((node.location.x for node in outputs), default=0) + 300
    top = max((node.location.y for node in outputs), default=0)
    group.location = (right, top - 250)
    if opacity and not record["no_nodes"]:
        clear = add("ShaderNodeBsdfTransparent", (right, top - 150))
        sides = (surface, clear.outputs[0]) if is_opposite else (clear.outputs[0], surface)
        mix = add("ShaderNodeMixShader", (right + 300, top - 250), None, *sides)
        feed(tree, mix.inputs[0], opacity)
        surface = mix.outputs[0]
    for number, output in enumerate(outputs or [None]):
        place, own = (right + 500, top - 300 * number), surface
        links = output.inputs["Surface"].links if output else ()
        if links:
            own = add("ShaderNodeMixShader", place, group.outputs["Has lobes"], links[0].from_socket, surface).outputs[0]
        made = add("ShaderNodeOutputMaterial", (place[0] + 250, place[1]), own)
        if output:
            made.target, output.is_active_output = output.target, False
            for name in ("Volume", "Displacement"):
                feed(tree, made.inputs[name], output.inputs[name] if output.inputs[name].is_linked else None)
        made.is_active_output = True
        record["outputs"][made.name] = output.name if output else ""
    material[ADDED_KEY] = json.dumps(record)


def is_colored(material):
    """Whether add_group found a base colour."""
    return ADDED_KEY not in material or json.loads(material[ADDED_KEY])["colored"]


def show_group(material, shown):
    """Whether a material shows lobes, or what the artist's own nodes make of it."""
    record = json.loads(material[ADDED_KEY])
    for made, own in record["outputs"].items():
        for name, active in ((made, shown), (own, not shown)):
            if name in material.node_tree.nodes:
                material.node_tree.nodes[name].is_active_output = active
    if record["no_nodes"] and bpy.app.version < (5, 0, 0):
        material.use_nodes = shown


def take_nodes(material, record, keep=None):
    """Removes what add_group added, and gives the artist's outputs their place again."""
    if "outputs" not in record:
        return
    show_group(material, False)
    nodes = material.node_tree.nodes
    for name in record["added"] + [record["group"]]:
        if name in nodes and nodes[name] != keep:
            if name == record["group"]:
                nodes[name].inputs["Sun direction"].driver_remove("default_value")
            nodes.remove(nodes[name])
    if keep and record["no_nodes"]:
        use_nodes(material)


def remove_group(material):
    """A material as it was before add_group."""
    take_nodes(material, json.loads(material[ADDED_KEY]))
    del material[ADDED_KEY]


def set_up(thing, name, constants):
    """Shows the lobes of an object in the materials of all its slots, which stay. Slots without one get a material of that name. Returns
    the materials. constants: k, b and sigma of the asset."""
    thing.data[CONSTANTS_KEY] = [float(value) for value in constants]
    if not thing.material_slots:
        thing.data.materials.append(None)
        thing.data[SLOT_KEY] = True
    for slot in thing.material_slots:
        if slot.material is None:
            slot.material = cloud_material(name)
        add_group(slot.material)
    materials = {slot.material for slot in thing.material_slots}
    for material in materials:
        settle_constants(material)
    return materials


def take_down(thing):
    """An object's materials as they were before set_up. Returns how many slots were changed."""
    count = 0
    for slot in thing.material_slots:
        if slot.material and (slot.material.get(PLAIN_KEY) or ADDED_KEY in slot.material):
            count += 1
            if slot.material.get(PLAIN_KEY):
                slot.material = None
            else:
                remove_group(slot.material)
    if thing.data.pop(SLOT_KEY, None) and len(thing.data.materials) == 1:
        thing.data.materials.clear()  # pop leaves the slot of the object
    return count


def constants_of_users(material):
    """The k, b and sigma of the meshes that show a material, in 32 bits."""
    things = [thing for thing in bpy.data.objects if thing.type == "MESH" and CONSTANTS_KEY in thing.data]
    return {tuple(thing.data[CONSTANTS_KEY]) for thing in things if any(slot.material == material for slot in thing.material_slots)}


def settle_constants(material):
    """Gives a material the k, b and sigma of its mesh. If its meshes have several, it reads them from each mesh."""
    found, tree = constants_of_users(material), material.node_tree
    for group in group_nodes(tree):
        inputs = [group.inputs[name] for name in CONSTANTS]
        if len(found) == 1:
            for socket, value in zip(inputs, *found):
                for link in tuple(socket.links):
                    if link.from_node.name == CONSTANTS_KEY:
                        group.id_data.links.remove(link)
                socket.default_value = value
            if CONSTANTS_KEY in group.id_data.nodes:
                for name in (CONSTANTS_KEY, CONSTANTS_KEY + " read"):
                    group.id_data.nodes.remove(group.id_data.nodes[name])
        elif found and CONSTANTS_KEY not in group.id_data.nodes:
            read_constants(group.id_data, group, inputs)


def read_constants(tree, group, inputs):
    read, parts = tree.nodes.new("ShaderNodeAttribute"), tree.nodes.new("ShaderNodeSeparateXYZ")
    read.name, parts.name = CONSTANTS_KEY + " read", CONSTANTS_KEY
    read.attribute_type, read.attribute_name = "OBJECT", CONSTANTS_KEY
    read.location, parts.location = (group.location.x - 500, group.location.y), (group.location.x - 250, group.location.y)
    tree.links.new(read.outputs["Vector"], parts.inputs[0])
    for source, socket in zip(parts.outputs, inputs):
        if not socket.is_linked:
            tree.links.new(source, socket)


# ---- the UV maps of an import -----------------------------------------------------------------------------------------------------------


def take_maps(mesh, first, density_max):
    """Makes the UV maps of the lobes of those that a glTF importer made of the sets `first` and `first` + 1. density_max: that of a packed
    asset, else 0. Maps that have the names are the maps of the lobes already. Returns False if the mesh lacks the sets."""
    if len(mesh.uv_layers) < first + 2:
        return False
    layers = [mesh.uv_layers[first + number] for number in range(len(MAPS))]
    if density_max > 0 and [layer.name for layer in layers] != list(MAPS):
        if mesh.is_editmode:
            raise RuntimeError(f"the lobes of '{mesh.name}' are packed and cannot be read in Edit Mode: leave it first")
        unpack(layers, density_max)
    for number, name in enumerate(MAPS):
        if mesh.uv_layers[first + number].name != name:
            mesh.uv_layers[first + number].name = name
    return True


def unpack(layers, density_max):
    """Gives the UV maps of a packed asset the four floats that its integers stand for. Nodes cannot do so: they get numbers that are
    blended across a triangle, and the octahedron's numbers of neighbours may be far apart. Importers of Blender store 1 - v."""
    stored = []
    for layer in layers:
        values = numpy.empty(2 * len(layer.data), numpy.float32)
        layer.data.foreach_get("uv", values)
        stored.append(values.reshape(-1, 2).astype(numpy.float64) * (1, -1) + (0, 1))
    for layer, values in zip(layers, unpacked_lobes(stored[0], stored[1], density_max)):
        layer.data.foreach_set("uv", (values * (1, -1) + (0, 1)).astype(numpy.float32).ravel())


def unpacked_lobes(first, second, density_max):
    """The sets of the layout lobe-uv from those of a packed asset, both #V × 2 as glTF has them (docs/asset_format.md)."""
    height = 1 - numpy.abs(first).sum(axis=1)
    fold = numpy.maximum(-height, 0)[:, None]
    direction = numpy.column_stack([first - numpy.where(first < 0, -fold, fold), height])
    direction /= numpy.linalg.norm(direction, axis=1, keepdims=True)
    return direction[:, :2], numpy.column_stack([direction[:, 2], density_max * second[:, 1] ** 2])


# ---- the sun ----------------------------------------------------------------------------------------------------------------------------


def first_sun(scene):
    """The sun lamp whose name is first in the alphabet; None without one."""
    suns = [thing for thing in scene.objects if thing.type == "LIGHT" and thing.data.type == "SUN"]
    return min(suns, key=lambda thing: thing.name, default=None)


def follow_sun(material, sun):
    """Drivers turn the sun's direction with a lamp. They also work in animations, and in a Blender without this script. Returns whether the
    material has a group whose direction is not linked to something else."""
    sockets = [node.inputs["Sun direction"] for node in group_nodes(material.node_tree) if not node.inputs["Sun direction"].is_linked]
    for socket in sockets:
        socket.driver_remove("default_value")
        if sun is not None:
            drive(socket, sun)
    return bool(sockets)


def drive(socket, sun):
    # The lamp's own +Z axis in the world, from the quaternion of its rotation.
    axes = ("2 * (x * z + w * y)", "2 * (y * z - w * x)", "1 - 2 * (x * x + y * y)")
    for curve, expression in zip(socket.driver_add("default_value"), axes):
        for letter in "wxyz":
            variable = curve.driver.variables.new()
            variable.name, variable.type = letter, "TRANSFORMS"
            target = variable.targets[0]
            target.id, target.transform_space = sun, "WORLD_SPACE"
            target.transform_type, target.rotation_mode = f"ROT_{letter.upper()}", "QUATERNION"
        curve.driver.expression = expression
