"""rodwake fit among the other stages: of a granular run, of tracks of rods, and before the theory in the fitted medium."""

import json
import signal

import numpy as np
import rodwake
from fits import FIELD, FIT, FITTED, SIGMA, X, FitTest, columns
from rodwake import PAIR, wait_until

FIGURE = '[[figures]]\nname = "correlation"\nkind = "fit_correlation"\n'  # a quick one
RODS = """[coupling]
kappa = 0.5
[[rods]]
position = [0.0, 2.5]
[[rods]]
position = [0.0, -2.5]
[rods_run]
t_end = 20.0
output_interval = 5.0
[[variants]]
name = "repelled"
set = { "coupling.kappa" = -1.0 }
"""


class FittedMediumTest(FitTest):
    def test_rods_and_field_are_in_the_fitted_medium(self):
        self.make_profile()
        for name, periodic in (("plane", ""), ("box", "periodic = 30.0\n"), ("rectangle", "periodic = [30.0, 20.0]\n")):
            self.write("fitted.toml", FIT + FIELD + RODS + FIGURE + FITTED + periodic)
            self.expect(0, "run", "fitted.toml", "-o", name, "--quiet", "--no-figures")
            medium = json.loads((self.folder / name / "medium.json").read_text())
            found = {key: one["value"] for key, one in json.loads((self.folder / name / "fit.json").read_text())["parameters"].items()}
            self.assertEqual(medium["eta"], found["eta"])
            self.assertAlmostEqual(medium["xi"], found["xi"] / found["f_over_mu"])
            self.assertAlmostEqual(medium["alpha"] * medium["xi"], 1.0)
            self.assertGreater(medium["eta_stderr"], 0.0)
            self.assertIn("fitted = true", (self.folder / name / "scene.toml").read_text())
            self.assert_same_as_given(name, medium, periodic)
        self.assertEqual(len({(self.folder / name / "rods.csv").read_bytes() for name in ("plane", "box", "rectangle")}), 3)

    def assert_same_as_given(self, name, medium, periodic):
        """The numbers of medium.json in a scene give the same rods and field, to the last bit."""
        self.write("given.toml", "schema = 1\n" + FIELD + RODS + f"[medium]\neta = {medium['eta']!r}\nxi = {medium['xi']!r}\n{periodic}")
        for verb, files in (("field", ["field_cut_0.csv"]), ("rods", ["rods.csv", "variants/repelled/rods.csv"])):
            self.expect(0, verb, "given.toml", "-o", f"{name}_{verb}", "--quiet")
            for file in files:
                self.assertEqual((self.folder / name / file).read_bytes(), (self.folder / f"{name}_{verb}" / file).read_bytes(), file)

    def test_a_medium_at_a_bound_has_no_error_and_warns(self):
        self.make_profile(sigma=SIGMA / 8)  # so that eta = 0.6 is seen to be wrong
        text = FIT.replace("[[fit.prof", "bounds = { eta = [0.05, 0.6] }\n[[fit.prof").replace("eta = 2.0", "eta = 0.5")
        self.write("fitted.toml", text + FIELD + FIGURE + FITTED)
        done = self.expect(0, "run", "fitted.toml", "-o", "out", "--no-figures")
        medium = json.loads((self.folder / "out/medium.json").read_text())
        self.assertEqual((medium["eta"], medium["eta_stderr"]), (0.6, None))
        self.assertGreater(medium["xi_stderr"], 0.0)
        self.assertIn("debug: fitted medium: eta = 0.6, xi = ", (self.folder / "out/log.txt").read_text())
        self.assertRegex(done.stderr, "fitted medium: eta = 0.6 lies at a bound of fit.bounds")
        self.assertRegex(done.stderr, "fitted medium: the fit is poor, chi2 = ")
        self.assertRegex((self.folder / "out/log.txt").read_text(), "warning.*fitted medium: eta")

    def test_a_fixed_medium_has_no_error_and_does_not_warn(self):
        self.make_profile()
        text = FIT.replace('"eta", ', "").replace("[[fit.prof", "fixed = { eta = 1.3 }\n[[fit.prof").replace("eta = 2.0, ", "")
        self.write("fitted.toml", text + FIELD + FIGURE + FITTED)
        done = self.expect(0, "run", "fitted.toml", "-o", "out", "--no-figures")
        medium = json.loads((self.folder / "out/medium.json").read_text())
        self.assertEqual((medium["eta"], medium["eta_stderr"]), (1.3, None))
        self.assertGreater(medium["xi_stderr"], 0.0)
        self.assertNotIn("bound", done.stderr)
        self.assertNotIn("poor", done.stderr)

    def test_check_says_what_is_fitted(self):
        self.make_profile()
        self.write("fit.toml", FIT + RODS + FITTED + "periodic = 30.0\n")
        before = sorted(self.folder.rglob("*"))
        text = self.expect(0, "check", "fit.toml").stdout
        modelled, left_out = text.split("# modelled")[1].split("# not modelled")
        for part in ("fit of f_over_mu, eta, xi: slsqp from 1 start", f"{len(X)} of {len(X)} points of ux.csv", "monopole in an isotropic medium (f_over_mu)",
                     "medium: eta and xi from the fit", "periodic box of 30"):
            self.assertIn(part, modelled)
        for part in ("no dipole: f2d_over_mu is not in", "no images: no fit.box"):
            self.assertIn(part, left_out)
        self.assertRegex(text, rf"fit: 1 start, about 50 evaluations of the model, {len(X)} residuals, about \S+ [mun]?s\n")
        self.assertNotIn("nothing to compute", text)
        self.assertEqual(sorted(self.folder.rglob("*")), before)
        self.expect(0, "fit", "fit.toml", "--dry-run")
        self.assertEqual(sorted(self.folder.rglob("*")), before)


