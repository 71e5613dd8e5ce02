"""Blender in a process of its own."""

import os
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent / "cli"))
from bench import attempt


def blender(script, *arguments, window=False, scripts=None):
    """`scripts`: where Blender installs add-ons. Blender takes its Python from the first python3 of the search path."""
    environment = {**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1", "PATH": f"{pathlib.Path(sys.executable).parent}:{os.environ['PATH']}"}
    if scripts:
        environment["BLENDER_USER_SCRIPTS"] = str(scripts)
    command = ["blender", "--factory-startup", "--threads", "2", "--python-exit-code", "1", "--python", HERE / script, "--", *arguments]
    if not window:
        command.insert(1, "--background")
        code, text = attempt(*command, env=environment)
    else:
        command.insert(1, "--enable-event-simulate")
        code, text = attempt("xvfb-run", "-a", *command, env=environment)
    if code != 0:
        raise RuntimeError(f"{script}: exit {code}: {text[-6000:]}")
