"""Builds the wheel of cloudbake with CMake: the module, and the libraries that it opens, beside it.

  pip wheel --no-build-isolation --no-deps python/

CLOUDBAKE_BUILD=FOLDER takes them from a folder that cloudbake was built in, named from the root of the source tree, and builds
nothing but what is missing there. A portable build (CLOUDBAKE_PORTABLE) needs no libraries but those of the C language: its wheel is for
every Linux whose C library is new enough, and its name says so (PEP 600)."""

import os
import pathlib
import re
import shutil
import subprocess
import sys

import setuptools
from setuptools.command.build_ext import build_ext
from wheel.bdist_wheel import bdist_wheel  # type: ignore[import]

SOURCE = pathlib.Path(__file__).resolve().parent.parent


class BuildWithCMake(build_ext):
    def build_extension(self, ext):
        given = os.environ.get("CLOUDBAKE_BUILD")
        folder = SOURCE / (given or self.build_temp)
        if given and not (folder / "CMakeCache.txt").exists():
            sys.exit(f"CLOUDBAKE_BUILD: cloudbake was not built in {folder}")
        if not given:
            subprocess.run(["cmake", "-G", "Ninja", "-S", SOURCE, "-B", folder, "-DCMAKE_BUILD_TYPE=Release",
                            "-DCLOUDBAKE_PYTHON=ON", f"-DCLOUDBAKE_SYSTEM_PYTHON={sys.executable}"], check=True)
        subprocess.run(["cmake", "--build", folder, "--target", "cloudbake_python"], check=True)
        target = pathlib.Path(self.get_ext_fullpath(ext.name))
        if not (folder / "python" / "cloudbake" / target.name).exists():
            sys.exit(f"{folder} was built for another Python than {sys.executable}: use that one, or leave out CLOUDBAKE_BUILD")
        target.parent.mkdir(parents=True, exist_ok=True)
        for stale in target.parent.glob("*.so"):  # of another build, which may have had other libraries
            stale.unlink()
        late = [folder / name for name in ("libcloudbake_volumes.so", "libcloudbake_foreign.so")]
        if "CLOUDBAKE_PORTABLE:BOOL=ON" in (folder / "CMakeCache.txt").read_text(encoding="utf-8"):
            late = []
        for file in [folder / "python" / "cloudbake" / target.name, *late]:
            shutil.copy2(file, target.parent)
            subprocess.run(["strip", "--strip-unneeded", target.parent / file.name], check=True)


class WheelForManyLinux(bdist_wheel):
    def get_tag(self):
        python, abi, platform = super().get_tag()
        modules = list(pathlib.Path(self.bdist_dir or "").rglob("*.so"))
        told = "".join(subprocess.run(["readelf", "-dV", module], capture_output=True, text=True, check=True).stdout for module in modules)
        of_c = {"libc.so.6", "libm.so.6", "libpthread.so.0", "libdl.so.2", "ld-linux-x86-64.so.2", "ld-linux-aarch64.so.1"}
        if modules and set(re.findall(r"\(NEEDED\).*\[(.+)\]", told)) <= of_c:
            minor = max(int(number) for number in re.findall(r"\bGLIBC_2\.(\d+)", told))
            platform = platform.replace("linux_", f"manylinux_2_{minor}_", 1)
        return python, abi, platform


WORK = SOURCE / "build" / "wheel"
WORK.mkdir(parents=True, exist_ok=True)
setuptools.setup(
    version=re.search(r"project\(cloudbake VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text(encoding="utf-8"))[1],
    ext_modules=[setuptools.Extension("cloudbake._cloudbake", [])],
    cmdclass={"build_ext": BuildWithCMake, "bdist_wheel": WheelForManyLinux},
    options={"build": {"build_base": str(WORK)}, "egg_info": {"egg_base": str(WORK)}},
)
