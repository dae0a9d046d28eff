"""Tests of the figures of measured runs, on made-up results: /usr/bin/python3 tests/plots/test_measure.py"""

import json
import re
import shutil
import unittest

import h5py
import numpy as np

from made_up_granular import A, SCENE
from made_up_measured import results, variants, write_measured, write_series
from plot_case import PlotCase
from rodwake_plots import bed_run, bed_sections, displacement, draw, flow, rod_tracks, run_dir, schema, series, style, words

GRANULAR = ("snapshot", "rod_tracks", "side_view", "granular_table")
ORDER = ("pair_correlation", "bond_order", "msd", "phonons")
SEEN_FROM_A_ROD = ("flow", "dragged", "displacement_map", "heading_diffusion", *("profile_" + name for name in "Ux_x Ux_y Uy_x Uy_y Ux_x_scaled".split()))
QUANTITIES = "psi6 exponent stiffness delta_y non_reciprocity c_T C11 C22 C66 drag_rate screening_length D_r diffusion_per_length"
SERIES = tuple("series_" + name for name in QUANTITIES.split())
EPS = np.finfo(float).eps


def figure(kind, name="fig", **keys):
    return f'[[figures]]\nname = "{name}"\nkind = "{kind}"\n' + "".join(f"{key} = {json.dumps(value)}\n" for key, value in keys.items())


class MeasureCase(PlotCase):
    KEYS = {}

    def build(self, **keys):
        shutil.rmtree(self.folder)
        self.folder.mkdir()
        write_measured(self.folder, **(self.KEYS | keys))

    def ask(self, *figures):
        """Another scene over the same files."""
        names = variants([path.name for path in sorted(self.folder.glob("variants/*"))])
        (self.folder / "scene.toml").write_text(SCENE + names + "".join(figures))
        shutil.rmtree(self.folder / "figures", ignore_errors=True)

    def spoil(self, name, content):
        (self.folder / name).write_text(content)

    def draw(self, kind, **keys):
        """The matplotlib figure and the caption."""
        self.ask(figure(kind, **keys))
        with run_dir.RunDir(self.folder) as run, style.applied(style.SETTINGS):
            spec = draw.figures_of(run)[0]
            return draw.KINDS[kind].draw(run, spec), draw.caption(run, spec)

    def read_page(self):
        self.assertEqual(self.plot().returncode, 0)
        return (self.folder / "report.html").read_text()


