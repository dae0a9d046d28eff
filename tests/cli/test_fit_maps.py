"""rodwake fit on displacement maps: a made-up medium comes back, with errors by their cause; wrong input is said."""

import json

import h5py
import numpy as np
import rodwake
from fits import FitTest, columns

BOX, SPEED, LENGTH, WIDTH, SIGMA = (72.0, 66.0), 1.7, 11.25, 2.0, 0.004
TRUE = {"amplitude": 0.8, "force": 2.0, "p_xx": -3.0, "p_yy": 9.0, "c11": 3.1, "c22": 4.4, "c12": 1.3, "c66": 1.0, "zeta": 0.05, "rho": 0.03,
        "eta_s": 0.15}
FIXED = ", ".join(f"{name} = {TRUE[name]}" for name in ("force", "c11", "c22", "c12", "c66", "zeta", "rho", "eta_s"))
KEYS = f"""schema = 1
[fit]
parameters = ["amplitude", "p_xx", "p_yy", "offset"]
fixed = {{ {FIXED} }}
rod_length = {LENGTH}
source_width = {WIDTH}
"""
MAPS = """[[fit.maps]]
files = ["run0.csv", "run1.csv", "run2.csv"]
box = [72.0, 66.0]
speed = 1.7
"""
MASKS = "[[fit.masks]]\nstrip = 8.0\nradius = 10.0\n[[fit.masks]]\nstrip = 6.0\nradius = 8.0\n"


def places(count, side):
    return side * (np.arange(count) / count - 0.5)


def field(x, y, amplitude, force, p_xx, p_yy, c11, c22, c12, c66, zeta, rho, eta_s, q_xxx=0.0, q_xyy=0.0, q_yxy=0.0):
    """The equation mode by mode, all four quadrants, by complex exponentials: [component][y][x]."""
    modes = [2 * np.pi * np.arange(-60, 61) / side for side in BOX]
    qx, qy = modes[0][:, None], modes[1][None, :]
    square, v = qx**2 + qy**2, SPEED
    motion = -1j * zeta * v * qx - rho * v**2 * qx**2 - 1j * eta_s * v * qx * square
    xx, yy, xy = c11 * qx**2 + c66 * qy**2 + motion, c66 * qx**2 + c22 * qy**2 + motion, (c12 + c66) * qx * qy
    smooth = np.exp(-square * WIDTH**2 / 2)
    sx = smooth * (amplitude * force * np.sinc(qx * LENGTH / 2 / np.pi) - 1j * p_xx * qx - q_xxx * qx**2 - q_xyy * qy**2)
    sy = smooth * (-1j * p_yy * qy - 2 * q_yxy * qx * qy)
    determinant = xx * yy - xy**2
    determinant[60, 60] = np.inf  # the zero mode
    found = []
    for mode in ((yy * sx - xy * sy) / determinant, (xx * sy - xy * sx) / determinant):
        found.append((np.exp(1j * np.outer(y, modes[1])) @ mode.T @ np.exp(1j * np.outer(modes[0], x))).real / (BOX[0] * BOX[1]))
    return np.array(found)


class MapTest(FitTest):
    def make_run(self, name, seed, sigma=SIGMA, **changed):
        x, y = places(30, BOX[0]), places(28, BOX[1])
        U = field(x, y, **(TRUE | changed))
        U += np.random.default_rng(seed).normal(scale=sigma, size=U.shape)
        U[0] += 0.01
        U[0][np.abs(y) < 5] += 0.3  # a ridge that the theory knows nothing of
        rows = [f"{x[k]!r},{y[j]!r},{U[0, j, k]!r},{U[1, j, k]!r},{sigma!r},{sigma!r}" for j in range(y.size) for k in range(x.size)]
        self.write(name, "x,y,Ux,Uy,sigma_x,sigma_y\n" + "\n".join(rows).replace("np.float64(", "").replace(")", "") + "\n")

    def make_runs(self):
        for index in range(3):
            self.make_run(f"run{index}.csv", index)

    def assert_refused(self, text, *found):
        self.write("wrong.toml", text)
        done = self.expect(2, "check", "wrong.toml")
        for part in found:
            self.assertIn(part, done.stderr)


