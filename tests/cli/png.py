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


def unfiltered(packed, width, height, channels):
    """The bytes of packed, filtered rows (PNG specification, section 9)."""
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
    return b"".join(rows)


def pixels(path):
    """Width, height and the RGB bytes of an 8-bit PNG, rows from the top (PNG specification, section 11)."""
    data = path.read_bytes()
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError(f"{path.name} is no PNG")
    found = chunks(path)
    width, height, _, colour = struct.unpack(">IIBBBBB", found[0][1])[:4]
    channels = {0: 1, 2: 3, 6: 4}[colour]
    return width, height, unfiltered(b"".join(body for kind, body in found if kind == "IDAT"), width, height, channels), channels


def film(path):
    """The RGB bytes of every frame of an animated PNG of RGBA, as a viewer shows it (APNG specification)."""
    found, canvas, frames, part = chunks(path), None, [], None
    width, height = struct.unpack(">II", found[0][1][:8])
    canvas = bytearray(3 * width * height)
    for kind, body in found:
        if kind == "fcTL":
            part = struct.unpack(">IIIIIHHBB", body)
        elif kind in ("IDAT", "fdAT"):
            _, columns, rows, left, top, _, _, _, over = part
            rgba = unfiltered(body if kind == "IDAT" else body[4:], columns, rows, 4)
            for i in range(columns * rows):
                at = 3 * ((top + i // columns) * width + left + i % columns)
                if rgba[4 * i + 3] or not over:
                    canvas[at : at + 3] = rgba[4 * i : 4 * i + 3]
            frames.append(bytes(canvas))
    return frames