class OneRunTest(MeasureCase):
    def test_every_kind_by_default(self):
        self.assert_drawn(*GRANULAR, *ORDER, *SEEN_FROM_A_ROD, "pair_tracks")

    def test_report(self):
        self.ask(figure("msd"))
        page = re.sub("<[^>]*>", "", self.read_page())
        for part in ("Measures", "0.9000 ± 0.0040", "(3.20 ± 0.10) µN/m", "crystal", "14.2 for 17", "12 runs", "(−3.10 ± 0.60) a"):
            self.assertIn(part, page)
        self.assertNotIn("rows of table.csv", page)  # another psi6, with another cut-off

    def test_spacings_of_lattice_and_grid(self):
        """Of the file that the program wrote, of a bed of phi_b = 0.80 on a grid of 1 a."""
        with run_dir.RunDir(self.folder) as run:
            rows = {row[0]: re.sub("<[^>]*>", "", row[1]) for row in bed_sections.measures_table(run)[1]}
        self.assertRegex(rows["Lattice spacing"], r"^2\.[01]\d* a$")
        self.assertEqual(rows["Grid spacing"], "1 a")

    def test_what_was_not_measured_is_left_out(self):
        (self.folder / "measure.json").write_text(json.dumps({"order": results(0.8)["order"]}))
        self.ask(figure("pair_correlation"))
        page = re.sub("<[^>]*>", "", self.read_page())
        self.assertIn("Neighbours", page)
        for part in ("Stiffness", "Non-reciprocity", "Bragg contrast"):
            self.assertNotIn(part, page)

    def test_no_default_without_its_frames(self):
        (self.folder / "trajectory.h5md").unlink()
        with run_dir.RunDir(self.folder) as run:
            self.assertEqual({one.name for one in draw.figures_of(run)}, {*GRANULAR[1:], *ORDER, *SEEN_FROM_A_ROD, "pair_tracks"} - {"dragged"})

    def test_unknown_errors(self):
        found = results(0.8)
        found["order"]["psi6"]["error"] = found["microrheology"]["stiffness"]["value"] = None
        (self.folder / "measure.json").write_text(json.dumps(found))
        for name in ("gr.csv", "gB.csv", "msd.csv", "profile_Ux_x.csv"):
            lines = (self.folder / name).read_text().splitlines()
            at = lines[0].split(",").index("sigma")
            rows = [line.split(",") for line in lines[1:]]
            self.spoil(name, "\n".join([lines[0], *(",".join(row[:at] + [""] + row[at + 1:]) for row in rows)]))
        self.ask(*(figure(kind, kind) for kind in (*ORDER, "profile")))
        self.assert_drawn(*ORDER, "profile")
        page = self.read_page()
        self.assertIn("<td>0.9</td>", page)
        self.assertNotIn("Stiffness", page)

    def test_profiles(self):
        made, caption = self.draw("profile", component="Ux", along="x", sqrt_scaled=True, x=[-30 * A, 30 * A])
        points = made.axes[0].lines[1].get_xydata()
        self.assertFalse((points[:, 0] == 0).any())
        self.assertEqual((points[:, 0].min(), points[:, 0].max()), (-30, 30))
        place, value, sigma = bed_run.Part("", "", self.folder).table("profile_Ux_x.csv", "x", "value", "sigma")
        kept = (abs(place) <= 30) & (place != 0)
        np.testing.assert_allclose(points[:, 1], np.sqrt(abs(place[kept])) * value[kept], rtol=4 * EPS)
        with run_dir.RunDir(self.folder) as run:
            spec = draw.figures_of(run)[0]
            read = displacement.read_profile(run, spec, bed_run.parts_of(run)[0])
        np.testing.assert_allclose(read[2], np.sqrt(abs(place[kept])) * sigma[kept], rtol=4 * EPS)
        self.assertIn("1/2", caption)
        self.assertIn("bars: standard error", caption)
        rows = [line.split(",") for line in (self.folder / "profile_Ux_x.csv").read_text().splitlines() if not line.startswith("#")]
        self.spoil("profile_Ux_x.csv", "\n".join(",".join([*row[:2], "sigma" if row[0] == "x" else "", row[3]]) for row in rows) + "\n")
        _, unknown = self.draw("profile")  # measured in one block
        self.assertIn("the error is unknown", unknown)
        _, caption = self.draw("profile", component="Uy")
        self.assertIn("4 <i>a</i>", caption)
        self.ask("[measure]\nprofile_offset = 0.002\n", figure("profile", component="Uy"))
        with run_dir.RunDir(self.folder) as run:
            self.assertAlmostEqual(displacement.line_of(run, draw.figures_of(run)[0]), 5, delta=20 * EPS)

    def test_stiffness(self):
        """Points of the file, a star at s = 0 and a line to the end of the window."""
        drawn, caption = self.draw("stiffness")
        part = bed_run.Part("", "", self.folder)
        s, value = part.table("stiffness.csv", "s", "value")
        found = part.estimate("microrheology", "stiffness")
        lines = drawn.axes[0].lines
        points, star = (next(line for line in lines if line.get_marker() == mark) for mark in "o*")
        window = next(line for line in lines if line.get_linestyle() == "--")
        np.testing.assert_array_equal(points.get_xydata(), np.column_stack([s, value]))
        np.testing.assert_array_equal(star.get_xydata(), [[0.0, found.value]])
        self.assertEqual(list(window.get_xdata()), [0.0, part.number("microrheology", "s_high")])
        self.assertIn(words.with_error(found.value, found.error), caption)
        self.spoil("stiffness.csv", "s,value,sigma\n0,1,1\n")
        self.assert_fails('figure "fig"', "stiffness.csv", "no value at any s > 0")

    def test_phonons(self):
        drawn, caption = self.draw("phonons")
        part = bed_run.Part("", "", self.folder)
        points = np.concatenate([line.get_xydata() for line in drawn.axes[0].lines if line.get_marker() in ("o", "s")])
        np.testing.assert_array_equal(np.sort(points, axis=0), np.sort(np.column_stack(part.table("phonons.csv", "q", "omega")), axis=0))
        slopes = {round(line.get_ydata()[1] / line.get_xdata()[1], 6) for line in drawn.axes[0].lines if line.get_marker() == "None"}
        self.assertEqual(slopes, {round(part.estimate("phonons", f"c_{name}").value, 6) for name in ("Lx", "Ly", "Ld", "Tx", "Ty", "Td")})
        drag = part.estimate("phonons", "drag_rate").value
        self.assertEqual({line.get_ydata()[0] for line in drawn.axes[1].lines if line.get_marker() == "None"}, {drag})
        self.assertIn("drag rate = 11.00 ± 0.60 1/s", caption)

    def test_bins_without_beads_are_blank(self):
        self.ask(figure("displacement_map"))
        with run_dir.RunDir(self.folder) as run:
            spec, part = draw.figures_of(run)[0], bed_run.parts_of(run)[0]
            self.assertEqual(spec.component, "U")
            x, y, U = displacement.read(part, run, spec)
            _, _, count = part.grid("displacement", "count")
        np.testing.assert_array_equal(np.isnan(U), count == 0)
        self.assertTrue((count == 0).any())

    def test_the_component_asked_for_is_drawn(self):
        part = bed_run.Part("", "", self.folder)
        _, _, Ux, Uy, count = part.grid("displacement", "Ux", "Uy", "count")
        for keys, values, label in (({}, np.hypot(Ux, Uy), "$|U|/a$"), ({"component": "U"}, np.hypot(Ux, Uy), "$|U|/a$"),
                                    ({"component": "Ux"}, Ux, "$U_x/a$"), ({"component": "Uy"}, Uy, "$U_y/a$")):
            drawn, _ = self.draw("displacement_map", **keys)
            mesh = drawn.axes[0].collections[0].get_array()
            np.testing.assert_allclose(mesh.reshape(values.shape).filled(np.nan), np.where(count > 0, values, np.nan), rtol=4 * EPS)
            self.assertEqual(drawn.axes[-1].get_ylabel(), label)

    def test_maps_of_components_and_windows(self):
        keys = dict(x=[-20 * A, 20 * A], y=[-10 * A, 12 * A])
        self.ask(figure("displacement_map", "x", component="Ux", **keys), figure("displacement_map", "y", component="Uy"),
                 figure("flow", "flow", **keys), figure("dragged", "dragged", x=[0, 0.01], y=[0, 0.005]))
        self.assert_drawn("x", "y", "flow", "dragged")

    def test_marked_beads_are_those_of_the_frame(self):
        self.ask(figure("dragged"))
        with run_dir.RunDir(self.folder) as run:
            view = flow.read_marked(bed_run.parts_of(run)[0])
        box = view.frame.box / A
        off = view.last - view.frame.beads[view.marked, :2] / A
        np.testing.assert_allclose(off, box * np.round(off / box), atol=1e-9)  # places of 1e2 a, written with 12 digits
        self.assertLess(np.hypot(*(view.last - view.first).T).max(), 2)  # the made-up beads only rattle

    def test_tracks_side_by_side_and_crosswise(self):
        _, caption = self.draw("pair_tracks")
        self.assertIn("across the start heading", caption)
        self.assertIn("12 contact", caption)
        self.assertIn("3 undecided", caption)
        lines = (self.folder / "tracks.csv").read_text().splitlines()
        at = lines[0].split(",").index("theta1")
        rows = [line.split(",") for line in lines[1:]]
        self.spoil("tracks.csv", "\n".join([lines[0], *(",".join(row[:at] + ["1.6"] + row[at + 1:]) for row in rows)]))
        _, caption = self.draw("pair_tracks")
        self.assertIn("Paths of the two rods", caption)
        self.assert_drawn("fig")

    def test_a_pair_is_one_pair_of_images(self):
        with run_dir.RunDir(self.folder) as run:
            track = run.granular.tracks()[0]
            box = run.granular.box
        away = track.__class__(track.path, track.t, track.x + [0, 3 * box[0]], track.y - [0, box[1]], track.theta, track.speed)
        whole, alone = rod_tracks.together(away, box), rod_tracks.together(track, box)
        np.testing.assert_allclose(whole.x, alone.x, atol=1e-12)  # m; boxes of 1e-2 m added and taken off
        np.testing.assert_allclose(whole.y, alone.y, atol=1e-12)


