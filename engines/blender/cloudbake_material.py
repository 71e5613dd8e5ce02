"""cloudbake @version@: the material of a baked cloud for Blender 3.4 and newer, Cycles and Eevee.

Import the asset as glTF, leave its objects selected, and run this script: in the Text Editor by Run Script, or without a window by
  blender --background scene.blend --python cloudbake_material.py
docs/engines/blender.md has the steps."""

#include "nodes.py"

FIRST_SET = @first_set@  # the lobes are in TEXCOORD_@first_set@ and TEXCOORD_@second_set@
DENSITY_MAX = @density_max@  # the largest d of a packed asset, else 0
EXPONENT, BIAS, EXTINCTION = @exponent@, @bias@, @extinction@  # b and sigma are in units of the scene


def main():
    chosen = [thing for thing in bpy.context.view_layer.objects.selected if thing.type == "MESH"]
    clouds = [thing for thing in chosen if take_maps(thing.data, FIRST_SET, DENSITY_MAX)]
    if not clouds:
        raise RuntimeError(f"no selected object has the UV maps {FIRST_SET} and {FIRST_SET + 1}: select the objects of the imported asset")
    for thing in clouds:
        for material in set_up(thing, "Cloudbake", (EXPONENT, BIAS, EXTINCTION)):
            follow_sun(material, first_sun(bpy.context.scene))
    print(f"cloudbake: the lobes are shown by {', '.join(thing.name for thing in clouds)}")


main()
