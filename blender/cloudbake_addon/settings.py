"""The settings of a scene, which are options of `cloudbake bake`, and the preferences."""

import functools
import json
import os
import pathlib

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from .engine import BakeError, parse_options, who_bakes

# Written by `cloudbake print-docs blender-options` from the table of options of the program: the options of the panel, and the names of
# those that the add-on sets itself or that have no meaning inside Blender.
OPTIONS = json.loads((pathlib.Path(__file__).parent / "options.json").read_text(encoding="utf-8"))
PANEL = [option["name"] for option in OPTIONS["panel"]]


def names(*rows):
    return [(key, label, text) for key, label, text in rows]


def property_of(option):
    """The property of an option. One that is a number or something else is a text, and an empty text is the default."""
    name, help_text, fallback = option["name"].replace("_", " ").capitalize(), option["help"], option["fallback"]
    words = names(*((word, word.capitalize(), "") for word in option["words"]))
    if option["kind"] == "flag":
        return BoolProperty(name=name, description=help_text)
    if option["kind"] == "choice":
        return EnumProperty(name=name, description=help_text, items=words, default=fallback)
    if option["kind"] == "whole":
        low = option["low"] if fallback else 0  # 0 leaves out an option without a default
        return IntProperty(name=name, description=help_text, default=int(fallback or 0), min=low, max=option["high"])
    if option["shape"].startswith("W"):
        return EnumProperty(name=name, description=help_text, items=words, options={"ENUM_FLAG"}, default=set())
    return StringProperty(name=name, description=help_text + (fallback and f" [{fallback}]"))


class Progress:
    """Of the bake that runs, for the panel. It is not in the scene, because a file that is saved meanwhile must not have it."""
    share, text = 0.0, ""


class CloudbakeSettings(bpy.types.PropertyGroup):
    __annotations__ = {  # which Blender makes properties of
        "scope": EnumProperty(name="Bake", default="SELECTED", description="Which objects are baked", items=names(
            ("ACTIVE", "Active object", "The active object alone"),
            ("SELECTED", "Selected objects", "All selected meshes"),
            ("COLLECTION", "Collection", "All visible meshes of a collection and its children"))),
        "collection": PointerProperty(name="Collection", type=bpy.types.Collection, description="Without one, the active collection"),
        "each": BoolProperty(name="Each alone", description="Every object is a cloud of its own. Otherwise all shade each other"),
        "shape": EnumProperty(name="Shape", default="EVALUATED", description="What is done with modifiers", items=names(
            ("EVALUATED", "With modifiers", "The shape that modifiers and shape keys give. If modifiers make new vertices, a copy has them "
             "applied"),
            ("BASE", "Base mesh", "The shape without modifiers and shape keys"))),
        "make_material": BoolProperty(name="Material", default=True,
                                      description="Gives objects without a material one that shows the lobes. Set Up does it for others"),
        "progress": FloatProperty(name="Baking", subtype="FACTOR", min=0, max=1, get=lambda self: Progress.share),
        "sun": PointerProperty(name="Sun", type=bpy.types.Object, description="Without one, the scene's first sun lamp",
                             poll=lambda self, thing: thing.type == "LIGHT" and thing.data.type == "SUN"),
        "more": StringProperty(name="More", description="Other options of the command line, such as --seed 3 --method rays"),
    }

    def options(self):
        """Those that are not at their defaults, as the engine takes them."""
        chosen = {}
        for key in PANEL:
            value, default = getattr(self, key), self.bl_rna.properties[key]
            if isinstance(value, set):
                if value:
                    chosen[key] = ",".join(sorted(value))
            elif value != default.default:
                chosen[key] = value.strip() if isinstance(value, str) else value
        for key, value in parse_options(self.more).items():
            if key in OPTIONS["refused"]:
                raise BakeError(f"more options: --{key.replace('_', '-')} cannot be used in Blender")
            if key in chosen:
                raise BakeError(f"more options: --{key.replace('_', '-')} is set in the panel too")
            chosen[key] = value
        return chosen


# The options of the program, by their names there.
for row in OPTIONS["panel"]:
    CloudbakeSettings.__annotations__[row["name"]] = property_of(row)


class CloudbakePreferences(bpy.types.AddonPreferences):
    bl_idname = __package__
    __annotations__ = {  # which Blender makes properties of
        "program": StringProperty(name="Program", subtype="FILE_PATH",
                                  description="The program cloudbake, or cloudbake.mjs, which runs in Node. Empty: the one in the add-on's "
                                              "folder bin, else beside the add-on, else on the search path"),
    }

    def draw(self, context):
        self.layout.prop(self, "program")
        self.layout.label(text=bakes_with(bpy.context))


def program_of(context):
    addon = context.preferences.addons.get(__package__)
    return bpy.path.abspath(addon.preferences.program) if addon and addon.preferences.program else ""


@functools.lru_cache(maxsize=1)
def looked_up(program, search_path):
    try:
        return f"Bakes with {who_bakes(program)}"
    except BakeError as error:
        return str(error)


def bakes_with(context):
    """What would bake, in words. Panels are drawn often: a look-up is repeated after a bake, and when a path has changed."""
    return looked_up(program_of(context), os.environ.get("PATH", ""))
