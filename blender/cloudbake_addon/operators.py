"""What the panel's buttons do."""

import pathlib
import time
from collections.abc import Callable

import bpy
from bpy.props import BoolProperty, CollectionProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from . import bake, exchange, nodes, settings
from .engine import BakeError
from .settings import Progress


def chosen_objects(context, scope, to_bake=False):
    """The name of what is chosen, its meshes, and words about what is left out."""
    own = context.scene.cloudbake
    if scope == "COLLECTION":
        collection = own.collection or context.collection
        return collection.name, *bake.meshes_of(collection.all_objects, context.view_layer, to_bake)
    active = context.view_layer.objects.active
    things = [active] if scope == "ACTIVE" and active else list(context.view_layer.objects.selected) if scope == "SELECTED" else []
    name = active.name if active in things else things[0].name if things else ""
    return name, *bake.meshes_of(things, context.view_layer, to_bake)


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
        name, things, self.words = chosen_objects(context, own.scope, to_bake=True)
        bake.check_objects(things, depsgraph)
        groups = [(thing.name, [thing]) for thing in things] if own.each else [(name, things)]
        options = own.options()
        self.clouds = [bake.make_cloud(name, group, depsgraph, own.shape == "BASE", options) for name, group in groups]
        self.program, self.results = settings.program_of(context), []
        settings.looked_up.cache_clear()

    def result(self):
        """What the job of the next cloud made. An error names the cloud."""
        try:
            return self.job.result()
        except BakeError as error:
            raise BakeError(f"'{self.clouds[len(self.results)].name}': {error}") from None

    def finish(self, context):
        count = 0
        depsgraph = context.evaluated_depsgraph_get()
        for part in [part for cloud in self.clouds for part in cloud.parts]:
            part.thing(depsgraph)  # all objects are as they were read, or nothing is changed
        for cloud, baked in zip(self.clouds, self.results):
            things, words = bake.store_cloud(cloud, baked, depsgraph)
            self.words += words
            count += len(things)
            if context.scene.cloudbake.make_material:
                self.light(context, cloud, things, baked.info)
        tell(self, self.words)
        who = settings.bakes_with(context).removeprefix("Bakes with ")
        self.report({"INFO"}, f"baked {count} object{'s' if count != 1 else ''} with {who}")
        return {"FINISHED"}

    def light(self, context, cloud, things, info):
        """Objects that have no material get one, and materials that have the group get the new constants."""
        for thing in things:
            if not any(slot.material for slot in thing.material_slots):
                for material in nodes.set_up(thing, f"Cloudbake {cloud.name}", bake.constants_of(info)):
                    nodes.follow_sun(material, chosen_sun(context))
        for material in {slot.material for thing in things for slot in thing.material_slots if slot.material}:
            if material.library is None:
                nodes.settle_constants(material)

    def execute(self, context):
        try:
            self.prepare(context)
            for number, cloud in enumerate(self.clouds):
                if len(self.clouds) > 1:
                    print(f"Cloudbake: {cloud.name}, {number + 1} of {len(self.clouds)}")
                self.job = cloud.start(self.program)
                self.results.append(self.result())
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
        self.show(context)
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
        self.show(context)
        if not self.job.is_done():
            return {"RUNNING_MODAL"}
        try:
            self.results.append(self.result())
            if len(self.results) < len(self.clouds):
                self.job = self.clouds[len(self.results)].start(self.program)
                return {"RUNNING_MODAL"}
            self.stop(context)
            return self.finish(context)
        except BakeError as error:
            self.stop(context)
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    def show(self, context):
        """How far it is: in the panel, in the status bar and at the pointer."""
        done, count = len(self.results), len(self.clouds)
        text = f"{self.clouds[done].name}, {done + 1} of {count}, {time.monotonic() - self.began:.0f} s"
        context.workspace.status_text_set(f"Cloudbake: {text}. Esc cancels")
        context.window_manager.progress_update(done)
        if Progress.text != text:
            Progress.share, Progress.text = done / count, text
            for area in context.screen.areas:
                area.tag_redraw()

    def stop(self, context):
        if self.timer:
            context.window_manager.event_timer_remove(self.timer)
            context.window_manager.progress_end()
            context.workspace.status_text_set(None)
            Progress.share, Progress.text = 0.0, ""
        self.timer = None

    def cancel(self, context):
        """Blender ends operators when it quits or loads another file."""
        self.job.cancel()
        self.stop(context)


