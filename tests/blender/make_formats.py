"""Makes one scene in Blender and exports it in every sculpt format that Blender writes.

  blender --background --factory-startup --threads 1 --python tests/blender/make_formats.py -- FOLDER

The scene has five objects, eight materials, two textures, UV sets, colours, a parent and names of several scripts, as far as a format
holds them."""

import pathlib
import shutil
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from in_blender import bpy, run
from make_rigs import add_uvs, checker, empty, lump, material

EXPORTERS = {
    "scene.obj": lambda path: bpy.ops.wm.obj_export(filepath=path, export_materials=True, export_colors=True, path_mode="STRIP"),
    "scene.fbx": lambda path: bpy.ops.export_scene.fbx(filepath=path, path_mode="COPY", bake_anim=False),
    "embedded.fbx": lambda path: bpy.ops.export_scene.fbx(filepath=path, path_mode="COPY", embed_textures=True, bake_anim=False),
    "hidden.fbx": lambda path: export_with_hull(path),
    "scene.dae": lambda path: bpy.ops.wm.collada_export(filepath=path),
    "scene.ply": lambda path: bpy.ops.export_mesh.ply(filepath=path),
    "scene.stl": lambda path: bpy.ops.export_mesh.stl(filepath=path),
    "scene.glb": lambda path: bpy.ops.export_scene.gltf(filepath=path, export_format="GLB"),
    "scene.gltf": lambda path: bpy.ops.export_scene.gltf(filepath=path, export_format="GLTF_SEPARATE"),
}


def export_with_hull(path):
    """The scene in a hull that is hidden, as game engines want for collisions."""
    lump("UCX_cloud", 6, subdivisions=2, scale=(9, 9, 9)).hide_viewport = True
    bpy.ops.export_scene.fbx(filepath=path, path_mode="COPY", bake_anim=False)


def textured(name, colour, folder):
    """A material whose texture is a file, because only files can be copied beside an export."""
    image = checker(name, colour)
    image.filepath_raw, image.file_format = str(folder / f"{name}.png"), "PNG"
    image.save()
    return material(f"{name} material", (1, 1, 1), image)


def build(folder):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    top = empty("top", location=(1, 0, 0), rotation=(0, 0, 0.5))
    cloud = lump("cloud", 1, parent=top)
    add_uvs(cloud.data, "UVMap", 1)
    cloud.data.materials.append(textured("red_squares", (1, 0, 0), folder))
    other = lump("other cloud", 2, subdivisions=3, parent=top, location=(1.5, 0, 0), scale=(1, 1, 0.8))
    add_uvs(other.data, "UVMap", 2)
    for made in (textured("blue_squares", (0, 0, 1), folder), material("plain grey", (0.5, 0.5, 0.5))):
        other.data.materials.append(made)
    striped = lump("striped", 3, subdivisions=3, location=(-1.5, 0, 0))
    add_uvs(striped.data, "UVMap", 1)
    for i in range(4):
        striped.data.materials.append(material(f"stripe {i}", (i / 3, 0.2, 0.7)))
    for thing in (other, striped):
        for polygon in thing.data.polygons:
            polygon.material_index = int(polygon.center.z * 4 + 20) % len(thing.data.materials)
    painted = lump("painted", 4, subdivisions=3, location=(0, 2, 0))
    add_uvs(painted.data, "UVMap", 1)
    layer = painted.data.color_attributes.new(name="Col", type="BYTE_COLOR", domain="CORNER")
    for loop in painted.data.loops:
        shade = loop.vertex_index % 5 / 4
        layer.data[loop.index].color = (shade, 1 - shade, 0.5, 1)
    unicode = lump("Wölkchen 雲", 5, subdivisions=3, location=(0, -2, 0))
    unicode.data.materials.append(material("Белый", (1, 1, 1)))


def main():
    folder = pathlib.Path(sys.argv[sys.argv.index("--") + 1])
    for name, export in EXPORTERS.items():
        place = folder / name.replace(".", "_")  # a folder for each, because textures are copied beside
        (place / "sources").mkdir(parents=True, exist_ok=True)
        build(place / "sources")
        bpy.ops.object.select_all(action="SELECT")
        bpy.context.view_layer.objects.active = bpy.data.objects["cloud"]
        export(str(place / name))
        if name == "scene.obj":  # names the textures, but Blender 3.4 copies none
            for texture in (place / "sources").glob("*.png"):
                shutil.copy(texture, place)
    print(f"{len(EXPORTERS)} files in {folder}")


if __name__ == "__main__":
    run(main)