class RecoveryTest(MapTest):
    def test_an_isotropic_medium_comes_back_with_errors_of_what_follows_from_it(self):
        f, eta, area = 1.5, 2.0, 200.0
        medium = {"amplitude": 1.0, "force": f, "c11": 1 + eta, "c22": 1 + eta, "c12": eta - 1, "c66": 1.0, "zeta": f / area / SPEED, "rho": 0.0,
                  "eta_s": 0.0}
        for index in range(3):
            self.make_run(f"run{index}.csv", index, **medium)
        self.write("line.csv", "x,value,sigma\n" + "".join(f"{x},{0.5 / (1 + abs(x) / 20):.6f},0.02\n" for x in range(-30, 31, 2)))
        found, _ = self.fit(KEYS.replace('"amplitude", "p_xx"', '"f_over_mu", "eta", "p_xx"').replace(FIXED, f"drag_area = {area}")
                            + "fixed_errors = { drag_area = 10.0 }\ncore = 4.0\n" + MAPS + MASKS
                            + '[[fit.profiles]]\nfile = "line.csv"\nrole = "predict"\n[[fit.compare]]\nname = "line"\nline = 0\n')
        errors, parameters = found["systematics"]["errors"], found["parameters"]
        for name, truth in (("f_over_mu", f), ("eta", eta), ("xi", area / f)):
            self.assertLess(abs(errors[name]["value"] - truth), 4 * errors[name]["total"], name)  # by chance once in 16 000
        self.assertAlmostEqual(found["derived"]["xi"]["value"], area / parameters["f_over_mu"]["value"])
        self.assertAlmostEqual(errors["xi"]["held"] * parameters["f_over_mu"]["value"], 10.0, delta=1.0)  # f/mu hardly depends on it
        self.assertGreaterEqual(errors["xi"]["total"], errors["xi"]["held"])
        line, = found["compare"]
        self.assertEqual(line["values"]["f_over_mu"], line["line"]["parameters"]["f_over_mu"]["value"])
        self.assertEqual((found["maps"][0]["medium"], parameters["p_yy"]["unit"]), ("isotropic", "a^2"))

    def test_maps_give_back_amplitude_and_dipoles_with_errors_by_cause(self):
        self.make_runs()
        text = KEYS + "fixed_errors = { c66 = 0.05, force = 0.1 }\n" + MAPS + MASKS
        found, done = self.fit(text)
        errors = found["systematics"]["errors"]
        for name in ("amplitude", "p_xx", "p_yy"):
            one = errors[name]
            self.assertAlmostEqual(one["value"], found["parameters"][name]["value"])
            self.assertLess(abs(one["value"] - TRUE[name]), 3 * np.hypot(one["curvature"], one["masks"]))
            self.assertAlmostEqual(one["total"], np.sqrt(max(one["jackknife"], one["curvature"])**2 + one["held"]**2 + one["masks"]**2))
        # amplitude times force is what the maps fix: a force 5 % larger makes the amplitude 5 % smaller, 1/0.95 - 1/1.05 over 2
        held = {one["name"]: one["change"]["amplitude"] for one in found["systematics"]["held"]}
        self.assertAlmostEqual(held["force"] / errors["amplitude"]["value"], -(1 / 0.95 - 1 / 1.05) / 2, places=6)
        self.assertGreater(abs(held["c66"]), 0.01)
        self.assertAlmostEqual(errors["amplitude"]["held"], np.hypot(held["force"], held["c66"]))
        self.assertLess(abs(found["chi2"] - found["dof"]), 4 * np.sqrt(2 * found["dof"]))
        self.assertRegex(done.stderr, r"fit: .*amplitude = 0\.\d+ \+- \S+.* \(errors with those of held constants, masks and runs\)")

    def test_files_and_figure_show_the_data_the_model_and_the_mask(self):
        self.make_runs()
        found, _ = self.fit(KEYS + MAPS + MASKS)
        table = columns(self.folder / "out/fit_map_0.csv")
        self.assertEqual(len(table["x"]), 30 * 28)
        used = table["used"] > 0
        self.assertEqual(used.sum(), found["maps"][0]["used"])
        self.assertTrue((np.abs(table["y"][used]) >= 8 - 1e-9).all() and (np.hypot(table["x"], table["y"])[used] >= 10 - 1e-9).all())
        chi2 = sum((((table[f"U{c}"] - table[f"model_U{c}"]) / table[f"sigma_{c}"])[used]**2).sum() for c in "xy")
        self.assertAlmostEqual(chi2 / found["maps"][0]["chi2"], 1.0)
        self.assertEqual(len(found["systematics"]["masks"]), 2)
        self.assertEqual(len(found["systematics"]["runs"]), 3)

    def test_without_a_mask_the_ridge_is_noticed(self):
        self.make_run("run0.csv", 0)
        found, done = self.fit(KEYS + MAPS.replace(', "run1.csv", "run2.csv"', ""))
        self.assertGreater(found["chi2"], 10 * found["dof"])
        self.assertIsNone(found["systematics"])
        self.assertIn("poor chi2", done.stderr)

    def test_second_moments_come_back_in_size_sign_and_unit(self):
        moments = {"q_xxx": 150.0, "q_xyy": -80.0, "q_yxy": 30.0}
        for index in range(3):
            self.make_run(f"run{index}.csv", index, **moments)
        keys = KEYS.replace('"offset"]', '"q_xxx", "q_xyy", "offset"]').replace("eta_s = 0.15", "eta_s = 0.15, q_yxy = 30.0")
        found, done = self.fit(keys + MAPS + MASKS)
        for name, true in (TRUE | moments).items():
            if name in found["systematics"]["errors"]:
                one, error = found["parameters"][name]["value"], found["systematics"]["errors"][name]["curvature"]
                self.assertLess(abs(one - true), 4 * error, name)  # by chance once in 16 000
        for name in ("q_xxx", "q_xyy"):
            self.assertLess(found["systematics"]["errors"][name]["curvature"], 0.2 * abs(moments[name]), name)  # so that its sign shows
            self.assertEqual(found["parameters"][name]["unit"], "F a^2")
        self.assertLess(abs(found["chi2"] - found["dof"]), 4 * np.sqrt(2 * found["dof"]))

    def test_bins_that_share_data_count_less(self):
        self.make_run("run0.csv", 0)
        one = MAPS.replace(', "run1.csv", "run2.csv"', "") + MASKS
        alone, _ = self.fit(KEYS + one)
        shared, _ = self.fit(KEYS + "independent_spacing = 6.0\n" + one, out="shared")
        area = (BOX[0] / 30) * (BOX[1] / 28)
        ratio = shared["parameters"]["p_yy"]["stderr"] / alone["parameters"]["p_yy"]["stderr"]
        self.assertAlmostEqual(ratio, 6 / np.sqrt(area), places=5)
        self.assertAlmostEqual(shared["dof"] / alone["dof"], area / 36, places=2)