class TrajectoryTest(FitTest):
    def tracks(self, scale=(1.0, 1.0), more=()):
        """rods.csv of a pair, in units of a length and a speed."""
        self.write("pair.toml", PAIR.replace("contact_distance = 0.1\n", "rtol = 1e-11\n").replace("t_end = 60.0", "t_end = 30.0")
                   .replace("output_interval = 10.0", "output_interval = 1.5"))
        self.expect(0, "rods", "pair.toml", "-o", "pair", "--quiet", "--force", *more)
        table = columns(self.folder / "pair/rods.csv")
        length, speed = scale
        for name in table:
            table[name] = table[name] * (1.0 if "theta" in name else length / speed if name == "t" else length)
        lines = [",".join(table), *(",".join(repr(float(v)) for v in row) for row in zip(*table.values()))]
        self.write("tracks.csv", "\n".join(lines) + "\n")

    TRACKS = ('schema = 1\n[fit]\nparameters = ["kappa", "alpha"]\nstart = { kappa = 0.3, alpha = 1.5 }\nfixed = { eta = 1.0 }\n'
              '[[fit.trajectories]]\nfile = "tracks.csv"\n')

    def test_couplings_come_back_from_tracks(self):
        for scale in ((1.0, 1.0), (2e-3, 5e-3)):
            self.tracks(scale)
            found, _ = self.fit(self.TRACKS + f"f_over_mu = {scale[0]}\nspeed = {scale[1]}\n", out=f"out{scale[0]}")
            # the data carry the integration error of rtol = 1e-11
            self.assertAlmostEqual(found["parameters"]["kappa"]["value"], 0.5, delta=1e-6)
            self.assertAlmostEqual(found["parameters"]["alpha"]["value"], 1.0, delta=1e-6)
            track = found["trajectories"][0]
            self.assertEqual((track["rods"], track["data"]), (2, "fit_trajectory_0.csv"))
            table = columns(self.folder / f"out{scale[0]}" / track["data"])
            names = [f"{name}{rod}" for rod in (0, 1) for name in ("x", "y", "theta")]
            self.assertEqual(list(table), ["t", *names, *(f"model_{name}" for name in names)])
            np.testing.assert_allclose(table["model_y0"], table["y0"], atol=1e-6 * scale[0])
            self.assertLess(track["rms_position"], 1e-6 * scale[0])

    def test_rows_before_zero_count_unless_the_rods_are_held(self):
        self.tracks()
        fits = {}
        for name, shift in (("whole", 0.0), ("early", -7.25)):
            lines = (self.folder / "tracks.csv").read_text().splitlines()
            rows = [line.split(",") for line in lines[1:]]
            held = [[str(t), *rows[0][1:]] for t in (-3.0, -1.0)] if name == "whole" else []  # as a bed that settles
            moved = [[repr(float(row[0]) + shift), *row[1:]] for row in rows]
            self.write("tracks.csv", "\n".join([lines[0], *(",".join(row) for row in held + moved)]) + "\n")
            fits[name] = self.fit(self.TRACKS, out=name)[0]
            self.write("tracks.csv", "\n".join(lines) + "\n")
        for found in fits.values():
            self.assertEqual(found["dof"], fits["whole"]["dof"])
            self.assertAlmostEqual(found["parameters"]["kappa"]["value"], 0.5, delta=1e-6)
        self.assertEqual(len(columns(self.folder / "early/fit_trajectory_0.csv")["t"]), len(rows))

    def test_tracks_of_a_rectangle_are_fitted_in_it(self):
        short = ("-s", "rods_run.t_end=8.0", "-s", "rods_run.output_interval=0.8")  # a box costs 100 times the plane
        self.tracks(more=("-s", "medium.periodic=[12.0, 9.0]", *short))
        found, _ = self.fit(self.TRACKS, "-s", "fit.box=[12.0, 9.0]")
        self.assertEqual(found["box"], [12.0, 9.0])
        self.assertAlmostEqual(found["parameters"]["kappa"]["value"], 0.5, delta=1e-6)
        self.assertAlmostEqual(found["parameters"]["alpha"]["value"], 1.0, delta=1e-6)
        turned, _ = self.fit(self.TRACKS, "-s", "fit.box=[9.0, 12.0]", out="turned")
        self.assertGreater(abs(turned["parameters"]["kappa"]["value"] - 0.5), 1e-3)

    def test_headings_that_jump_by_turns_are_the_same_headings(self):
        self.tracks()
        plain, done = self.fit(self.TRACKS, out="plain")
        self.assertNotIn("unwrapped", done.stderr)
        lines = (self.folder / "tracks.csv").read_text().splitlines()
        for i in range(2, len(lines), 2):
            row = lines[i].split(",")
            row[3] = repr(float(row[3]) + 2.0 * np.pi)
            lines[i] = ",".join(row)
        self.write("tracks.csv", "\n".join(lines) + "\n")
        found, done = self.fit(self.TRACKS)
        self.assertEqual(done.stderr.count("were unwrapped"), 1)
        for name in ("kappa", "alpha"):  # adding and taking 2 pi costs 1e-15, the tracks are good to 1e-11
            self.assertAlmostEqual(found["parameters"][name]["value"], plain["parameters"][name]["value"], delta=1e-8)

    def changed(self, change):
        """tracks.csv with its columns changed."""
        table = columns(self.folder / "tracks.csv")
        change(table)
        lines = [",".join(table), *(",".join(repr(float(v)) for v in row) for row in zip(*table.values()))]
        self.write("changed.csv", "\n".join(lines) + "\n")

    def test_tracks_in_other_units_are_noticed(self):
        self.tracks()
        self.write("fit.toml", self.TRACKS.replace("tracks.csv", "changed.csv"))

        def degrees(table):
            for name in ("theta0", "theta1"):
                table[name] = np.degrees(table[name])

        def metres(table):
            for name in ("x0", "y0", "x1", "y1"):
                table[name] = 9e-4 * table[name]
            table["t"] = 0.3 * table["t"]

        for change, words in ((degrees, "the headings look like degrees: .*multiply theta by pi/180"), (metres, "the rods move at 0.003 .*f_over_mu and speed of")):
            self.changed(change)
            self.refuse(2, words, "fit", "fit.toml", "-o", "none")

        def slow(table):
            table["t"] = 2.0 * table["t"]

        def turned(table):
            for name in ("theta0", "theta1"):
                table[name] = 0.5 * np.pi - table[name]

        few = ("-s", "fit.max_evaluations=20", "-s", "fit.polish=false")
        for change, words in ((slow, "the rods move at 0.5 in reduced units"), (turned, "do not move along their headings")):
            self.changed(change)
            self.write("fit.toml", self.TRACKS.replace("tracks.csv", "changed.csv"))
            self.assertRegex(self.run_program("fit", "fit.toml", "-o", change.__name__, *few).stderr, words)  # it may fail
        self.changed(slow)  # 0.5 in the file, which is twice the speed that the scene says
        stderr = self.run_program("fit", "fit.toml", "-o", "reported", *few, "-s", "fit.trajectories.0.speed=0.25").stderr
        self.assertRegex(stderr, r"the rods move at 2 in reduced units.* speed = 0\.5 would do")

    def test_rods_of_an_si_scene_are_fitted_by_the_same_scene(self):
        scales = 'units = "si"\n[scales]\nf_over_mu = "2 mm"\nv0 = "3 mm/s"\n'
        pair = PAIR.split("[rods_run]")[0].replace('title = "a pair"\n', scales).replace("kappa = 0.5", 'kappa = "0.75 1/s"').replace("2.5]", "0.005]")
        fit = self.TRACKS.replace("schema = 1\n", "").replace("tracks.csv", "si/rods.csv")
        self.write("si.toml", pair + "[rods_run]\nt_end = 20.0\noutput_interval = 1.0\nrtol = 1e-11\n" + fit)
        self.expect(0, "rods", "si.toml", "-o", "si", "--quiet")
        self.assertEqual(columns(self.folder / "si/rods.csv")["y0"][0], 0.005)
        self.expect(0, "fit", "si.toml", "-o", "out", "--quiet")
        kappa = json.loads((self.folder / "out/fit.json").read_text())["parameters"]["kappa"]
        self.assertAlmostEqual(kappa["value"], 0.75 * 2.0 / 3.0, delta=1e-6)  # kappa f/(mu v0)
        self.assertEqual(kappa["unit"], "v0 mu/f")
        words = self.expect(0, "check", "si.toml", "-s", "fit.trajectories.0.f_over_mu=4 mm", "-s", "fit.trajectories.0.speed=5 mm/s").stdout
        self.assertRegex(words, r"(?s)\[\[fit.trajectories\]\].*f_over_mu = 0\.004\n.*speed = 0\.005\n")
        self.refuse(2, "unknown unit|f/mu", "check", "si.toml", "-s", "fit.trajectories.0.f_over_mu=4 f/mu")

    def test_xi_starts_at_1_for_tracks_alone(self):
        self.tracks()
        text = self.TRACKS.replace('"alpha"]', '"xi"]').replace(", alpha = 1.5", "")
        found, _ = self.fit(text)
        self.assertEqual(found["parameters"]["xi"]["start"], 1.0)
        self.assertAlmostEqual(found["parameters"]["xi"]["value"], 1.0, delta=1e-6)
        self.assertRegex(self.expect(0, "check", "fit.toml").stdout, r"fit: 1 start, .* 120 residuals")

    def test_free_headings_and_the_time_of_contact(self):
        self.write("pair.toml", PAIR.replace("output_interval = 10.0", "output_interval = 2.0\nrtol = 1e-11"))
        self.expect(0, "rods", "pair.toml", "-o", "pair", "--quiet")
        contact = json.loads((self.folder / "pair/outcome.json").read_text())["time"]
        rows = (self.folder / "pair/rods.csv").read_text().splitlines()
        self.write("tracks.csv", "\n".join(rows[:-1]) + "\n")  # the last is the contact
        text = self.TRACKS.replace('"kappa", "alpha"', '"kappa"').replace("eta = 1.0", "eta = 1.0, alpha = 1.0") + (
            f"free_headings = true\nsigma_position = 0.01\nsigma_heading = 0.01\ncontact_distance = 0.1\ncontact_time = {contact!r}\nsigma_contact = 0.01\n")
        found, _ = self.fit(text)
        self.assertAlmostEqual(found["parameters"]["kappa"]["value"], 0.5, delta=1e-6)
        for name in ("heading.0.0", "heading.0.1"):
            self.assertAlmostEqual(found["parameters"][name]["value"], 0.0, delta=1e-6)
            self.assertEqual(found["parameters"][name]["unit"], "rad")
        self.assertEqual((found["parameters"]["y.0.0"]["unit"], len(found["free"])), ("f/mu", 7))  # sigma is given: the whole start
        for poses, names in (("exact", {"heading.0.0", "heading.0.1"}), ("fitted", {f"{name}.0.{rod}" for name in ("x", "y", "heading") for rod in (0, 1)})):
            other, _ = self.fit(text, "-s", f"fit.trajectories.0.start_poses={poses}", "-s", "fit.method=lbfgs", out=poses)
            self.assertEqual(set(other["free"]) - {"kappa"}, names)

    def test_profiles_and_tracks_together(self):
        self.write("pair.toml", PAIR.replace("contact_distance = 0.1\n", "rtol = 1e-11\n").replace("60.0", "20.0")
                   .replace("output_interval = 10.0", "output_interval = 2.0").replace("alpha = 1.0", "alpha = 0.1").replace("eta = 1.0", "eta = 1.3"))
        self.expect(0, "rods", "pair.toml", "-o", "pair", "--quiet")
        self.make_profile()
        text = FIT.replace('"xi"]', '"alpha", "kappa"]').replace("xi = 15.0", "alpha = 0.2") + (
            '[[fit.trajectories]]\nfile = "pair/rods.csv"\nsigma_position = 0.01\nsigma_heading = 0.01\n')
        found, _ = self.fit(text)
        self.assert_recovered(found, {"f_over_mu": 2.2, "eta": 1.3, "alpha": 0.1, "kappa": 0.5})
        alone, _ = self.fit(FIT, out="alone")
        self.assertLess(found["parameters"]["eta"]["stderr"], alone["parameters"]["eta"]["stderr"])

    def test_bad_tracks(self):
        for data, pattern in (("t,x0,y0\n0,1,2\n", r'tracks\.csv:1:1: no column "theta0"'),
                              ("t,x0,y0,theta0,x1,y1\n0,1,2,0,1,1\n1,1,2,0,1,1\n", "rod 1 lacks one of the columns"),
                              ("t,x0,y0,theta0\n0,1,2,0\n", "at least two rows"),
                              ("t,x0,y0,theta0,x1,y1,theta1\n0,1,2,0,1,1,0\n1,1,2,nan,1,1,0\n", "at least two rows in which all its rods are known")):
            self.write("tracks.csv", data)
            self.write("fit.toml", self.TRACKS)
            self.refuse(2, pattern, "fit", "fit.toml", "-o", "out")


