"""The panel in the sidebar of the 3D view, and the entries of the File menu."""

import textwrap

import bpy

from .settings import PANEL, Progress, bakes_with


class CLOUDBAKE_PT_panel(bpy.types.Panel):
    bl_label = "Cloudbake"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Cloudbake"

    def draw(self, context):
        own, layout = context.scene.cloudbake, self.layout
        layout.use_property_split, layout.use_property_decorate = True, False
        layout.prop(own, "scope")
        if own.scope == "COLLECTION":
            layout.prop(own, "collection")
        layout.prop(own, "each")
        layout.prop(own, "shape")
        draw_bake(context, layout)
        layout.prop(own, "make_material")
        layout.prop(own, "sun")
        row = layout.row(align=True)
        row.operator("cloudbake.material", text="Set Up")
        row.operator("cloudbake.remove_material", text="Remove")
        layout.operator("cloudbake.follow_sun", text="Follow Sun")
        row = layout.row(align=True)
        row.operator("cloudbake.import_asset", text="Import")
        row.operator("cloudbake.export_asset", text="Export")
        row.operator("cloudbake.export_each", text="Each")


def draw_bake(context, layout):
    """The button, or how far the bake is, and what bakes."""
    if not Progress.text:
        layout.operator("cloudbake.bake", icon="RENDER_STILL")
    elif hasattr(layout, "progress"):  # from Blender 4.0 on
        layout.progress(factor=Progress.share, text=Progress.text)
    else:
        column = layout.column()
        column.enabled = column.use_property_split = False
        column.prop(context.scene.cloudbake, "progress", slider=True, text=Progress.text)
    box = layout.column(align=True)
    box.scale_y = 0.7
    for line in textwrap.wrap(bakes_with(context), max(20, int(context.region.width / (7.5 * context.preferences.system.ui_scale)))):
        box.label(text=line)


class CLOUDBAKE_PT_options(bpy.types.Panel):
    bl_label = "Options"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Cloudbake"
    bl_parent_id, bl_options = "CLOUDBAKE_PT_panel", {"DEFAULT_CLOSED"}

    def draw(self, context):
        own, layout = context.scene.cloudbake, self.layout
        layout.use_property_split, layout.use_property_decorate = True, False
        for name in PANEL:
            column = layout.column()
            column.active = name != "fit_to" or own.lobe == "fit"
            column.prop(own, name)
        layout.prop(own, "more")


def import_entry(self, context):
    self.layout.operator("cloudbake.import_asset", text="Baked Cloud (.glb)")


def export_entry(self, context):
    self.layout.operator("cloudbake.export_asset", text="Baked Cloud (.glb)")


CLASSES = (CLOUDBAKE_PT_panel, CLOUDBAKE_PT_options)


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.TOPBAR_MT_file_import.append(import_entry)
    bpy.types.TOPBAR_MT_file_export.append(export_entry)


def unregister():
    bpy.types.TOPBAR_MT_file_export.remove(export_entry)
    bpy.types.TOPBAR_MT_file_import.remove(import_entry)
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
