"""The settings of a scene, which are options of `cloudbake bake`, and the preferences."""

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, PointerProperty, StringProperty

from .engine import BakeError, parse_options

# Options that the add-on sets itself, or that have no meaning inside Blender.
RESERVED = {"output", "json", "quiet", "up", "units", "uv_set", "scene_index", "separate", "attribute", "basis", "lattice", "lattice_cells",
            "keep_alive_texture", "allow_outside", "grid", "iso", "help", "help_all"}


def names(*rows):
    return [(key, label, text) for key, label, text in rows]


class CloudbakeSettings(bpy.types.PropertyGroup):
    __annotations__ = {  # which Blender makes properties of
        "scope": EnumProperty(name="Bake", default="SELECTED", description="Which objects are baked", items=names(
            ("ACTIVE", "Active object", "The active object alone"),
            ("SELECTED", "Selected objects", "All selected meshes"),
            ("COLLECTION", "Collection", "All visible meshes of a collection and its children"))),
        "collection": PointerProperty(name="Collection", type=bpy.types.Collection, description="Without one, the active collection"),
        "each": BoolProperty(name="Each alone", description="Every object is a cloud of its own. Otherwise all shade each other"),
        "shape": EnumProperty(name="Shape", default="EVALUATED", description="What is done with modifiers", items=names(
            ("EVALUATED", "With modifiers", "The shape that modifiers give. Those that make new vertices are refused"),
            ("BASE", "Base mesh", "The shape without modifiers and shape keys"))),
        "make_material": BoolProperty(name="Material", default=True,
                                      description="Gives objects without a material the one that shows the lobes"),
        "sun": PointerProperty(name="Sun", type=bpy.types.Object, description="Without one, the scene's first sun lamp",
                             poll=lambda self, thing: thing.type == "LIGHT" and thing.data.type == "SUN"),

        # The options of the program, by their names there.
        "rays": IntProperty(name="Directions", default=100, min=2, max=100000, step=2,
                            description="Directions per vertex; even for a sweep"),
        "voxels": IntProperty(name="Voxels", default=100, min=4, max=4096, description="Voxels along the longest side"),
        "target_error": StringProperty(name="Target error", description="Finds directions and voxels: 0.5 (degrees) or 1% (of T)"),
        "lobe": EnumProperty(name="Lobe", default="mean", items=names(
            ("mean", "Mean", "Occlusion direction and thickness"), ("fit", "Fit", "Fitted to the transmittance or to a volume"))),
        "fit_to": EnumProperty(name="Fit to", default="transmittance", items=names(
            ("transmittance", "Transmittance", "At the surface"), ("volume", "Volume", "The light that a volume render shows"))),
        "extinction": StringProperty(name="Extinction", description="Per unit; for a fit also LO:HI. Empty: 7 / longest side"),
        "exponent": StringProperty(name="Exponent", description="k of the formula; for a fit also 'fit'. Empty: 3, for a fit 4"),
        "bias": StringProperty(name="Bias", description="b of the formula: units, or % of the longest side. Empty: -0.3%, for a fit 0"),
        "smooth": IntProperty(name="Smooth", default=0, min=0, max=100, description="Passes of smoothing of the lobes"),
        "vertices": IntProperty(name="Vertices", default=0, min=0,
                                description="Vertex budget, which makes a new mesh; 0: the mesh is kept"),
        "repair": EnumProperty(name="Repair", options={"ENUM_FLAG"}, default=set(), items=names(
            ("orient", "Orient", "Turn triangles that face the wrong way"), ("fill", "Fill", "Fill holes"),
            ("remesh", "Remesh", "Make a new mesh"))),
        "close": EnumProperty(name="If open", default="auto", items=names(
            ("auto", "Close", "Close them if needed"), ("wrap", "Wrap", "Wrap them always"),
                                                                          ("reject", "Reject", "Open meshes are errors"))),
        "strict": BoolProperty(name="Strict", description="Warnings are errors, and nothing is changed"),
        "more": StringProperty(name="More", description="Other options of the command line, such as --seed 3 --method rays"),
    }

    def options(self):
        """Those that are not at their defaults, as the engine takes them."""
        chosen = {}
        for key in ("rays", "voxels", "target_error", "lobe", "fit_to", "extinction", "exponent", "bias", "smooth", "vertices", "close",
                    "strict"):
            value = getattr(self, key)
            if value != self.bl_rna.properties[key].default:
                chosen[key] = value.strip() if isinstance(value, str) else value
        if self.repair:
            chosen["repair"] = ",".join(sorted(self.repair))
        for key, value in parse_options(self.more).items():
            if key in RESERVED:
                raise BakeError(f"more options: --{key.replace('_', '-')} cannot be used in Blender")
            if key in chosen:
                raise BakeError(f"more options: --{key.replace('_', '-')} is set in the panel too")
            chosen[key] = value
        return chosen


class CloudbakePreferences(bpy.types.AddonPreferences):
    bl_idname = __package__
    __annotations__ = {  # which Blender makes properties of
        "program": StringProperty(name="Program", subtype="FILE_PATH",
                                  description="The program cloudbake. Empty: the one on the search path"),
    }

    def draw(self, context):
        self.layout.prop(self, "program")


def program_of(context):
    addon = context.preferences.addons.get(__package__)
    return bpy.path.abspath(addon.preferences.program) if addon and addon.preferences.program else ""
