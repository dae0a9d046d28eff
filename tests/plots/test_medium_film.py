"""Figures of a dynamic medium on made-up frames: a bump of |u| that walks with its rod through the side of the box."""

import json
import unittest
from unittest import mock

import h5py
import numpy as np

from made_up_result import SCENE, write_result
from plot_case import PlotCase
from rodwake_plots import draw, medium_film, run_dir
from rodwake_plots.medium_film import FEW, MediumFilm, periodic_part

FILM = '[[figures]]\nname = "film"\nkind = "medium_film"\nfps = 10\n'
INSTANTS = '[[figures]]\nname = "instants"\nkind = "medium_instants"\n'
BOX, POINTS, FRAMES = 12.0, 24, 5


def write_frames(folder, rods=2):
    x = (np.arange(POINTS) / POINTS - 0.5) * BOX
    t = np.arange(FRAMES) * 1.0
    place = 2.0 + 2.0 * t  # over the side at 6
    away = (x[None, None] - place[:, None, None] + BOX / 2) % BOX - BOX / 2
    with h5py.File(folder / "medium_film.h5", "w") as file:
        file["t"], file["x"], file["y"] = t, x, x
        file["ux"] = 3.0 * np.exp(-(away**2 + x[None, :, None] ** 2))
        file["uy"] = 4.0 * np.exp(-(away**2 + x[None, :, None] ** 2))
        file["rods/x"] = np.repeat(place[:, None], rods, axis=1)
        file["rods/y"] = np.zeros((FRAMES, rods)) + np.linspace(0, 3, rods)
        file["rods/theta"] = np.zeros((FRAMES, rods))


class MediumFilmTest(PlotCase):
    def build(self, figures=INSTANTS, rods=2, units="reduced"):
        (self.folder / "scene.toml").write_text(SCENE + figures)
        outcome = {"outcome": "undecided", "time": 4.0, "min_separation": 3.0, "pair": [0, 1], "solver": {"steps": 9}}
        (self.folder / "outcome.json").write_text(json.dumps(outcome))
        (self.folder / "provenance.json").write_text(json.dumps({"version": "0.1.0", "libraries": {"HDF5": "1.10"}}))
        write_result(self.folder, units=units)
        write_frames(self.folder, rods)

    def test_instants_are_drawn_of_few_rods_and_of_many_and_in_si(self):
        self.assert_drawn("instants")
        self.build(rods=FEW + 3, units="si")
        self.assert_drawn("instants")

    def test_a_film_and_its_last_picture(self):
        self.build(figures=FILM)
        with mock.patch("shutil.which", return_value=None):
            done = self.plot()
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(sorted(path.name for path in (self.folder / "figures").iterdir()), ["film.gif", "film.png"])
        self.assertIn("data:image/gif;base64,", (self.folder / "report.html").read_text())

    def test_film_on_request_is_that_of_the_medium_and_instants_come_by_default(self):
        self.build(figures="")
        with run_dir.RunDir(self.folder) as run:
            self.assertIn("medium_instants", [one.kind for one in draw.figures_of(run)])
            self.assertEqual([one.kind for one in draw.figures_of(run, film=True)][-1], "medium_film")
            (self.folder / "medium_film.h5").unlink()
            self.assertNotIn("medium_instants", [one.kind for one in draw.figures_of(run)])
            self.assertEqual([one.kind for one in draw.figures_of(run, film=True)][-1], "rods_movie")

    def test_the_colour_is_the_size_of_u_where_the_rod_is(self):
        with run_dir.RunDir(self.folder) as run:
            figure = medium_film.draw_medium_instants(run, draw.figures_of(run)[0])
        panels = [axes for axes in figure.axes if axes.images]
        self.assertEqual(len(panels), 4)
        for axes, place in zip(panels, (2.0, 4.0, 8.0, 10.0)):  # frames 0, 1, 3, 4
            image = axes.images[0]
            values, (left, right, bottom, top) = np.asarray(image.get_array()), image.get_extent()
            row, column = np.unravel_index(values.argmax(), values.shape)
            at = left + (column + 0.5) * (right - left) / values.shape[1]
            self.assertAlmostEqual(at % BOX, place % BOX, delta=0.5 * BOX / POINTS)
            self.assertAlmostEqual(values.max(), 5.0, delta=0.01)  # 3, 4, 5

    def test_a_window_beyond_the_box_shows_it_again(self):
        with run_dir.RunDir(self.folder) as run, MediumFilm(run) as film:
            size = film.frame(0).size
            part, (left, right, bottom, top) = periodic_part(film, size, ((-6.0, 18.0), (-6.0, 6.0)))
            step = BOX / POINTS
            places = left + step * (np.arange(part.shape[1]) + 0.5)
            first = np.flatnonzero(np.abs(places + BOX / 2) < step / 4)[0]
            np.testing.assert_array_equal(part[:, first:first + POINTS], part[:, first + POINTS:first + 2 * POINTS])
            self.assertAlmostEqual(places[part.max(axis=0).argmax()] % BOX, 2.0, delta=step)

    def test_frames_that_were_not_written_are_named(self):
        (self.folder / "medium_film.h5").unlink()
        self.assert_fails("medium_film.h5", "no such file")
        write_frames(self.folder)
        with h5py.File(self.folder / "medium_film.h5", "r+") as file:
            del file["t"]
            file["t"] = np.arange(3.0)
        self.assert_fails("medium_film.h5", "/ux has shape (5, 24, 24)")


if __name__ == "__main__":
    unittest.main()