class SeveralRunsTest(MeasureCase):
    KEYS = dict(phis=(0.70, 0.735, 0.8), runs=3, labels=["hexatic one", r"$\phi_b = 0.8$"])

    def test_every_kind_by_default(self):
        with run_dir.RunDir(self.folder) as run:
            self.assertEqual({one.name for one in draw.figures_of(run)}, {*GRANULAR, *ORDER, *SEEN_FROM_A_ROD, "pair_tracks", *SERIES})
        kinds = (*GRANULAR, *ORDER, "flow", "dragged", "displacement_map", "heading_diffusion", "profile", "series")
        with (self.folder / "scene.toml").open("a") as scene:
            scene.writelines(figure(kind, kind) for kind in kinds)
        self.assert_drawn(*kinds)
        page = re.sub("<[^>]*>", "", (self.folder / "report.html").read_text())
        for part in ("φb = 0.7:", "φb = 0.8", "hexatic one: hexatic", "(a)", "(c)"):
            self.assertIn(part, page)

    def test_curves_and_labels(self):
        scene = (self.folder / "scene.toml").read_text()
        (self.folder / "scene.toml").write_text(scene + figure("bond_order"))
        with run_dir.RunDir(self.folder) as run:
            made = draw.KINDS["bond_order"].draw(run, draw.figures_of(run)[0])
        labels = [text.get_text() for text in made.axes[0].get_legend().get_texts()]
        self.assertEqual(labels, [r"$\phi_b = 0.7$: exponential", r"hexatic one: algebraic, $\eta_6 = 0.2$", r"$\phi_b = 0.8$: long-range",
                                  r"$r^{-1/4}$"])

    def test_a_variant_that_lacks_a_file_is_reported(self):
        (self.folder / "variants/v1/gr.csv").unlink()
        made, caption = self.draw("pair_correlation")
        self.assertIn("Not measured: v1.", caption)
        self.assertEqual(len(made.axes[0].get_legend().get_texts()), 2)

    def test_many_variants(self):
        shutil.copytree(self.folder / "variants/v1", self.folder / "variants/v3")
        shutil.copytree(self.folder / "variants/v1", self.folder / "variants/v4")
        self.ask(*(figure(kind, kind) for kind in (*ORDER, "profile", "flow", "pair_tracks")))
        self.assert_drawn(*ORDER, "profile", "flow", "pair_tracks")

    def test_variants_that_are_not_finished(self):
        shutil.rmtree(self.folder / "variants/v1")
        (self.folder / "variants/v2/summary.json").unlink()
        self.ask(figure("dragged"))
        self.assert_fails("variants/v2/summary.json", "no such file", "not finished")


