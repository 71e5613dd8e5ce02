"""Pictures of a subject before a transparent ground, compared, and what spoils them."""

import numpy as np
from PIL import Image

VIEWS = "above", "below"  # those of refined_picture.py


def compared(before, after):
    """The share of equal values on the subject, the largest difference there, and the share of the picture that it covers."""
    a, b = (np.asarray(Image.open(path)).astype(int) for path in (before, after))
    shown = a[:, :, 3] > 0
    difference = np.abs(a - b)[shown][:, :3]
    return (difference == 0).mean(), difference.max(), shown.mean()


def flip_v(document):
    """Turns the texture of a glTF document's first material upside down."""
    document["extensionsUsed"] = ["KHR_texture_transform"]
    texture = document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]
    texture["extensions"] = {"KHR_texture_transform": {"offset": [0, 1], "scale": [1, -1]}}
