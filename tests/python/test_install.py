"""cmake --install puts the package where Debian's interpreter finds it under the prefix."""

import os
import shutil
import subprocess
import sys
import unittest

from program import SOURCE, new_folder

CMAKE, BUILD = os.environ["RODWAKE_CMAKE"], os.environ["RODWAKE_BINARY_DIR"]
TRY = "import rodwake; print(rodwake.__file__); print(round(rodwake.simulate([[0, 0, 0]], t_end=2.0).poses[-1, 0, 0], 12))"


def install(prefix, **environment):
    subprocess.run([CMAKE, "--install", BUILD, "--prefix", prefix, "--component", "python"], check=True, capture_output=True,
                   env={**os.environ, **environment})


def imported(program=sys.executable, **environment):
    """What a fresh interpreter prints that knows no other rodwake."""
    clean = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    return subprocess.run([program, "-B", "-c", TRY], check=True, capture_output=True, text=True, cwd="/",
                          env={**clean, **environment}).stdout.splitlines()


class InstallTest(unittest.TestCase):
    def test_a_home_is_a_prefix(self):
        """~/.local is where the interpreter looks for what a user installed."""
        home = new_folder(self)
        install(home / ".local")
        place, value = imported(HOME=str(home), PYTHONUSERBASE=str(home / ".local"))
        self.assertTrue(place.startswith(str(home)), place)
        self.assertEqual(float(value), 2.0)

    def test_the_system_has_folders_of_its_own(self):
        root = new_folder(self)
        for prefix in ("/usr", "/usr/local"):
            install(prefix, DESTDIR=str(root))
            found = [path for path in sys.path if path.startswith(prefix + "/") and (root / path[1:] / "rodwake/__init__.py").is_file()]
            self.assertEqual(len(found), 1, (prefix, sys.path))
            stage = root / "_CPack_Packages/Linux/DEB/rodwake"  # what CPack does
            install(f"{stage}{prefix}")
            self.assertTrue((stage / found[0][1:] / "rodwake/__init__.py").is_file(), sorted(stage.rglob("rodwake")))

    def test_any_other_prefix_by_its_path(self):
        prefix = new_folder(self)
        install(prefix)
        (packages,) = prefix.glob("lib/python*/site-packages")
        place, value = imported(PYTHONPATH=str(packages))
        self.assertEqual((place, value), (str(packages / "rodwake/__init__.py"), "2.0"))
        installed = {path.name for path in (packages / "rodwake").iterdir()}
        self.assertTrue({"py.typed", "scenes.py"} <= installed, installed)

    def test_pip(self):
        """Into an environment of its own that sees Debian's packages, from a copy of the sources; nothing is loaded from elsewhere."""
        folder = new_folder(self)
        source, home = folder / "source", folder / "env"
        listed = subprocess.run(["git", "-C", SOURCE, "ls-files", "--cached", "--others", "--exclude-standard", "python", "plots", "convert", "*.toml", "setup.py",
                                 "README.md", "CMakeLists.txt"], check=True, capture_output=True, text=True).stdout.split()
        for name in listed:
            (source / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(SOURCE / name, source / name)
        subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", "--without-pip", home], check=True)
        python = home / "bin/python3"
        done = subprocess.run([python, "-m", "pip", "install", "--no-build-isolation", "--no-deps", "--no-index", "--quiet", source],
                              capture_output=True, text=True, env={**os.environ, "RODWAKE_BUILD": BUILD, "PYTHONPATH": ""})
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        place, value = imported(program=python)
        self.assertTrue(place.startswith(str(home)), place)
        self.assertEqual(value, "2.0")
        kinds = subprocess.run([python, "-B", "-c", "import rodwake; print(rodwake.plots.kinds(), rodwake.plots._plots('draw').__file__)"],
                               check=True, capture_output=True, text=True, cwd="/", env={**os.environ, "PYTHONPATH": ""}).stdout
        self.assertIn("phase_diagram", kinds)
        self.assertIn(str(home), kinds)


if __name__ == "__main__":
    unittest.main()