class SeriesTest(MeasureCase):
    KEYS = dict(rods=0)
    SPEEDS = [1.0, 2.0, 4.0, 8.0]

    def test_every_quantity_and_axis(self):
        write_series(self.folder / "series.csv", [0.7, 0.74, 0.78], speeds=[1, 2, 4], distances=[15, 18, 24])
        quantities = schema.FIGURES["series"]["quantities"]
        self.ask(*(figure("series", quantity, quantity=quantity, against="d0") for quantity in quantities))
        self.assert_drawn(*quantities)
        for against in ("phi_b", "imposed_speed"):
            for quantity in quantities:
                made, _ = self.draw("series", quantity=quantity, against=against)
                self.assertTrue(made.axes[0].lines, (quantity, against))

    def test_force_and_its_two_fits(self):
        write_series(self.folder / "series.csv", [0.8] * 4, speeds=self.SPEEDS)
        _, caption = self.draw("series", quantity="force", against="imposed_speed")
        with run_dir.RunDir(self.folder) as run:
            (group,) = series.read(run, draw.figures_of(run)[0])
            np.testing.assert_array_equal(group.x, np.array(self.SPEEDS) * (1e3 * run.granular.a))  # mm/s; the file has a/s
        self.assertIn("µN s/mm", caption)
        slope, at_rest = np.polyfit(group.x, group.y, 1)  # equal errors
        line, through = series.fits(group)
        np.testing.assert_allclose(line.values, [at_rest, slope], rtol=1e-12)  # two ways to solve well-conditioned normal equations
        self.assertGreater(through.chi2, 50 * line.chi2)
        self.assertIn(words.with_error(at_rest, line.errors[0], 1e6), caption)
        self.assertIn("for 2 degrees of freedom", caption)
        self.assertIn("for 3 degrees of freedom", caption)

    def test_no_line_through_points_of_unknown_error(self):
        write_series(self.folder / "series.csv", [0.8] * 4, speeds=self.SPEEDS)
        self.spoil("series.csv", (self.folder / "series.csv").read_text().replace(",4e-08,", ",,"))
        _, caption = self.draw("series", quantity="force", against="imposed_speed")
        self.assertIn("No line is fitted", caption)
        self.assertIn("4 points have no known error", caption)
        self.assert_drawn("fig")

    def test_groups(self):
        """A curve for each d0, in the order of the file, each in the order of the x axis."""
        write_series(self.folder / "series.csv", [0.78, 0.7, 0.74] * 2, distances=[24] * 3 + [18] * 3)
        made, _ = self.draw("series", quantity="delta_y")
        labels = [text.get_text() for text in made.axes[0].get_legend().get_texts()]
        self.assertEqual(labels, [r"$d_0 = 24\,a$", r"$d_0 = 18\,a$"])
        with run_dir.RunDir(self.folder) as run:
            for group in series.read(run, draw.figures_of(run)[0]):
                self.assertEqual(list(group.x), [0.7, 0.74, 0.78])

    def test_bad_files(self):
        self.ask(figure("series"))
        self.assert_fails("series.csv", "no such file")
        for text, expected in (("", ("column phi_b",)), ("# nothing\nname,phi_b,psi6\n", ("no row", "psi6")),
                           ("name,phi_b,psi6\na,0.7,\n", ("no row",)),
                           ("name,phi_b,psi6\na,0.7,x\n", ("numbers",)), ("name,phi_b,psi6\na,0.7\n", ("3 names", "2 values")),
                           ("name,phi_b\na,0.7\n", ("column psi6",))):
            self.spoil("series.csv", text)
            self.assert_fails('figure "fig"', "series.csv", *expected)

    def test_wrong_keys(self):
        for key, value in (("quantity", "mass"), ("against", "time")):
            self.ask(figure("series", **{key: value}))
            self.assert_fails(key, value)
        self.ask(figure("profile", along="z"))
        self.assert_fails("along", "z")
        self.ask(figure("profile", component="U"))
        self.assert_fails("component", "U")


