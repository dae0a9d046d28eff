"""Fits of displacement maps from arrays: the bits of the program, bins that are not there, what is refused."""

import unittest

import numpy as np
import rodwake
from program import new_folder
from rodwake import Map

BOX, NX, NY, SIGMA = (60.0, 50.0), 24, 20, 0.01
X, Y = BOX[0] * (np.arange(NX) / NX - 0.5), BOX[1] * (np.arange(NY) / NY - 0.5)
FIXED = {"c11": 3.0, "c22": 3.4, "c12": 1.2, "c66": 1.0}
KEYS = dict(fixed=FIXED, rod_length=8.0, source_width=2.0, independent_spacing=4.0)
FREE = ["force", "p_yy", "offset"]


def some_map(seed=1, sigma=SIGMA, **changes):
    """Any smooth field: what a fit makes of it does not matter here."""
    random = np.random.default_rng(seed)
    x, y = X, Y[:, None]
    Ux = 0.5 * np.exp(-(x**2 + y**2) / 300) + SIGMA * random.normal(size=(NY, NX))
    Uy = 0.3 * np.sin(2 * np.pi * y / BOX[1]) * np.exp(-(x**2) / 200) + SIGMA * random.normal(size=(NY, NX))
    sigmas = {} if sigma is None else dict(sigma_x=np.full((NY, NX), sigma), sigma_y=np.full((NY, NX), sigma))
    return Map(**{**dict(x=X, y=Y, Ux=Ux, Uy=Uy, box=BOX, **sigmas), **changes})


def written(one):
    rows = [(one.x[k], one.y[j], one.Ux[j, k], one.Uy[j, k], *(() if one.sigma_x is None else (one.sigma_x[j, k], one.sigma_y[j, k])))
            for j in range(NY) for k in range(NX) if np.isfinite(one.Ux[j, k])]
    head = "x,y,Ux,Uy" + ("" if one.sigma_x is None else ",sigma_x,sigma_y")
    return "\n".join([head, *(",".join(repr(float(value)) for value in row) for row in rows)]) + "\n"


class MapTest(unittest.TestCase):
    def theirs(self, maps, text):
        folder = new_folder(self)
        for index, one in enumerate(maps):
            (folder / f"m{index}.csv").write_text(written(one))
        files = ", ".join(f'"m{index}.csv"' for index in range(len(maps)))
        (folder / "fit.toml").write_text(f"schema = 1\n[fit]\nparameters = {FREE}\n".replace("'", '"')
                                         + "fixed = { c11 = 3.0, c22 = 3.4, c12 = 1.2, c66 = 1.0 }\nrod_length = 8.0\nsource_width = 2.0\n"
                                         f"independent_spacing = 4.0\n[[fit.maps]]\nfiles = [{files}]\nbox = [60.0, 50.0]\n{text}")
        return rodwake.Scene.load(folder / "fit.toml").run(folder / "run").json("fit.json")

    def assert_same(self, ours, theirs):
        for name in FREE:
            one = ours.parameters[name]
            self.assertEqual((one.value, one.standard_error), (theirs["parameters"][name]["value"], theirs["parameters"][name]["stderr"]))
        self.assertEqual((ours.chi2, ours.dof), (theirs["chi2"], theirs["dof"]))

    def test_the_bits_of_the_program(self):
        maps = [some_map(1), some_map(2)]
        ours = rodwake.fit_map(maps, FREE, masks=[{"strip": 4.0, "radius": 6.0}], **KEYS)
        self.assert_same(ours, self.theirs(maps, "[[fit.masks]]\nstrip = 4.0\nradius = 6.0\n"))
        self.assertIn("force", ours.report())

    def test_bins_without_data_or_errors(self):
        holes = some_map(3)
        holes.Ux[4:6, 7:9] = np.nan
        holes.Uy[4:6, 7:9] = np.nan
        self.assert_same(rodwake.fit_map([holes], FREE, **KEYS), self.theirs([holes], ""))
        plain = some_map(3, sigma=None)
        self.assert_same(rodwake.fit_map([plain], FREE, **KEYS), self.theirs([plain], ""))
        holes.sigma_x[0] = np.nan  # left out, both components
        fewer = rodwake.fit_map([holes], FREE, **KEYS)
        independent = (BOX[0] / NX / KEYS["independent_spacing"]) ** 2  # of each bin's two values
        self.assertEqual(fewer.dof, round(2 * (NX * NY - 4 - NX) * independent) - len(FREE))

    def test_what_is_refused(self):
        cases = [(dict(x=X**3), "evenly spaced"), (dict(y=Y[::-1]), "rising"), (dict(box=(40.0, 50.0)), "larger than the box"),
                 (dict(Ux=np.zeros((NX, NY))), "Ux has the shape"), (dict(sigma_y=None), "come together")]
        for changes, word in cases:
            with self.subTest(word), self.assertRaisesRegex(rodwake.InputError, word):
                rodwake.fit_map([some_map(**changes)], FREE, **KEYS)
        for options, word in ((dict(masks=[{"strip": 1.0}, {"strip": 2.0}]), "more masks than one"),
                              (dict(fixed_errors={"c11": 0.1}), "rodwake fit alone"),
                              (dict(fixed={**FIXED, "zeta": 0.1}), "give speed")):
            with self.subTest(word), self.assertRaisesRegex(rodwake.InputError, word):
                rodwake.fit_map([some_map()], FREE, **{**KEYS, **options})


if __name__ == "__main__":
    unittest.main()