BED = """schema = 1
[granular]
phi_b = 0.80
box = "32 a"
equilibrate = "0.05 s"
duration = "1 s"
[granular.output]
frames = "0.025 s"
last_period = false
[[granular.rods]]
position = ["16 a", "16 a"]
imposed_speed = "3 mm/s"
[measure]
displacement = "phase"
block = "0.25 s"
[fit]
parameters = ["f_over_mu", "offset"]
fixed = { eta = 1.0, xi = 10.0 }
core = 4.0
[[fit.profiles]]
file = "profile_Ux_x.csv"
""" + FIGURE


class OfARunTest(FitTest):
    def test_fit_adds_to_a_finished_run_and_run_does_all(self):
        self.write("bed.toml", BED)
        self.refuse(2, "profile_Ux_x.csv: no such file to fit; .*rodwake run makes what this scene measures", "fit", "bed.toml", "-o", "run")
        self.assertIn("which the run makes", self.expect(0, "check", "bed.toml").stdout)
        self.expect(0, "dem", "bed.toml", "-o", "run", "--quiet")
        self.expect(0, "measure", "bed.toml", "-o", "run", "--quiet")
        self.write("profile_Ux_x.csv", "x,value\n1,2\n2,3\n3,4\n")  # that of the run comes first
        done = self.expect(0, "fit", "bed.toml", "-o", "run")
        self.assertRegex((self.folder / "run/log.txt").read_text(), r"fit: profile \S+ from run/profile_Ux_x\.csv")
        found = json.loads((self.folder / "run/fit.json").read_text())
        self.assertEqual(found["free"], ["f_over_mu", "offset"])
        self.refuse(0, "holds a finished run", "fit", "bed.toml", "-o", "run")
        self.assert_goes_on_after_a_stop()
        self.expect(0, "fit", "bed.toml", "-o", "run", "--force", "-s", "fit.core=5.0", "--quiet")
        self.assertIn("core = 5.0", (self.folder / "run/scene.toml").read_text())
        (self.folder / "profile_Ux_x.csv").unlink()
        self.expect(0, "run", "bed.toml", "-o", "whole", "--quiet", "--no-figures")
        whole = json.loads((self.folder / "whole/fit.json").read_text())
        self.assertEqual(whole["parameters"], found["parameters"])

    def assert_goes_on_after_a_stop(self):
        command = ("fit", "bed.toml", "-o", "run", "--quiet", "-s", "fit.starts=5000", "-s", "fit.box=32.0")
        ledger = self.folder / "run/fit.log"
        with self.started(*command, "--force") as process:
            self.assertTrue(wait_until(lambda: ledger.exists() and ledger.stat().st_size > 5000, 30), "no start was done")
            code, _, err = self.stop(process, signal.SIGTERM, 5.0)
        self.assertEqual(code, 143, err)
        stopped = json.loads((self.folder / "run/fit.json").read_text())
        self.assertEqual(stopped["termination"], "interrupted")
        done = self.expect(0, *command, "-s", "fit.starts=5")  # another search: from the beginning, without --force
        self.assertNotIn("resuming", done.stderr)
        self.assertEqual(len(json.loads((self.folder / "run/fit.json").read_text())["starts"]), 5)


if __name__ == "__main__":
    rodwake.main()
