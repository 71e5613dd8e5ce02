"""What an object's shape depends on, so that an export can name what has changed since the bake."""

import contextlib
import hashlib

import numpy

from .kept import plain

UNIMPORTANT = {"name", "is_active", "show_expanded", "show_in_editmode", "show_on_cage", "show_render", "render_levels", "use_pin_to_last"}


def hash_of(*arrays):
    """Of arrays of 32 bits."""
    return hashlib.sha1(b"".join(numpy.ascontiguousarray(array).tobytes() for array in arrays)).hexdigest()


def settings_of(block):
    """What a modifier is set to, by the names that scripts use."""
    chosen = {}
    for rule in block.bl_rna.properties:
        if rule.is_readonly or rule.identifier in UNIMPORTANT:
            continue
        value = getattr(block, rule.identifier)
        if rule.type == "POINTER":
            chosen[rule.identifier] = getattr(value, "name", None)
        elif rule.type in ("BOOLEAN", "INT", "FLOAT", "ENUM", "STRING"):
            chosen[rule.identifier] = sorted(value) if isinstance(value, set) else list(value) if hasattr(value, "__len__") and not \
                isinstance(value, str) else value
    if block.type == "NODES":  # the inputs of a node group are custom properties
        with contextlib.suppress(TypeError):  # which a later Blender may store elsewhere
            chosen.update({key: plain(block[key]) for key in block.keys()})
    return chosen


def poses_of(thing):
    """A hash for each bone of the armatures that bend an object."""
    rigs = [modifier.object for modifier in thing.modifiers if modifier.type == "ARMATURE" and modifier.object]
    return {rig.name: {bone.name: hash_of(numpy.array(bone.matrix, numpy.float32).round(5))[:8] for bone in rig.pose.bones} for rig in rigs}


def places_of(thing):
    """A hash of where the objects are that modifiers use, in the space of the object: some modifiers bend by that."""
    names, inverse = ("object", "target", "mirror_object", "offset_object"), thing.matrix_world.inverted_safe()
    used = [other for modifier in thing.modifiers for name in names if (other := getattr(modifier, name, None)) is not None]
    return {other.name: hash_of(numpy.array(inverse @ other.matrix_world, numpy.float32).round(4) + numpy.float32(0)) for other in used}


def state_of(thing, frame):
    """Everything that explains why an object has another shape later, as JSON can hold it."""
    points = numpy.empty(3 * len(thing.data.vertices), numpy.float32)
    thing.data.vertices.foreach_get("co", points)
    keys = thing.data.shape_keys
    return {"frame": frame, "mesh": hash_of(points), "poses": poses_of(thing), "places": places_of(thing),
            "keys": {block.name: block.value for block in keys.key_blocks[1:]} if keys else {},
            "modifiers": {modifier.name: settings_of(modifier) for modifier in thing.modifiers if modifier.show_viewport}}


def number(value):
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def changes(before, now):
    """What differs between two states, in words."""
    words = []
    for name in {**before["keys"], **now["keys"]}:
        old, new = before["keys"].get(name), now["keys"].get(name)
        if old != new:
            words.append(f"shape key '{name}' was added" if old is None else f"shape key '{name}' was removed" if new is None else
                         f"shape key '{name}' was {number(old)} and is {number(new)}")
    for name in {**before["modifiers"], **now["modifiers"]}:
        old, new = before["modifiers"].get(name), now["modifiers"].get(name)
        if old is None or new is None:
            words.append(f"modifier '{name}' was {'added or switched on' if old is None else 'removed or switched off'}")
        elif old != new:
            key = next(key for key in {**old, **new} if old.get(key) != new.get(key))
            words.append(f"'{key}' of modifier '{name}' was {number(old.get(key))} and is {number(new.get(key))}")
    for rig, bones in before["poses"].items():
        moved = [bone for bone in bones if now["poses"].get(rig, {}).get(bone) != bones[bone]]
        if moved:
            words.append(f"armature '{rig}' has another pose (bone '{moved[0]}'{f' and {len(moved) - 1} more' if moved[1:] else ''})")
    for name, place in before["places"].items():
        if now["places"].get(name) != place:
            words.append(f"it was moved against '{name}', which a modifier uses")
    if before["mesh"] != now["mesh"]:
        words.append("the mesh was edited")
    if before["frame"] != now["frame"]:
        words.append(f"the frame was {before['frame']} and is {now['frame']}")
    return words