class BadFilesTest(MeasureCase):
    CSV = {"pair_correlation": ("gr.csv", "r,g,sigma"), "bond_order": ("gB.csv", "r,gB,sigma,pairs"), 
           "msd": ("msd.csv", "lag,msd,sigma,origins"), "profile": ("profile_Ux_x.csv", "x,value,sigma,count"),
           "dragged": ("marked.csv", "bead,x0,y0,x1,y1")}

    def test_tables(self):
        for kind, (name, heads) in self.CSV.items():
            self.ask(figure(kind))
            first, rest = heads.split(",", 1)
            for text, expected in ((heads + "\n", "no rows"), (rest + "\n" + "1," * rest.count(",") + "1\n", f"column {first} is missing"),
                               (heads + "\n" + "x," * heads.count(",") + "1\n", "not a table of numbers"),
                               (heads + "\n1\n", "names in its first")):
                self.spoil(name, text)
                self.assert_fails('figure "fig"', name, expected)
            (self.folder / name).unlink()
            self.assert_fails('figure "fig"', name, "no such file", "[measure]")

    def test_nothing_that_can_be_drawn(self):
        for kind, row in (("bond_order", "5,-0.1,0.1,3"), ("msd", "0.1,0,0,5"), ("profile", "3,0.1,0.1,0")):
            name, heads = self.CSV[kind]
            self.spoil(name, f"{heads}\n{row}\n")
            self.ask(figure(kind))
            self.assert_fails(name, "nothing to draw")
        for kind, axis in (("pair_correlation", "x"), ("profile", "x"), ("displacement_map", "x"), ("flow", "y")):
            self.build()
            self.ask(figure(kind, **{axis: [1.0, 2.0]}))
            self.assert_fails('figure "fig"', "nothing to draw")

    def test_results(self):
        self.ask(figure("bond_order"))
        for text, expected in (("{", "JSON"), ("[]", "not a JSON object"), ('{"order": 1}', "order.class is not as rodwake writes it"),
                           ('{"order": {"class": "algebraic", "exponent": 0.2}}', "order.exponent"),
                           ('{"order": {"class": "algebraic", "exponent": {"value": "x"}}}', "order.exponent")):
            self.spoil("measure.json", text)
            self.assert_fails("measure.json", expected)
        (self.folder / "measure.json").unlink()
        self.assert_fails("measure.json", "no such file")
        self.ask(figure("pair_correlation"))
        self.spoil("measure.json", '{"order": {"g_minimum": "x"}}')
        self.assert_fails("measure.json", "g_minimum", "not as rodwake writes it")

    def test_fields(self):
        def edit(change):
            self.build()
            with h5py.File(self.folder / "measure.h5", "r+") as file:
                change(file)
        for kind, group, field in (("flow", "flow", "vx"), ("displacement_map", "displacement", "Ux")):
            asked = figure(kind)
            for change, expected in ((lambda file: file.pop(f"{group}/{field}"), f"{group}/{field}"),
                                 (lambda file: file.pop(group), f"/{group} is missing"),
                                 (lambda file: file[f"{group}/count"].write_direct(0 * file[f"{group}/count"][()]), "nothing to draw")):
                edit(change)
                self.ask(asked)
                self.assert_fails("measure.h5", expected)

            def reshape(file):
                file.pop(f"{group}/{field}")
                file[f"{group}/{field}"] = np.zeros((3, 4))
            edit(reshape)
            self.ask(asked)
            self.assert_fails("measure.h5", f"{group}/{field}", "(3, 4)")
            (self.folder / "measure.h5").write_bytes(b"not hdf5")
            self.assert_fails("measure.h5", "HDF5")
            (self.folder / "measure.h5").unlink()
            self.assert_fails("measure.h5", "no such file")

    def test_marked_beads_of_another_run(self):
        self.ask(figure("dragged"))
        lines = (self.folder / "marked.csv").read_text().splitlines()
        rows = [list(map(float, line.split(","))) for line in lines[1:]]
        turned = [f"{row[0]:g},{row[1]},{row[2]},{3 * number % 11},{7 * number % 13}" for number, row in enumerate(rows)]
        self.spoil("marked.csv", "\n".join([lines[0], *turned]))
        self.assert_fails("marked.csv", "trajectory.h5md", "not of the same run")
        self.spoil("marked.csv", f"{lines[0]}\n99999,0,0,0,0\n")
        self.assert_fails("marked.csv", "99999")
        self.build()
        (self.folder / "trajectory.h5md").unlink()
        self.ask(figure("dragged"))
        self.assert_fails("trajectory.h5md", "no such file")

    def test_tracks(self):
        self.ask(figure("pair_tracks"))
        self.spoil("tracks.csv", "t,x0,y0,theta0,speed0\n0,0,0,0,0\n1,0,0,0,0\n")
        self.assert_fails("tracks.csv", "1 rod;", "two")
        (self.folder / "tracks.csv").unlink()
        self.assert_fails("tracks.csv", "no such file")


if __name__ == "__main__":
    unittest.main()
