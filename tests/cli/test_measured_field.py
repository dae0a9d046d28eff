"""medium.field = "measured": rods and field in the displacement field of a measure.h5, with its errors."""

import csv
import json

import h5py
import numpy as np
import rodwake
from fits import columns
from rodwake import ProgramTest, snapshot

SIDE, SPACING, A, F_OVER_MU = 32, 3.0, 0.4e-3, 4.0  # bins; a; m; a
ETA, XI, BOX = 1.3, 5.0, SIDE * SPACING / F_OVER_MU  # of the field in the file; f/mu
SCENE = f"""schema = 1
[scales]
f_over_mu = "{F_OVER_MU} a"
v0 = "1.4 mm/s"
[medium]
field = "measured"
eta = 0.8
xi = 4.0
periodic = "96 a"
[medium.measured]
file = "measure.h5"
core = "8 a"
blend = "8 a"
samples = 6
[coupling]
kappa = 2.0
[[rods]]
position = [0.0, 3.0]
[[rods]]
position = [0.0, -3.0]
[rods_run]
t_end = 6.0
output_interval = 1.0
"""
FIELD = '[[field.cuts]]\nfrom = "20 a"\nto = "28 a"\ncount = 5\nat = "6 a"\n'


class MeasuredFieldTest(ProgramTest):
    def make(self, name="measure.h5", sigma=0.01, blocks=20, count=5.0):
        """The exact field of (ETA, XI) in its box, as rodwake measure writes one; lengths in a."""
        places = (np.arange(SIDE) - SIDE // 2) * SPACING
        rows = "".join(f"{x / F_OVER_MU},{y / F_OVER_MU},{XI},{ETA},{BOX}\n" for y in places for x in places)
        self.write("points.csv", "x,y,xi,eta,L\n" + rows)
        out = self.run_program("field", "--points", "points.csv").stdout  # nan at the rod
        field = [[float(row[c] or 0) for c in ("Ux", "Uy")] for row in csv.DictReader(out.splitlines())]
        U = np.nan_to_num(np.array(field)).reshape(SIDE, SIDE, 2) * F_OVER_MU
        with h5py.File(self.folder / name, "w") as h5:
            h5.attrs.update(bead_radius=A, phi_b=0.78)
            group = h5.create_group("displacement")
            group.attrs.update(spacing=SPACING, blocks=np.int64(blocks))
            size = np.hypot(*np.meshgrid(places, places))
            for key, values in {"x": places, "y": places, "Ux": U[..., 0], "Uy": U[..., 1], "sigma_x": np.full((SIDE, SIDE), sigma),
                                "sigma_y": np.full((SIDE, SIDE), sigma), "count": np.where(size > 4, count, 0.0)}.items():
                group[key] = values
                group[key].attrs["unit"] = "a"

    def rods(self, name, *more):
        self.expect(0, "rods", "scene.toml", "-o", name, "--quiet", *more)
        return columns(self.folder / name / "rods.csv")

    def outcome(self, name):
        return json.loads((self.folder / name / "outcome.json").read_text())

    def test_rods_go_as_in_the_field_that_was_sampled(self):
        self.make(sigma=1e-4)
        self.write("scene.toml", SCENE)
        found = self.rods("out")
        exact = self.rods("exact", "-s", "medium.field=exact", "-s", f"medium.eta={ETA}", "-s", f"medium.xi={XI}")
        other = self.rods("other", "-s", "medium.field=exact")
        turn = np.abs(exact["theta0"][-1])
        self.assertGreater(np.abs(other["theta0"][-1] - exact["theta0"][-1]), 0.1 * turn)  # theory alone is wrong
        # bins 0.75 f/mu apart, knots twice that, 6 f/mu from the rod: a few per cent of the strain
        self.assertLess(np.abs(found["theta0"][-1] - exact["theta0"][-1]), 0.03 * turn)
        text = (self.folder / "out/log.txt").read_text()
        self.assertRegex(text, "measured field: .*measure.h5")
        self.assertRegex(text, r"measured field, Ux: smoothing \S+, chi2 \S+ of \d+ bins")

    def test_errors_are_carried_to_the_rods(self):
        self.make(sigma=0.1)
        self.write("scene.toml", SCENE)
        found = self.rods("out", "-j", "1")
        record = self.outcome("out")["ensemble"]
        samples = self.samples("out")
        self.assertEqual(record["samples"], 6)
        self.assertEqual(sum(record[key] for key in ("contact", "pursuit", "escape", "undecided", "failed")), 6)
        last = samples["final_separation"]
        self.assertAlmostEqual(record["final_separation"]["mean"], last.mean(), places=12)
        self.assertAlmostEqual(record["final_separation"]["spread"], last.std(ddof=1), places=12)
        central = np.hypot(found["x0"] - found["x1"], found["y0"] - found["y1"])[-1]
        self.assertLess(abs(last.mean() - central), 5 * last.std(ddof=1))
        with h5py.File(self.folder / "out/result.h5") as h5:
            self.assertEqual(h5["/rods/scene/ensemble/x"].shape, (6, 7, 2))
        self.rods("threads", "-j", "3")
        for name in ("rods.csv", "ensemble.csv", "outcome.json"):
            self.assertEqual((self.folder / "out" / name).read_bytes(), (self.folder / "threads" / name).read_bytes(), name)
        self.rods("seeded", "--seed", "7")
        self.assertNotEqual((self.folder / "out/ensemble.csv").read_bytes(), (self.folder / "seeded/ensemble.csv").read_bytes())
        self.make(sigma=0.01)
        self.rods("sharp", "-s", "medium.measured.smoothing=0.1")
        self.make(sigma=0.1)
        self.rods("blunt", "-s", "medium.measured.smoothing=0.1")
        sharp, blunt = (self.outcome(name)["ensemble"]["final_separation"]["spread"] for name in ("sharp", "blunt"))
        self.assertAlmostEqual(blunt / sharp, 10.0, delta=3.0)  # the same draws, ten times as large
        self.rods("none", "-s", "medium.measured.samples=0")
        self.assertNotIn("ensemble", self.outcome("none"))
        self.assertFalse((self.folder / "none/ensemble.csv").exists())

    def samples(self, name):
        lines = (self.folder / name / "ensemble.csv").read_text().splitlines()
        rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
        return {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}

    def test_field_and_variants(self):
        self.make(sigma=1e-4)
        self.write("scene.toml", SCENE + FIELD + '[[variants]]\nname = "theory"\nset = { "medium.field" = "exact" }\n')
        before = snapshot(self.folder)
        text = self.expect(0, "check", "scene.toml").stdout
        self.assertIn("field measured in measure.h5", text)
        self.expect(0, "rods", "scene.toml", "--dry-run")
        self.assertEqual(snapshot(self.folder), before)
        self.expect(0, "run", "scene.toml", "-o", "out", "--quiet", "--no-figures")
        self.assertFalse((self.folder / "out/variants/theory/ensemble.csv").exists())
        self.assertTrue((self.folder / "out/ensemble.csv").exists())
        self.expect(0, "field", "scene.toml", "-o", "exact", "-s", "medium.field=exact", "-s", f"medium.eta={ETA}",
                    "-s", f"medium.xi={XI}", "--quiet")
        found, exact = (columns(self.folder / name / "field_cut_0.csv") for name in ("out", "exact"))
        rise = np.ptp(exact["Ux"])
        self.assertLess(np.ptp(found["Ux"] - exact["Ux"]), 0.03 * rise)  # less a constant; a few per cent as above

    def test_what_is_wrong_is_named(self):
        self.write("scene.toml", SCENE)
        for verb in ("rods", "check"):
            self.refuse(2, r'medium.measured.file = "measure.h5": no such file; looked for .*measure.h5; rodwake run of a scene',
                        verb, "scene.toml", *(["-o", "out"] if verb == "rods" else []))
        self.write("measure.h5", "no HDF5")
        self.refuse(2, "measure.h5", "rods", "scene.toml", "-o", "out")
        with h5py.File(self.folder / "measure.h5", "w") as h5:
            h5.attrs.update(bead_radius=A, phi_b=0.78)
        self.refuse(2, r"has no displacement field \(/displacement\)", "rods", "scene.toml", "-o", "out")
        self.make(blocks=1)
        self.refuse(2, "errors of its field are unknown, because it was measured in 1 block", "rods", "scene.toml", "-o", "out")
        self.rods("plain", "-s", "medium.measured.samples=0")
        self.make(blocks=1, sigma=np.nan)  # as measured: all bins count alike
        self.rods("unknown", "-s", "medium.measured.samples=0")
        self.make(sigma=0.0)
        self.refuse(2, "sigma_x or sigma_y of /displacement is not above 0", "rods", "scene.toml", "-o", "out")
        self.make(count=0.0)
        self.refuse(2, "no bin of /displacement has data", "rods", "scene.toml", "-o", "out")
        self.make()
        self.refuse(2, r"core = 9, blend = 2, .*at most 11.25, where the measured field ends", "rods", "scene.toml", "-o", "out",
                    "-s", "medium.measured.core=9.0")
        self.write("bare.toml", SCENE.replace("[medium.measured]\n", "[not]\n").split("[not]")[0] + SCENE[SCENE.index("[coupling]"):])
        self.refuse(2, r'bare.toml:\d+:\d+: medium.field = "measured" needs \[medium.measured\] with file', "check", "bare.toml")
        plain = "schema = 1\n" + SCENE[SCENE.index("[medium]"):].replace('"96 a"', "24.0").replace('"8 a"', "2.0")
        self.write("plain.toml", plain)
        self.refuse(2, r"plain.toml:\d+:\d+: .*needs \[scales\] with f_over_mu", "check", "plain.toml")


if __name__ == "__main__":
    rodwake.main()
