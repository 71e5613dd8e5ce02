"""Reads PNG files without a library: their chunks and their pixels."""

import struct
import zlib


def chunks(path):
    """Kinds and bodies of a PNG's chunks (PNG specification, section 5)."""
    data, at, found = path.read_bytes(), 8, []
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        found.append((kind.decode(), data[at + 8 : at + 8 + length]))
        at += length + 12
    return found


def size_of(path):
    return struct.unpack(">II", dict(chunks(path)[:1])["IHDR"][:8])


def pixels(path):
    """Width, height and the RGB bytes of an 8-bit PNG, rows from the top (PNG specification, sections 9 and 11)."""
    data = path.read_bytes()
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError(f"{path.name} is no PNG")
    at, packed, size = 8, b"", None
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + length]
        size = struct.unpack(">IIBBBBB", body) if kind == b"IHDR" else size
        packed += body if kind == b"IDAT" else b""
        at += length + 12
    width, height, _, colour = size[:4]
    channels = {0: 1, 2: 3, 6: 4}[colour]
    raw, stride, before, rows = zlib.decompress(packed), width * channels, bytes(width * channels), []
    for y in range(height):
        kind, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1 : (y + 1) * (stride + 1)])
        for i in range(stride):
            a, b, c = (row[i - channels] if i >= channels else 0), before[i], (before[i - channels] if i >= channels else 0)
            p = a + b - c
            nearest = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            row[i] = (row[i] + (0, a, b, (a + b) // 2, nearest)[kind]) & 255
        before = bytes(row)
        rows.append(before)
    return width, height, b"".join(rows), channels
