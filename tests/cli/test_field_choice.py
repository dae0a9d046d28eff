"""medium.field = "auto" through the program: what is chosen is told, the same to the bit as if it had been named, and tables of boxes
are kept between runs."""

import json
import os

import h5py
from rodwake import ProgramTest

SCENE = """schema = 1
[medium]
eta = 1.0
xi = 1.0
periodic = 2.0
field = "auto"
[coupling]
kappa = 1.0
[[rods]]
position = [0.0, 0.0]
[[rods]]
position = [0.3, 0.9]
heading = 1.0
[rods_run]
t_end = 2.0
rtol = 1e-4
[[variants]]
name = "short"
set = { "rods_run.t_end" = 0.01 }
"""
LONG = "-s", "rods_run.t_end=20"


class FieldChoiceTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("auto.toml", SCENE)
        self.environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"))

    def rods(self, name, *options):
        done = self.expect(0, "rods", "auto.toml", "-o", name, *LONG, *options, env=self.environment)
        return (self.folder / name / "rods.csv").read_bytes(), done.stdout + done.stderr

    def solver(self, name, folder=""):
        return json.loads((self.folder / name / folder / "outcome.json").read_text())["solver"]

    def test_what_is_chosen_is_told_and_is_as_if_named(self):
        chosen, words = self.rods("auto")
        self.assertIn("rods: field table: ", words)
        self.assertIn("rods (short): field exact: ", words)
        self.assertEqual((self.solver("auto")["field"], self.solver("auto")["field_tolerance"]), ("table", 1e-4))
        self.assertIn("right-hand sides", self.solver("auto")["field_chosen"])
        self.assertEqual(self.solver("auto", "variants/short")["field"], "exact")
        with h5py.File(self.folder / "auto/result.h5") as results:
            self.assertEqual(results["rods/scene"].attrs["field"].decode(), "table")
        named, words = self.rods("named", "-s", "medium.field=table", "-s", "medium.table.tolerance=1e-4")
        self.assertNotIn("table of the wake", words)  # it was kept
        self.assertEqual([file.name[:4] for file in (self.folder / "cache/rodwake").iterdir()], ["box-"])
        self.assertEqual(chosen, named)
        self.assertNotEqual(chosen, self.rods("exact", "-s", "medium.field=exact")[0])

    def test_check_tells(self):
        text = self.expect(0, "check", "auto.toml", *LONG, env=self.environment).stdout
        self.assertIn("field chosen for the rods: table (", text)
        self.assertIn("field chosen for the rods (short): exact (", text)
        self.assertIn('field = "auto"', text)


if __name__ == "__main__":
    import rodwake
    rodwake.main()
