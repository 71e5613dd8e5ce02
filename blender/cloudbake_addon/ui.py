"""The panel in the sidebar of the 3D view, and the entries of the File menu."""

import bpy

from .settings import PANEL


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
        layout.operator("cloudbake.bake", icon="RENDER_STILL")
        layout.prop(own, "make_material")
        layout.prop(own, "sun")
        row = layout.row(align=True)
        row.operator("cloudbake.material", text="Set Up")
        row.operator("cloudbake.follow_sun", text="Follow Sun")
        row = layout.row(align=True)
        row.operator("cloudbake.import_asset", text="Import")
        row.operator("cloudbake.export_asset", text="Export")
        row.operator("cloudbake.export_each", text="Each")


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