class RefusalTest(MapTest):
    def test_scenes_that_cannot_be_fitted_are_refused(self):
        self.make_runs()
        self.assert_refused(KEYS.replace("c66 = 1.0, ", "") + MAPS, "maps need c66")
        self.assert_refused(KEYS, "belongs to [[fit.maps]]", "[[fit.maps]] or [[fit.trajectories]]")
        self.assert_refused(KEYS + "fixed_errors = { p_yy = 1.0 }\n" + MAPS, "p_yy is not in fit.fixed")
        self.assert_refused(KEYS + "fixed_errors = { c66 = 0.0 }\n" + MAPS, "must be above 0")
        self.assert_refused(KEYS + MAPS + "[[fit.masks]]\nsector = [2.0, 1.0]\n", "from a lower to a higher angle")
        self.assert_refused(KEYS + MAPS + "[[fit.masks]]\nstrip = 50.0\n", "fit.masks.0 leaves no bin of run0.csv")
        self.assert_refused(KEYS.replace("rho = 0.03", "rho = 3.0") + MAPS, "faster than its waves")
        self.assert_refused(KEYS + MAPS.replace("box = [72.0, 66.0]\n", ""), "fit.maps.box")
        self.assert_refused(KEYS + MAPS.replace("speed = 1.7\n", ""), "fit.maps.speed")
        self.assert_refused(KEYS + MAPS.replace("72.0", "40.0"), "larger than the box")

    def test_a_measured_map_knows_its_own_box(self):
        x, y = places(30, BOX[0]), places(28, BOX[1])
        U = field(x, y, **TRUE)
        with h5py.File(self.folder / "measure.h5", "w") as file:
            layers = {"Ux": U[0], "Uy": U[1], "sigma_x": U[0] * 0 + SIGMA, "sigma_y": U[0] * 0 + SIGMA, "count": U[0] * 0 + 5, "x": x, "y": y}
            for name, values in layers.items():
                file["displacement/" + name] = values
                file["displacement/" + name].attrs["unit"] = "a"
            file["displacement"].attrs["mean_speed_a_per_s"] = SPEED
        of = '[[fit.maps]]\nfiles = ["measure.h5"]\n'
        found = self.fit(KEYS + of + "box = [72.5, 66.0]\n" + MASKS)[0]
        np.testing.assert_allclose(found["maps"][0]["box"], BOX, rtol=1e-13)  # bins times their width: rounding
        self.assert_refused(KEYS + of + "box = [78.0, 66.0]\n", "measured in a box of 72 x 66, not 78 x 66: leave fit.maps.box out")

    def test_tables_that_are_no_map_are_refused(self):
        one = MAPS.replace(', "run1.csv", "run2.csv"', "")
        self.write("run0.csv", "x,y,Ux,Uy\n0,0,1,1\n1,0,1,1\n0,1,1,1\n0,1,2,1\n")
        self.assert_refused(KEYS + one, "run0.csv:5", "twice")
        self.write("run0.csv", "x,y,Ux,Uy\n0,0,1,1\n1,0,1,1\n3,0,1,1\n0,1,2,1\n")
        self.assert_refused(KEYS + one, "not evenly spaced")
        self.write("run0.csv", "x,y,Ux,Uy\n" + "".join(f"{x},{y},1,1\n" for x in range(5) for y in (0.1, 0.2, 0.4, 0.5)))
        self.assert_refused(KEYS + one, "rows y are not evenly spaced: 0.4 follows 0.2", "missing?")

    def test_places_that_are_rounded_are_even(self):
        """As PIV writes them: five digits, five decimals, single precision; in any order of the rows."""
        self.make_run("run0.csv", 0)
        lines = (self.folder / "run0.csv").read_text().splitlines()
        one = KEYS + MAPS.replace(', "run1.csv", "run2.csv"', "") + MASKS
        whole, _ = self.fit(one)
        for name, form in (("digits", "{:.5g}"), ("decimals", "{:.3f}"), ("single", "{:.9g}")):
            rows = [line.split(",") for line in lines[1:]]
            for row in rows:
                row[:2] = [form.format(np.float32(row[k]) if name == "single" else float(row[k])) for k in range(2)]
            rows.sort(key=lambda row: (float(row[0]), row[3]))  # y fastest
            self.write("run0.csv", "\n".join([lines[0], *map(",".join, rows)]) + "\n")
            found, _ = self.fit(one, out=name)
            self.assertEqual(found["points"] if "points" in found else found["dof"], whole["points"] if "points" in whole else whole["dof"])
            for key, parameter in whole["parameters"].items():  # places are off by 5e-4 of a step at most
                self.assertAlmostEqual(found["parameters"][key]["value"], parameter["value"], delta=0.05 * (parameter["stderr"] or 1.0))

    def test_a_constant_that_cannot_be_moved_by_its_error_is_said(self):
        self.make_runs()
        self.write("fit.toml", KEYS + "fixed_errors = { c66 = 1.5 }\n" + MAPS + MASKS)
        done = self.expect(0, "fit", "fit.toml", "-o", "out")  # the fit itself is kept
        self.assertIn("no errors by their cause", done.stderr)
        self.assertIn("fit.fixed_errors.c66 = 1.5", done.stderr)
        self.assertFalse(json.loads((self.folder / "out/fit.json").read_text()).get("systematics"))


if __name__ == "__main__":
    rodwake.main()
