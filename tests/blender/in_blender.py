"""What every script has to do that Blender runs: import this module first, for bpy and numpy, and end in run(main)."""

import sys
import traceback

import numpy

# Blender 3.4 asks numpy 1.24 for names that it dropped.
for _name, _kind in (("bool", bool), ("object", object), ("int", int), ("float", float)):
    if _name not in numpy.__dict__:
        setattr(numpy, _name, _kind)

import bpy

__all__ = ["bpy", "numpy", "run"]


def run(main):
    """Runs it. Blender itself would go on after an exception and exit with 0."""
    try:
        main()
    except BaseException:  # whatever it is
        traceback.print_exc()
        sys.exit(1)