class CLOUDBAKE_OT_material(Reporting, bpy.types.Operator):
    """Show the lobes of the baked objects in their own materials. Nodes are added, and none of yours is changed"""
    bl_idname = "cloudbake.material"
    bl_label = "Set Up Material"
    bl_options = {"REGISTER", "UNDO"}

    def run(self, context):
        name, things, words = chosen_objects(context, context.scene.cloudbake.scope)
        baked = [(thing, info["asset"]) for thing in things if (info := bake.get_info(thing.data))]
        if not baked:
            raise BakeError("none of these objects is baked yet: press Bake first" if things else "no mesh is chosen: select one")
        check_materials([thing for thing, _ in baked])
        white = set()
        for thing, asset in baked:
            fallback = f"Cloudbake {thing.name if context.scene.cloudbake.each else name}"
            for material in nodes.set_up(thing, fallback, bake.constants_of(asset)):
                nodes.follow_sun(material, chosen_sun(context))
                white |= set() if nodes.is_colored(material) else {material.name}
        tell(self, words + [f"material '{name}' has no shader with a base colour outside of groups: its cloud is white" for name in
                            sorted(white)])
        return {"FINISHED"}


def check_materials(things):
    for thing in things:
        for slot in thing.material_slots:
            if slot.material and slot.material.library:
                raise BakeError(f"material '{slot.material.name}' of '{thing.name}' is linked from another file: make it local first "
                                "(Object > Relations > Make Local > Materials)")


class CLOUDBAKE_OT_remove_material(Reporting, bpy.types.Operator):
    """Remove the nodes that Set Up added, from the materials of the chosen objects. The lobes stay"""
    bl_idname = "cloudbake.remove_material"
    bl_label = "Remove Set-Up"
    bl_options = {"REGISTER", "UNDO"}

    def run(self, context):
        _, things, words = chosen_objects(context, context.scene.cloudbake.scope)
        count = sum(nodes.take_down(thing) for thing in things)
        if not count:
            raise BakeError("no material of these objects was set up: there is nothing to remove")
        tell(self, words)
        self.report({"INFO"}, f"{count} slot{'s show' if count != 1 else ' shows'} the artist's material again")
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
        materials = [material for material in bpy.data.materials if nodes.group_node(material)]
        if not materials:
            baked = [thing.name for thing in context.scene.objects if thing.type == "MESH" and bake.get_info(thing.data)]
            raise BakeError(f"no material shows lobes yet: choose {', '.join(map(repr, baked[:3]))}{' …' if baked[3:] else ''} and press "
                            "Set Up first" if baked else "no object of the scene is baked yet: press Bake first")
        local = [material for material in materials if material.library is None]
        following = [material for material in local if nodes.follow_sun(material, sun)]
        tell(self, [f"material '{material.name}' is linked from another file and keeps its sun: make it local first"
                    for material in materials if material.library])
        tell(self, [f"the Sun direction of material '{material.name}' is linked to another node: unlink it first"
                    for material in local if material not in following])
        self.report({"INFO"}, f"{len(following)} material{'s follow' if len(following) != 1 else ' follows'} '{sun.name}'")
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
            exchange.read_asset(path)  # all or none
        for path in paths:
            for line in exchange.import_asset(context, path, chosen_sun(context)):
                self.report({"INFO"}, line)
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
        if not things:
            raise BakeError("there is no cloud to export: select one that is baked")
        depsgraph = context.evaluated_depsgraph_get()
        for thing in things:
            exchange.exported_info([thing], depsgraph)  # all or none
        for thing, stem in zip(things, exchange.file_names(list(exchange.name_objects(things).values()))):
            words += exchange.export_asset(context, [thing], str(pathlib.Path(self.directory) / f"{stem}.glb"))
        tell(self, words)
        self.report({"INFO"}, f"wrote {len(things)} files")
        return {"FINISHED"}


CLASSES = (settings.CloudbakeSettings, settings.CloudbakePreferences, CLOUDBAKE_OT_bake, CLOUDBAKE_OT_material,
           CLOUDBAKE_OT_remove_material, CLOUDBAKE_OT_follow_sun, CLOUDBAKE_OT_import, CLOUDBAKE_OT_export, CLOUDBAKE_OT_export_each)


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Scene.cloudbake = bpy.props.PointerProperty(type=settings.CloudbakeSettings)


def unregister():
    del bpy.types.Scene.cloudbake
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
