"""The shader nodes that light a baked cloud in Cycles and Eevee, with a sun lamp that drives them. Needs only Blender 3.4 or newer."""

import bpy

GROUP = "Cloudbake lobe"
GROUP_VERSION = 1
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
)
OUTPUTS = (
    ("Emission", "NodeSocketShader"),
    ("Color", "NodeSocketColor"),
    ("Sun", "NodeSocketFloat"),
    ("Sky", "NodeSocketFloat"),
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
    """The direction o and the thickness d from the two UV maps, moved by the object's matrix."""
    first, second = (graph.node("ShaderNodeSeparateXYZ", graph.node("ShaderNodeUVMap", uv_map=name).outputs["UV"]) for name in MAPS)
    y = graph.math("SUBTRACT", 1.0, first.outputs["Y"])
    d = graph.math("SUBTRACT", 1.0, second.outputs["Y"])
    # glTF has +Y up, Blender +Z.
    minus_z = graph.math("MULTIPLY", second.outputs["X"], -1.0)
    o = graph.node("ShaderNodeCombineXYZ", first.outputs["X"], minus_z, y).outputs["Vector"]
    moved = graph.node("ShaderNodeVectorTransform", graph.scaled(o, d), vector_type="VECTOR", convert_from="OBJECT", convert_to="WORLD")
    return graph.vector("NORMALIZE", moved.outputs["Vector"]), graph.vector("LENGTH", moved.outputs["Vector"])


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
    o, d = lobe_in_world(graph)
    sun = graph.math("MULTIPLY", transmittance(graph, o, d, to_sun, inputs),
                     surface_factor(graph, geometry["Normal"], to_sun, inputs["Half Lambert"]))
    sky = transmittance(graph, o, d, (0.0, 0.0, 1.0), inputs)
    ground = inputs["Ambient ground"]
    bright = graph.scaled(inputs["Sun color"], phase_factor(graph, geometry["Incoming"], to_sun, inputs))
    color = graph.vector("ADD", graph.mixed(ground, bright, sun), graph.mixed(ground, inputs["Ambient sky"], sky))
    emission = graph.node("ShaderNodeEmission", color).outputs["Emission"]
    graph.node("NodeGroupOutput", emission, color, sun, sky)
    return tree


def group_node(material):
    """The node of the group in a material; None if there is none."""
    nodes = material.node_tree.nodes if material.node_tree else ()
    return next((node for node in nodes if node.type == "GROUP" and node.node_tree and "cloudbake_version" in node.node_tree), None)


def cloud_material(name, exponent, bias, extinction):
    """A material of that name with an asset's k, b and sigma. One that has the group already keeps its other values."""
    material = next((m for m in bpy.data.materials if m.name == name and m.library is None and group_node(m)), None)
    if material is None:
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        nodes = material.node_tree.nodes
        nodes.clear()
        node = nodes.new("ShaderNodeGroup")
        node.node_tree, node.name, node.width = lobe_group(), GROUP, 220
        output = nodes.new("ShaderNodeOutputMaterial")
        output.location = (300, 0)
        material.node_tree.links.new(node.outputs["Emission"], output.inputs["Surface"])
    set_constants(material, exponent, bias, extinction)
    return material


def set_constants(material, exponent, bias, extinction):
    """k, b and sigma of the asset that a material shows."""
    for name, value in (("Exponent", exponent), ("Bias", bias), ("Extinction", extinction)):
        group_node(material).inputs[name].default_value = value


def name_maps(mesh, first):
    """Gives the UV maps that a glTF importer made of the sets `first` and `first` + 1 the names that the group reads."""
    if len(mesh.uv_layers) < first + 2:
        return False
    for number, name in enumerate(MAPS):
        if mesh.uv_layers[first + number].name != name:
            mesh.uv_layers[first + number].name = name
    return True


def put_material(thing, material):
    """In all slots of an object's mesh."""
    if not thing.material_slots:
        thing.data.materials.append(material)
    for slot in thing.material_slots:
        slot.material = material


def first_sun(scene):
    """The sun lamp whose name is first in the alphabet; None without one."""
    suns = [thing for thing in scene.objects if thing.type == "LIGHT" and thing.data.type == "SUN"]
    return min(suns, key=lambda thing: thing.name, default=None)


def follow_sun(material, sun):
    """Drivers turn the sun's direction with a lamp. They also work in animations, and in a Blender without this script."""
    socket = group_node(material).inputs["Sun direction"]
    socket.driver_remove("default_value")
    if sun is None:
        return
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
