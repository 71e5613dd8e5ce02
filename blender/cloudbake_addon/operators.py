"""What the panel's buttons do."""

import pathlib
import time
from collections.abc import Callable

import bpy
from bpy.props import BoolProperty, CollectionProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from . import bake, exchange, nodes, settings
from .engine import BakeError


def chosen_objects(context, scope):
    """The name of what is chosen, its meshes, and words about what is left out."""
    own = context.scene.cloudbake
    if scope == "COLLECTION":
        collection = own.collection or context.collection
        return collection.name, *bake.meshes_of(collection.all_objects, context.view_layer)
    active = context.view_layer.objects.active
    things = [active] if scope == "ACTIVE" and active else list(context.view_layer.objects.selected) if scope == "SELECTED" else []
    name = active.name if active in things else things[0].name if things else ""
    return name, *bake.meshes_of(things, context.view_layer)


def chosen_sun(context):
    return context.scene.cloudbake.sun or nodes.first_sun(context.scene)


def tell(operator, words):
    for line in words:
        operator.report({"WARNING"}, line)


class Reporting:
    """Errors of the add-on end an operator as cancelled, with their text."""
    run: Callable
    report: Callable

    def execute(self, context):
        try:
            return self.run(context)
        except BakeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}


class CLOUDBAKE_OT_bake(bpy.types.Operator):
    """Measure how much cloud lies behind every vertex and store it in two UV maps. Esc cancels"""
    bl_idname = "cloudbake.bake"
    bl_label = "Bake"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        cls.poll_message_set("change to object mode first")
        return context.mode == "OBJECT"

    def prepare(self, context):
        """The clouds to bake. Nothing is changed before all of them are baked."""
        own, depsgraph = context.scene.cloudbake, context.evaluated_depsgraph_get()
        name, things, self.words = chosen_objects(context, own.scope)
        bake.check_objects(things, depsgraph)
        groups = [(thing.name, [thing]) for thing in things] if own.each else [(name, things)]
        options = own.options()
        self.clouds = [bake.make_cloud(name, group, depsgraph, own.shape == "BASE", options) for name, group in groups]
        self.program, self.results = settings.program_of(context), []

    def finish(self, context):
        count = 0
        for part in [part for cloud in self.clouds for part in cloud.parts]:
            part.thing  # all objects are still there, or nothing is changed
        for cloud, baked in zip(self.clouds, self.results):
            things, words = bake.store_cloud(cloud, baked)
            self.words += words
            count += len(things)
            if context.scene.cloudbake.make_material:
                self.light(context, cloud, things, baked.info)
        tell(self, self.words)
        self.report({"INFO"}, f"baked {count} object{'s' if count != 1 else ''}")
        return {"FINISHED"}

    def light(self, context, cloud, things, info):
        """Objects that have no material get one, and materials that have the group get the new constants."""
        constants = info["exponent"], info["bias"], info["extinction"]
        bare = [thing for thing in things if not any(slot.material for slot in thing.material_slots)]
        if bare:
            material = nodes.cloud_material(f"Cloudbake {cloud.name}", *constants)
            nodes.follow_sun(material, chosen_sun(context))
            for thing in bare:
                nodes.put_material(thing, material)
        for material in {slot.material for thing in things for slot in thing.material_slots if slot.material}:
            if nodes.group_node(material) and material.library is None:
                nodes.set_constants(material, *constants)

    def execute(self, context):
        try:
            self.prepare(context)
            for cloud in self.clouds:
                self.results.append(cloud.start(self.program).result())
            return self.finish(context)
        except BakeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    def invoke(self, context, event):
        if bpy.app.background or context.window is None:
            return self.execute(context)
        try:
            self.prepare(context)
            self.job = self.clouds[0].start(self.program)
        except BakeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        manager = context.window_manager
        self.began, self.timer = time.monotonic(), manager.event_timer_add(0.05, window=context.window)
        manager.progress_begin(0, len(self.clouds))
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        """All events end here, so that the scene stays as it was read."""
        if event.type == "ESC":
            self.job.cancel()
            self.stop(context)
            self.report({"INFO"}, "the bake was cancelled: nothing is changed")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}
        number, seconds = len(self.results), time.monotonic() - self.began
        name, count = self.clouds[number].name, len(self.clouds)
        context.workspace.status_text_set(f"Cloudbake: {name}, {number + 1} of {count}, {seconds:.0f} s. Esc cancels")
        if not self.job.is_done():
            return {"RUNNING_MODAL"}
        try:
            self.results.append(self.job.result())
            context.window_manager.progress_update(len(self.results))
            if len(self.results) < len(self.clouds):
                self.job = self.clouds[len(self.results)].start(self.program)
                return {"RUNNING_MODAL"}
            self.stop(context)
            return self.finish(context)
        except BakeError as error:
            self.stop(context)
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    def stop(self, context):
        if self.timer:
            context.window_manager.event_timer_remove(self.timer)
            context.window_manager.progress_end()
            context.workspace.status_text_set(None)
        self.timer = None

    def cancel(self, context):
        """Blender ends operators when it quits or loads another file."""
        self.job.cancel()
        self.stop(context)


