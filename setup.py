"""pip install --no-build-isolation .   The compiled module comes from CMake, in the folder of the release preset.

RODWAKE_BUILD names a build folder whose module is taken as it is.
"""

import os
import re
import shutil
import subprocess
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent


class BuildByCMake(build_ext):
    def build_extension(self, extension):
        build = Path(os.environ.get("RODWAKE_BUILD", ROOT / "build/release"))
        if "RODWAKE_BUILD" not in os.environ:
            subprocess.run(["cmake", "--preset", "release"], cwd=ROOT, check=True)
            subprocess.run(["cmake", "--build", build, "--target", "rodwake_python"], cwd=ROOT, check=True)
        (module,) = (build / "python/rodwake").glob("_core.*.so")
        target = Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(module, target)


setup(version=re.search(r"project\(rodwake VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1],
      ext_modules=[Extension("rodwake._core", sources=[])], cmdclass={"build_ext": BuildByCMake})
