"""Writes FBX 7.4 as text and as Blender and others write it, packed. A record is (name, properties, records)."""

import struct
from typing import Any

Record = tuple[str, list[Any], list[Any]]

WITH_IDS = {"Geometry", "Model", "Material", "C"}  # records whose whole numbers have 64 bits


def property_bytes(value, long=False):
    if isinstance(value, str):
        name = value.encode().replace(b"::", b"\0\1")
        if b"\0\1" in name:  # text has Class::Name, packed files have the name first
            kind, _, own = name.partition(b"\0\1")
            name = own + b"\0\1" + kind
        return b"S" + struct.pack("<I", len(name)) + name
    if isinstance(value, list):
        letter = "d" if any(isinstance(number, float) for number in value) else "i"
        data = struct.pack(f"<{len(value)}{letter}", *value)
        return letter.encode() + struct.pack("<III", len(value), 0, len(data)) + data
    if isinstance(value, float):
        return b"D" + struct.pack("<d", value)
    return b"L" + struct.pack("<q", value) if long else b"I" + struct.pack("<i", value)


def packed_record(record, at):
    """`at`: where the record begins in the file."""
    name, properties, records = record
    data = b"".join(property_bytes(value, name in WITH_IDS) for value in properties)
    head = 13 + len(name) + len(data)
    inside = b""
    for child in records:
        inside += packed_record(child, at + head + len(inside))
    if records:
        inside += bytes(13)
    return struct.pack("<IIIB", at + head + len(inside), len(properties), len(data), len(name)) + name.encode() + data + inside


def packed_fbx(records):
    data = b"Kaydara FBX Binary  \0\x1a\0" + struct.pack("<I", 7400)
    for record in records:
        data += packed_record(record, len(data))
    return data + bytes(13) + bytes(160)


def text_record(record, indent=""):
    name, properties, records = record
    words = []
    for value in properties:
        if isinstance(value, list):
            words.append(f"*{len(value)} {{\n{indent}\ta: {','.join(map(repr, value))}\n{indent}}}")
        else:
            words.append(f'"{value}"' if isinstance(value, str) else repr(value))
    inside = "".join(text_record(child, indent + "\t") for child in records)
    line = ", ".join(words)
    if name == "P":  # numbers follow without blanks
        line = ", ".join(words[:4]) + "".join(f",{word}" for word in words[4:])
    return f"{indent}{name}: {line}" + (f" {{\n{inside}{indent}}}\n" if records or not properties else "\n")


def text_fbx(records):
    return ("; FBX 7.4.0 project file\n" + "".join(map(text_record, records))).encode()


def setting(name, *value, kind="int", more="Integer", flag=""):
    return ("P", [name, kind, more, flag, *value], [])


def fbx_scene(models, axes=(0, 1, 1, 1, 2, 1), unit=1.0):
    """models: (name, properties of the model, records of the geometry, names of its materials). axes: Coord, its sign, Up, Front."""
    axis_names = [name + end for name in ("CoordAxis", "UpAxis", "FrontAxis") for end in ("", "Sign")]
    settings = [setting(name, value) for name, value in zip(axis_names, axes)]
    settings.append(setting("UnitScaleFactor", unit, kind="double", more="Number"))
    objects: list[Record] = []
    links: list[Record] = []
    materials: dict[str, int] = {}
    for number, (name, properties, geometry, names) in enumerate(models):
        model, shape = 2000000 + number, 3000000 + number
        objects.append(("Geometry", [shape, f"Geometry::{name}", "Mesh"], geometry))
        objects.append(("Model", [model, f"Model::{name}", "Mesh"], [("Version", [232], []), ("Properties70", [], properties)]))
        links += [("C", ["OO", model, 0], []), ("C", ["OO", shape, model], [])]
        for material in names:
            if material not in materials:
                materials[material] = 4000000 + len(materials)
                objects.append(("Material", [materials[material], f"Material::{material}", ""], [
                    ("Version", [102], []), ("ShadingModel", ["lambert"], []),
                    ("Properties70", [], [setting("DiffuseColor", 0.5, 0.25, 1.0, kind="Color", more="", flag="A")])]))
            links.append(("C", ["OO", materials[material], model], []))
    count = lambda kind: sum(entry[0] == kind for entry in objects)
    counts: list[Record] = [("ObjectType", [kind], [("Count", [count(kind)], [])]) for kind in ("Geometry", "Model", "Material")]
    return [("FBXHeaderExtension", [], [("FBXHeaderVersion", [1003], []), ("FBXVersion", [7400], [])]),
            ("GlobalSettings", [], [("Version", [1000], []), ("Properties70", [], settings)]),
            ("Definitions", [], [("Version", [100], []), *counts]),
            ("Objects", [], objects), ("Connections", [], links)]
