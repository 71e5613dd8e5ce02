"""What the scripts share that make the tables and pictures of docs/: a run of the program, its report, Markdown, and assets as shapes."""

import argparse
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tests/cli"))
import bench
import glb
from bench import demand, run, temporary_folder

BINARY = ROOT / "build/release/cloudbake"


def command_line(doc):
    """With the program, and the folder of scripts/fetch_sculpts."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", default=BINARY, type=lambda path: pathlib.Path(path).resolve())
    parser.add_argument("--sculpts", default=ROOT / "build/sculpts", type=pathlib.Path)
    return parser


def report_of(binary, *words, codes=(0,)):
    """The report of a command, or its error as an object, and its exit code. `{}` in a word is a folder for outputs."""
    with temporary_folder() as folder:
        done = run(binary, *(str(word).replace("{}", str(folder)) for word in words), "-q", "--json", folder / "report.json", code=None)
        demand(done.returncode in codes, f"exit {done.returncode}: {words}\n{done.stderr}")
        return bench.Bench(binary, folder, None).json("report.json"), done.returncode


def row(cells):
    return "| " + " | ".join(map(str, cells)) + " |"


def print_head(*columns):
    """A table's first two lines; columns with a '>' before their name are numbers."""
    print(row(column.removeprefix(">") for column in columns), row("---:" if column[0] == ">" else "---" for column in columns), sep="\n",
          flush=True)


def shape_of(path):
    """Positions in scene space, and triangles, of an asset."""
    document, binary = glb.read_glb(path)
    points: list[tuple[float, ...]] = []
    faces: list[tuple[int, ...]] = []
    for primitive, matrix in glb.drawn(document):
        corners = [len(points) + index for (index,) in glb.values(document, binary, primitive["indices"])]
        points += [tuple(glb.transformed(matrix, point)) for point in glb.values(document, binary, primitive["attributes"]["POSITION"])]
        faces += zip(corners[::3], corners[1::3], corners[2::3])
    return points, faces
