"""Tests of the pieces that figures and page of a scan are made of: /usr/bin/python3 tests/plots/test_scan_pieces.py"""

import base64
import contextlib
import io
import itertools
import tomllib
import unittest
import zlib
from types import SimpleNamespace

import numpy as np
from matplotlib.colors import to_rgb

import made_up_scan as made_up
from made_up_scan import GAMMA, KAPPA, METHOD, PLACE
import plot_case  # noqa: F401: puts the plots on the path
from rodwake_plots import page, scan_columns, scan_raster, scan_run, scan_scene, scan_words

EPS = np.finfo(float).eps
# How colours look without one kind of cones: Machado, Oliveira and Fernandes, IEEE Trans. Vis. Comput. Graph. 15, 1291 (2009), linear RGB.
VISION = {"full": np.eye(3),
          "no red cones": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
          "no green cones": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
          "no blue cones": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]]}


def lab(colour, vision):
    """CIE Lab under daylight."""
    rgb = np.array(to_rgb(colour))
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    to_xyz = [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
    xyz = to_xyz @ np.clip(np.array(vision) @ linear, 0, 1) / [0.95047, 1.0, 1.08883]
    f = np.where(xyz > 216 / 24389, np.cbrt(xyz), (24389 / 27 * xyz + 16) / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def closest(colours, vision):
    return min(np.linalg.norm(lab(one, vision) - lab(other, vision)) for one, other in itertools.combinations(colours, 2))


class ColoursTest(unittest.TestCase):
    def test_outcomes_are_distinguished_with_any_colour_vision(self):
        """By 29 at least, on white and on the dark page; 2.3 is what an eye just sees. "finished" has no other beside it."""
        of_pairs = [colour for outcome, colour in scan_columns.COLOURS.items() if outcome != "finished"]
        for name, vision in VISION.items():
            for together in (of_pairs, [scan_columns.COLOURS["finished"]]):
                self.assertGreater(closest([*together, "#ffffff", "#1b1e23"], vision), 29, name)

    def test_the_measure_sees_red_and_green_fall_together(self):
        red_and_green = ["#b03020", "#606010"]
        self.assertGreater(closest(red_and_green, VISION["full"]), 40)
        for name in ("no red cones", "no green cones"):
            self.assertLess(closest(red_and_green, VISION[name]), 20)

    def test_capture_is_a_family(self):
        """Of the same hue, within 25 degrees; escape and undecided are of others, or of none."""
        hue = {name: np.degrees(np.arctan2(*lab(colour, VISION["full"])[:0:-1])) for name, colour in scan_columns.COLOURS.items()}
        self.assertLess(abs(hue["contact"] - hue["pursuit"]), 25)
        self.assertGreater(abs(hue["escape"] - hue["contact"]), 90)
        self.assertLess(np.hypot(*lab(scan_columns.COLOURS["undecided"], VISION["full"])[1:]), 5)


def scan_of(places, cells, axes=(KAPPA, PLACE)):
    """As much of a scan as pictures need."""
    return SimpleNamespace(places=np.asarray(places, dtype=float), cells=tuple(map(np.asarray, cells)), folder=None,
                           axes=[scan_run.axis_of(axis) for axis in axes])


class RasterTest(unittest.TestCase):
    """One cell of 2 x 2 and, right of it, two of 1 x 1 on top of each other."""

    def setUp(self):
        self.places = [(0, 0), (2, 0), (3, 0), (2, 1), (3, 1), (0, 2), (2, 2), (3, 2)]
        self.cells = [(0, 0), (2, 0), (2, 1)], [(2, 2), (3, 1), (3, 2)], [1, -1, -1]
        self.leaves = scan_raster.Leaves(scan_of(self.places, self.cells))
        self.codes = np.array([1, 1, 2, 1, 1, 1, 1, 3], dtype=np.int8)

    def picture(self, values=None, window=((0, 3), (0, 2)), codes=None):
        values = np.full(8, np.nan) if values is None else np.asarray(values, dtype=float)
        return scan_raster.of_leaves(self.leaves, self.codes if codes is None else codes, values, window)

    def test_corners(self):
        np.testing.assert_array_equal(self.leaves.corners, [[0, 1, 5, 6], [1, 2, 3, 4], [3, 4, 6, 7]])

    def test_outcomes_by_the_nearest_corner(self):
        picture = self.picture()
        self.assertEqual(picture.extent, (0, 3, 0, 2))
        np.testing.assert_array_equal(picture.codes[:, :4], 1)
        np.testing.assert_array_equal(picture.codes[:, 4:], [[1, 2], [1, 1], [1, 1], [1, 3]])

    def test_numbers_between_the_corners(self):
        """What is linear along both axes is met, to single precision."""
        x, y = np.array(self.places).T
        picture = self.picture((2 * x + 3 * y + x * y) / 100, codes=np.zeros(8, dtype=np.int8))
        px, py = np.meshgrid((np.arange(6) + 0.5) / 2, (np.arange(4) + 0.5) / 2)
        np.testing.assert_allclose(picture.values, (2 * px + 3 * py + px * py) / 100, rtol=2e-7)

    def test_numbers_that_jump(self):
        """And those of corners with unlike outcomes: neither is joined to the other."""
        for codes, right in ((np.zeros(8), 0.9), (self.codes, 0.11)):
            picture = self.picture([0.1, 0.1, right, 0.1, 0.1, 0.1, 0.1, 0.1], codes=codes.astype(np.int8))
            np.testing.assert_allclose(picture.values[:2, 4:], [[0.1, right], [0.1, 0.1]], rtol=2e-7)
        picture = self.picture([0.1, 0.1, 0.3, 0.1, 0.1, 0.1, 0.1, 0.1], codes=np.zeros(8, dtype=np.int8))
        self.assertAlmostEqual(picture.values[0, 5], 0.1 + 0.2 * 0.75 ** 2, delta=1e-7)

    def test_a_number_that_is_missing(self):
        """Its cells have the numbers of the nearest corners."""
        picture = self.picture(np.array([0, 1, np.nan, 3, 4, 5, 6, 7]) / 32)
        np.testing.assert_array_equal(32 * picture.values[:2, 4:], [[1, np.nan], [3, 4]])
        self.assertTrue(np.isfinite(picture.values[2:, 4:]).all())

    def test_a_corner_without_a_point(self):
        self.leaves = scan_raster.Leaves(scan_of(self.places[1:], self.cells))
        self.assertEqual(self.leaves.corners[0, 0], -1)
        picture = scan_raster.of_leaves(self.leaves, self.codes[1:], np.full(7, np.nan), ((0, 3), (0, 2)))
        np.testing.assert_array_equal(picture.codes[:, :4], 1)  # the outcome that the cell itself has

    def test_points_off_the_lattice_are_no_corners(self):
        """Points that were evaluated to check the picture."""
        leaves = scan_raster.Leaves(scan_of([(1.99, 0.01), *self.places, (2.4, 1.9)], self.cells))
        np.testing.assert_array_equal(leaves.corners, self.leaves.corners + 1)

    def test_window(self):
        picture = self.picture(window=((2.2, 2.9), (0.1, 0.8)))
        self.assertEqual(picture.extent, (2, 3, 0, 1))
        np.testing.assert_array_equal(picture.codes, [[1, 2], [1, 1]])

    def test_more_cells_than_pixels(self):
        whole, scan_raster.LARGEST = scan_raster.LARGEST, 3
        self.addCleanup(setattr, scan_raster, "LARGEST", whole)
        picture = self.picture(np.array(self.places)[:, 0] / 8, codes=np.zeros(8, dtype=np.int8))
        self.assertEqual(picture.codes.shape, (3, 3))
        np.testing.assert_allclose(8 * picture.values, [[0.5, 1.5, 2.5]] * 3, rtol=2e-7)

    def test_slices_of_a_cube(self):
        places = list(itertools.product((0, 1), repeat=3))
        scan = scan_of(places, ([(0, 0, 0)], [(1, 1, 1)], [-1]), (KAPPA, PLACE, GAMMA))
        leaves, codes = scan_raster.Leaves(scan), np.array([one[2] for one in places], dtype=np.int8)
        for at in (0.0, 0.3, 0.8, 1.0):
            picture = scan_raster.of_leaves(leaves, codes, np.array([0.3 * one[2] for one in places]), ((0, 1), (0, 1)), at)
            np.testing.assert_array_equal(picture.codes, round(at))
            np.testing.assert_allclose(picture.values, 0.3 * at, rtol=2e-7, atol=1e-7)
            jumps = scan_raster.of_leaves(leaves, codes, np.array([0.9 * one[2] for one in places]), ((0, 1), (0, 1)), at)
            np.testing.assert_allclose(jumps.values, 0.9 * round(at), rtol=2e-7)

    def test_the_whole_tree(self):
        """Pixels farther than a finest cell from an edge have the outcome of the formula; the stripe is wider than the coarsest cells."""
        axes = [KAPPA, PLACE]
        points, low, high, outcome = made_up.refined(axes, 64, 256)
        u = [np.stack([np.log10(one[:, 0]), one[:, 1]], axis=-1) for one in (points, low, high)]
        leaves = scan_raster.Leaves(scan_of(u[0], (u[1], u[2], outcome)))
        codes = made_up.codes_of(axes, points).astype(np.int8)
        picture = scan_raster.of_leaves(leaves, codes, np.full(len(points), np.nan), ((-1, 2), (-6, 6)))
        x, y = np.meshgrid(-1 + 3 * (np.arange(512) + 0.5) / 512, -6 + 12 * (np.arange(512) + 0.5) / 512)
        near = np.min([np.abs(y - edge) for _, edge in made_up.edges(x)], axis=0)
        slope = 2.5 * 3 / 256  # the edges rise by less than 2.5 * 12/3 a decade ... in x_1 a cell across
        far = near > 12 / 256 + 2 * slope
        self.assertGreater(far.mean(), 0.8)
        np.testing.assert_array_equal(picture.codes[far], made_up.outcome_at(10 ** x, y)[far])

    def test_grid(self):
        places = np.array([(0, 5), (1, 5), (3, 5), (0, 6), (1, 6)], dtype=float)
        made = scan_raster.of_grid(places, np.array([0, 1, 2, 3, 0], dtype=np.int8), np.arange(5.0))
        np.testing.assert_array_equal(made.x, [-0.5, 0.5, 2, 4])
        np.testing.assert_array_equal(made.y, [4.5, 5.5, 6.5])
        np.testing.assert_array_equal(made.codes, [[0, 1, 2], [3, 0, -1]])
        np.testing.assert_array_equal(made.values, [[0, 1, 2], [3, 4, np.nan]])

    def test_places_that_differ_by_rounding_are_one(self):
        found, number = scan_raster.steps(np.array([0.1, 0.3, 0.1 + 4 * EPS, 0.2]))
        self.assertEqual((len(found), list(number)), (3, [0, 2, 0, 1]))


class AxisTest(unittest.TestCase):
    def axis(self, **changes):
        return scan_run.axis_of(KAPPA | changes)

    def test_labels(self):
        for changes, label, equals in (({}, r"$\kappa\,f/(\mu v_0)$", r"$\kappa = 3\ v_0$"),
                                    (dict(unit="", symbol="\\eta"), r"$\eta$", r"$\eta = 3$"),
                                    (dict(unit="f/mu", symbol="", key="rods.1.position.1"), r"$y_{1}\,\mu/f$", None),
                                    (dict(unit="rad", symbol="", key="granular.rods.0.heading"), r"$\theta_{0}$ ($\mathrm{rad}$)", None),
                                    (dict(unit="", symbol="", key="coupling.gamma2"), r"$\gamma_2$", None),
                                    (dict(unit="", symbol="", key="granular.max_overlap"), r"$\mathrm{max\ overlap}$", None)):
            axis = self.axis(**changes)
            self.assertEqual(axis.label, label)
            if equals and changes:
                self.assertEqual(axis.equals(3.0), equals)
        self.assertEqual(self.axis(unit="", symbol="", key="granular.max_overlap").name_html, "max overlap")

    def test_a_label_that_is_no_tex_stands_as_it_is(self):
        with contextlib.redirect_stderr(io.StringIO()):
            axis = self.axis(label="a < $\\frac{", unit="v0")
        self.assertEqual((axis.label, axis.equals(3.0)), (r"a < \$\frac{ ($v_0$)", r"a < \$\frac{ $= 3\ v_0$"))
        self.assertEqual((axis.name_html, axis.equals_text(3.0)), (r"a &lt; $\frac{", r"a < $\frac{ = 3"))

    def test_lengths_of_si_have_a_handy_prefix(self):
        axis = self.axis(spacing="linear", unit="m", symbol="d", **{"from": -2e-3, "to": 5e-3})
        self.assertEqual((axis.label, axis.factor, axis.unit_html), (r"$d$ ($\mathrm{mm}$)", 1e3, "mm"))
        self.assertEqual(axis.equals(0.002), r"$d = 2\ \mathrm{mm}$")

    def test_scales(self):
        for changes, scale in ((dict(spacing="listed", values=[1.0, 2.0, 3.0]), "linear"),
                            (dict(spacing="listed", values=[0.1, 1.0, 10.0]), "log"),
                            (dict(spacing="listed", values=[-0.1, 1.0, 10.0]), "linear"), ({}, "log"), (dict(spacing="linear"), "linear")):
            self.assertEqual(self.axis(**changes).scale, scale)
        choice = scan_run.axis_of(METHOD)
        self.assertEqual((choice.scale, choice.equals(1), choice.low, choice.high), ("choice", "method: adams", -0.5, 2.5))

    def test_negative_and_logarithmic(self):
        axis = self.axis(**{"from": -0.1, "to": -100.0})
        self.assertEqual((axis.scale, axis.low, axis.high), ("log", -100, -0.1))
        np.testing.assert_allclose(axis.even([-100.0, -1.0, -0.1]), [-2, 0, 1], atol=4 * EPS)
        np.testing.assert_allclose(axis.back([-2.0, 0.0, 1.0]), [-100, -1, -0.1], rtol=4 * EPS)

    def test_there_and_back(self):
        values = np.array([0.1, 1.0, 37.5])
        np.testing.assert_allclose(self.axis().back(self.axis().even(values)), values, rtol=4 * EPS)


class SlicesTest(unittest.TestCase):
    def test_a_fourth_axis_stays_in_its_middle(self):
        axes = [KAPPA, PLACE, GAMMA, GAMMA | {"key": "coupling.gamma2", "keys": ["coupling.gamma2"]}]
        places = made_up.grid(axes, 5)
        scan = scan_of(np.column_stack([np.log10(places[:, 0]), places[:, 1:]]), ([], [], []), axes)
        scan.design, scan.failed = "grid", np.zeros(len(places), dtype=bool)
        parts = scan_words.slices(scan)
        self.assertEqual([part.at for part in parts], [0, 2.5, 7.5, 10])
        for part in parts:
            self.assertEqual((part.rows.sum(), set(places[part.rows, 3])), (25, {5.0}))
        self.assertEqual([(axis.key, value) for axis, value in scan_words.held(scan)], [("coupling.gamma2", 5.0)])


class SceneTest(unittest.TestCase):
    TEXT = made_up.SCENE + made_up.scan_table("grid", [KAPPA, PLACE]) + '[[figures]]\nname = "p"\nkind = "phase_diagram"\ncells = true\n' \
        + '\n[[figures]]\nname = "t"\nkind = "trajectories"\n'

    def axes(self, *keys, **changes):
        return [scan_run.axis_of(KAPPA | {"key": key, "keys": [key]} | changes) for key in keys]

    def made(self, axes, values, text=None):
        text = scan_scene.filled(scan_scene.checked(text or self.TEXT, axes, values), values)
        return tomllib.loads(text), text

    def test_everything_else_stays(self):
        wanted = tomllib.loads(self.TEXT)
        del wanted["scan"], wanted["figures"][0]
        wanted["coupling"]["kappa"], wanted["rods"][1]["position"][0] = 3.25, -1e-7
        scene, text = self.made(self.axes("coupling.kappa", "rods.1.position.0", spacing="linear"), [3.25, -1e-7])
        self.assertEqual(scene, wanted)
        self.assertIn("# periodic: infinite plane", text)
        self.assertNotIn("phase_diagram", text)

    def test_ties(self):
        keys = ["rods.0.position.1", "rods.1.position.1", "rods.1.position.0"]
        axis = scan_run.axis_of(PLACE | {"keys": keys, "factors": [1.0, -1.0, 0.5]})
        scene, _ = self.made([axis], [3.0])
        self.assertEqual([rod["position"] for rod in scene["rods"]], [[0.0, 3.0], [1.5, -3.0]])

    def test_what_the_scene_lacks(self):
        """A key that stands as a comment, one that does not stand at all, a table."""
        scene, text = self.made(self.axes("rods_run.atol", "rods_run.output_times_at", "noise.rotational_diffusion"), [1e-11, 2.0, 0.01])
        self.assertEqual((scene["rods_run"]["atol"], scene["rods_run"]["output_times_at"]), (1e-11, 2.0))
        self.assertEqual(scene["noise"], {"rotational_diffusion": 0.01})
        self.assertNotIn("# atol", text)

    def test_alternatives(self):
        scene, _ = self.made(self.axes("medium.alpha", "medium.poisson_ratio"), [2.5, 0.3])
        self.assertEqual(scene["medium"], {"alpha": 2.5, "poisson_ratio": 0.3, "field": "exact"})
        scene, _ = self.made(self.axes("medium.lame_lambda", "medium.mu"), [1.5, 2.0])
        self.assertEqual(scene["medium"], {"lame_lambda": 1.5, "mu": 2.0, "xi": 1.0, "field": "exact"})

    def test_flags(self):
        axis = scan_run.axis_of(METHOD | {"key": "granular.count_rod_area", "keys": ["granular.count_rod_area"],
                                             "values": ["false", "true"]})
        for word, value in (("true", True), ("false", False)):
            self.assertIs(self.made([axis], [word], made_up.BED)[0]["granular"]["count_rod_area"], value)

    def test_kinds_of_values(self):
        axes = [*self.axes("rods_run.max_steps"), scan_run.axis_of(METHOD)]
        scene, text = self.made(axes, [5000.0, "erk"])
        self.assertEqual((scene["rods_run"]["max_steps"], scene["rods_run"]["method"]), (5000, "erk"))
        self.assertIn("max_steps = 5000\n", text)

    def test_strings_with_units_and_signs(self):
        text = self.TEXT.replace("position = [0.0, -5.0]", 'position = ["1, [2] f/mu", "-5 f/mu"]')
        text = text.replace('"Capture', '"[scan] # [x] Capture')
        scene, made = self.made(self.axes("rods.1.position.1"), [2.5], text)
        self.assertEqual(scene["rods"][1]["position"], ["1, [2] f/mu", 2.5])
        self.assertIn("[scan] # [x] Capture", scene["title"])

    def test_beds(self):
        axes = [scan_run.axis_of(axis) for axis in (made_up.PHI, made_up.APART)]
        scene, _ = self.made(axes, [0.75, 0.0036], made_up.BED + made_up.scan_table("grid", [made_up.PHI, made_up.APART]))
        self.assertEqual((scene["granular"]["phi_b"], [rod["position"][1] for rod in scene["granular"]["rods"]]), (0.75, [0.0036, -0.0036]))

    def test_what_cannot_be_written(self):
        for key, words in (("rods.7.heading", "no such table"), ("rods.1.position.5", "shorter"), ("medium.lame_lambda", "by itself"),
                           ("medium.mu", "by itself"), ("rods_run.output_times.0", "does not give"),
                           ("field.x.0.1", "such table|list of lists|does not give")):
            with self.subTest(key), self.assertRaisesRegex(scan_scene.NoTemplate, words):
                self.made(self.axes(key), [1.0])

    def test_the_check_sees_a_value_in_a_wrong_place(self):
        whole = scan_scene.template
        self.addCleanup(setattr, scan_scene, "template", whole)
        scan_scene.template = lambda text, axes: [scan_scene.Slot(0, 1.0, "float") if part == 1 else part for part in
                                                  ("[coupling]\ngamma1 = ", 1, "\nkappa = 1.0\n")]
        with self.assertRaisesRegex(scan_scene.NoTemplate, "coupling.kappa = 1.0 where 3.0 was set"):
            scan_scene.checked(self.TEXT, self.axes("coupling.kappa"), [3.0])


class PackedTest(unittest.TestCase):
    def test_there_and_back(self):
        """As data.js does it; the page itself is read in a browser by test_scan_page.py."""
        for values in (np.array([0.1, -np.inf, np.nan, 1e300]), np.arange(-3, 300, dtype=np.int32), np.array([1.5], dtype=np.float32),
                       np.array([0, 255], dtype=np.uint8), np.empty(0)):
            box = page.Box()
            entry = box.add(values)
            raw = zlib.decompress(base64.b64decode(box.scripts[entry["array"]].split(">")[1].split("<")[0]))
            found = np.frombuffer(raw, dtype=np.uint8).reshape(values.itemsize, values.size).T.tobytes()
            np.testing.assert_array_equal(np.frombuffer(found, dtype=f"<{entry['type']}"), values)
            self.assertEqual(entry["count"], values.size)


if __name__ == "__main__":
    unittest.main()