class CLOUDBAKE_OT_material(Reporting, bpy.types.Operator):
    """Give the baked objects the material that shows their lobes, in all slots"""
    bl_idname = "cloudbake.material"
    bl_label = "Set Up Material"
    bl_options = {"REGISTER", "UNDO"}

    def run(self, context):
        name, things, words = chosen_objects(context, context.scene.cloudbake.scope)
        baked = [(thing, info["asset"]) for thing in things if (info := bake.get_info(thing.data))]
        if not baked:
            raise BakeError("none of these objects is baked yet")
        for thing, asset in baked:
            material = next((slot.material for slot in thing.material_slots if slot.material and nodes.group_node(slot.material)), None)
            constants = asset["exponent"], asset["bias"], asset["extinction"]
            if material is None:
                material = nodes.cloud_material(f"Cloudbake {thing.name if context.scene.cloudbake.each else name}", *constants)
            nodes.set_constants(material, *constants)
            nodes.follow_sun(material, chosen_sun(context))
            nodes.put_material(thing, material)
        tell(self, words)
        return {"FINISHED"}


class CLOUDBAKE_OT_follow_sun(Reporting, bpy.types.Operator):
    """Let the sun lamp turn the light of every cloud in the file"""
    bl_idname = "cloudbake.follow_sun"
    bl_label = "Follow the Sun"
    bl_options = {"REGISTER", "UNDO"}

    def run(self, context):
        sun = chosen_sun(context)
        if sun is None:
            raise BakeError("the scene has no sun lamp: add one (Add > Light > Sun)")
        materials = [material for material in bpy.data.materials if material.library is None and nodes.group_node(material)]
        for material in materials:
            nodes.follow_sun(material, sun)
        self.report({"INFO"}, f"{len(materials)} material{'s' if len(materials) != 1 else ''} follow '{sun.name}'")
        return {"FINISHED"}


class CLOUDBAKE_OT_import(Reporting, bpy.types.Operator, ImportHelper):
    """Import baked assets, with the material that shows their lobes"""
    bl_idname = "cloudbake.import_asset"
    bl_label = "Import Baked Cloud"
    bl_options = {"REGISTER", "UNDO"}
    filename_ext = ".glb"
    __annotations__ = {  # which Blender makes properties of
        "filter_glob": StringProperty(default="*.glb;*.gltf", options={"HIDDEN"}),
        "files": CollectionProperty(type=bpy.types.OperatorFileListElement, options={"HIDDEN", "SKIP_SAVE"}),
        "directory": StringProperty(subtype="DIR_PATH", options={"HIDDEN", "SKIP_SAVE"}),
    }

    def run(self, context):
        paths = [str(pathlib.Path(self.directory) / file.name) for file in self.files if file.name] or [self.filepath]
        for path in paths:
            exchange.info_of_file(path)  # all or none
        for path in paths:
            exchange.import_asset(path, chosen_sun(context))
        return {"FINISHED"}


class CLOUDBAKE_OT_export(Reporting, bpy.types.Operator, ExportHelper):
    """Write the chosen objects as one baked asset"""
    bl_idname = "cloudbake.export_asset"
    bl_label = "Export Baked Cloud"
    filename_ext = ".glb"
    __annotations__ = {  # which Blender makes properties of
        "filter_glob": StringProperty(default="*.glb", options={"HIDDEN"}),
    }

    def run(self, context):
        _, things, words = chosen_objects(context, context.scene.cloudbake.scope)
        tell(self, words + exchange.export_asset(context, things, self.filepath))
        self.report({"INFO"}, f"wrote {self.filepath}")
        return {"FINISHED"}


class CLOUDBAKE_OT_export_each(Reporting, bpy.types.Operator):
    """Write each of the chosen objects as a baked asset of its own"""
    bl_idname = "cloudbake.export_each"
    bl_label = "Export Each"
    __annotations__ = {  # which Blender makes properties of
        "directory": StringProperty(subtype="DIR_PATH"),
        "filter_folder": BoolProperty(default=True, options={"HIDDEN"}),
    }

    def invoke(self, context, event):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def run(self, context):
        _, things, words = chosen_objects(context, context.scene.cloudbake.scope)
        for thing in things:
            exchange.exported_info([thing])  # all or none
        if not things:
            raise BakeError("there is no cloud to export")
        for thing, stem in zip(things, exchange.file_names([thing.name for thing in things])):
            words += exchange.export_asset(context, [thing], str(pathlib.Path(self.directory) / f"{stem}.glb"))
        tell(self, words)
        self.report({"INFO"}, f"wrote {len(things)} files")
        return {"FINISHED"}


CLASSES = (settings.CloudbakeSettings, settings.CloudbakePreferences, CLOUDBAKE_OT_bake, CLOUDBAKE_OT_material, CLOUDBAKE_OT_follow_sun,
           CLOUDBAKE_OT_import, CLOUDBAKE_OT_export, CLOUDBAKE_OT_export_each)


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Scene.cloudbake = bpy.props.PointerProperty(type=settings.CloudbakeSettings)


def unregister():
    del bpy.types.Scene.cloudbake
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
