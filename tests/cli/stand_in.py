"""Puts code of a test into the program and into all processes that it starts. They do not pass LD_PRELOAD on, so the code takes the place
of a library that the program is linked with, and loads that one in turn."""

import os
import pathlib
import shutil
import subprocess

LIBRARY = "libtomlplusplus"


class StandIn:
    """`source` is C. It may read the file "settings" in its own folder (dladdr)."""

    def __init__(self, binary, folder, source):
        self.folder, self.count = pathlib.Path(folder), 0
        self.folder.mkdir()
        listed = subprocess.run(["ldd", binary], capture_output=True, text=True, check=True).stdout
        self.name, place = next(line.split()[0:3:2] for line in listed.splitlines() if LIBRARY in line)
        code, stub, self.library = self.folder / "source.c", self.folder / "stub.so", self.folder / "library.so"
        code.write_text(source, encoding="utf-8")
        compiler = os.environ.get("CC", "cc")
        subprocess.run([compiler, "-shared", f"-Wl,-soname,{place}", "-o", stub, "-x", "c", "/dev/null"], check=True)
        subprocess.run([compiler, "-shared", "-fPIC", "-O1", "-o", self.library, code, "-Wl,--no-as-needed", stub, "-ldl"], check=True)

    def environment(self, settings=""):
        """Of a process that is to run the code."""
        self.count += 1
        folder = self.folder / str(self.count)
        folder.mkdir()
        shutil.copy(self.library, folder / self.name)
        (folder / "settings").write_text(settings, encoding="utf-8")
        return {**os.environ, "LD_LIBRARY_PATH": str(folder)}
