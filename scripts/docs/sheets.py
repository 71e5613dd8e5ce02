"""Sheets of labelled pictures for docs/, in the typeface of the program's own sheets."""

import pathlib

from PIL import Image, ImageDraw, ImageFont

FONT = pathlib.Path(__file__).resolve().parents[2] / "data/fonts/inter_medium.otf"
PAPER, INK = (33, 36, 41), (240, 242, 245)
SHOWN = 900  # pixels that a page gives to a picture
READABLE = 14  # pixels, of letters there


def sheet(out, tiles, columns, tile):
    """Saves a JPEG of rows of pictures of this size, each with its label above it. Tiles are pairs of a label and a picture or its file."""
    width, height = tile
    gap = max(2, width // 80)
    size = max(READABLE, round(READABLE * columns * (width + gap) / SHOWN))
    font, strip = ImageFont.truetype(str(FONT), size), round(1.6 * size)
    rows = (len(tiles) + columns - 1) // columns
    picture = Image.new("RGB", (columns * (width + gap) - gap, rows * (height + strip + gap) - gap), PAPER)
    pen = ImageDraw.Draw(picture)
    for i, (label, image) in enumerate(tiles):
        x, y = i % columns * (width + gap), i // columns * (height + strip + gap)
        if font.getlength(label) + size > width:
            raise SystemExit(f"sheets: '{label}' is wider than its picture")
        pen.text((x + size // 2, y + strip // 2), label, fill=INK, font=font, anchor="lm")
        if not isinstance(image, Image.Image):
            with Image.open(image) as file:
                image = file.convert("RGB")
        if image.size != (width, height):
            image = image.resize((width, height), Image.LANCZOS)
        picture.paste(image, (x, y + strip))
    pathlib.Path(out).parent.mkdir(parents=True, exist_ok=True)
    picture.save(out, quality=88, optimize=True)
