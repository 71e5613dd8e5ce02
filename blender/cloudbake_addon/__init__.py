"""cloudbake in Blender: bakes mesh clouds, lights them in Cycles and Eevee, reads and writes baked assets (docs/engines/blender.md)."""

import bpy

# Blender 3.4 to 4.1 read this, later ones blender_manifest.toml.
bl_info = {
    "name": "Cloudbake",
    "author": "cloudbake maintainers",
    "version": (0, 2, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Cloudbake",
    "description": "Bakes mesh clouds and lights them in Cycles and Eevee",
    "category": "Object",
}

if bpy.app.version < bl_info["blender"]:
    needed = ".".join(map(str, bl_info["blender"][:2]))
    raise ImportError(f"Cloudbake needs Blender {needed} or newer; this is Blender {bpy.app.version_string}")

from . import operators, ui  # older versions cannot import them


def register():
    operators.register()
    ui.register()


def unregister():
    ui.unregister()
    operators.unregister()
