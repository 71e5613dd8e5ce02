"""The surface that OpenVDB's own mesher finds in files (package python3-openvdb), by the value that cloudbake documents.

  openvdb_shapes.py FILES.json FOLDER

FILES.json: paths by number. Writes NUMBER.shape or NUMBER.error into FOLDER."""

import json
import pathlib
import sys

import pyopenvdb

from shapes import Part, write_shape


def iso_of_fog(grid):
    """5 % of the mean value, as docs/converting_sculpts.md says."""
    values = [(item.value, item.count) for item in grid.citerOnValues()]
    return 0.05 * sum(value * count for value, count in values) / sum(count for _, count in values)


def parts(path):
    grids = [grid for grid in pyopenvdb.readAll(path)[0] if isinstance(grid, pyopenvdb.FloatGrid)]
    if not grids:
        raise ValueError("no grid of floats")
    levels = [grid for grid in grids if grid.gridClass == pyopenvdb.GridClass.LEVEL_SET]
    grid = (levels or grids)[0]
    points, quads = grid.convertToQuads(isovalue=0.0 if levels else iso_of_fog(grid))
    points = [tuple(map(float, point)) for point in points]
    # A quad (a, b, c, d) of the mesher is seen from inside.
    corners = [int(corner) for a, b, c, d in quads for corner in (a, c, b, a, d, c)]
    return [Part(grid.name, None, [points[i] for i in corners])]


def main():
    folder = pathlib.Path(sys.argv[2])
    for number, path in json.loads(pathlib.Path(sys.argv[1]).read_text()).items():
        try:
            write_shape(folder / f"{number}.shape", parts(path))
        except Exception as problem:  # the library's, whatever it is
            (folder / f"{number}.error").write_text(f"{type(problem).__name__}: {problem}")


if __name__ == "__main__":
    main()
