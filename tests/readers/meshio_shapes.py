"""What meshio finds in files (package python3-meshio).

  meshio_shapes.py FILES.json FOLDER

FILES.json: paths by number. Writes NUMBER.shape or NUMBER.error into FOLDER."""

import json
import pathlib
import sys

import meshio

from shapes import Part, write_shape


def parts(path):
    mesh = meshio.read(path)
    corners = []
    for block in mesh.cells:
        if block.type in ("triangle", "quad", "polygon") or block.type.startswith("polygon"):
            corners += [corner for face in block.data for i in range(1, len(face) - 1) for corner in (face[0], face[i], face[i + 1])]
    points = [tuple(map(float, point)) for point in mesh.points]
    return [Part("mesh", None, [points[i] for i in corners])]


def main():
    folder = pathlib.Path(sys.argv[2])
    for number, path in json.loads(pathlib.Path(sys.argv[1]).read_text()).items():
        try:
            write_shape(folder / f"{number}.shape", parts(path))
        except (Exception, SystemExit) as problem:  # the library's, whatever it is
            (folder / f"{number}.error").write_text(f"{type(problem).__name__}: {problem}")


if __name__ == "__main__":
    main()
