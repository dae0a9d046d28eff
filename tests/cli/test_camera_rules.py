"""What a camera makes of frames: places, losses, noise, numbers of particles and pixels, in the module of rodwake camera itself."""

import dataclasses
import math
import os
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE, BINARY = (Path(os.environ[name]) for name in ("RODWAKE_SOURCE_DIR", "RODWAKE_BINARY_DIR"))
sys.path[:0] = [str(BINARY / "python"), str(SOURCE / "commands")]  # the package itself, not the helpers of tests of its name

import h5py  # noqa: E402
import numpy as np  # noqa: E402
from rodwake import InputError  # noqa: E402
from rodwake_commands.camera import Bed, Camera, Film, draw, read_bed, read_pictures, room_within, size_of, window_of  # noqa: E402

SIDE = 20.0


def bed(beads, rods=0, window=None):
    return Bed(np.array([SIDE, SIDE]), 1.0, beads, rods, window)


def spots(film, *frames, heading=()):
    """Of unwrapped places, (N, 2) in each frame of an exposure: particles, places in pixels, headings."""
    unwrapped = np.array(frames, dtype=float)
    image = np.floor(unwrapped / SIDE)
    return film.spots(unwrapped - image * SIDE, image, np.array(heading))


class CameraRulesTest(unittest.TestCase):
    def test_without_faults_it_has_the_bits_of_the_bed_in_pixels(self):
        film = Film(Camera(pixel=0.5), bed(3, 1))
        places = np.array([[0.1, 7.7], [33.3, 19.99], [-1e-3, 5.0], [-4.0, 26.0]])
        particles, at, heading = spots(film, places, heading=[0.7])
        self.assertEqual(particles.tolist(), [0, 1, 2, 3])
        self.assertEqual(at.tolist(), ((places - SIDE * np.floor(places / SIDE)) / 0.5).tolist())
        self.assertTrue(np.isnan(heading[:3]).all())
        self.assertEqual(heading[3], 0.7)

    def test_turned_and_distorted_it_sees_what_lies_in_its_picture(self):
        turned, k = 0.3, 0.05
        film = Film(Camera(pixel=0.1, view=0.5, turned=turned, distortion=k), bed(3, 1))
        _, at, heading = spots(film, [[13, 11], [10, 10], [1, 1], [9, 12]], heading=[1.0])  # the third lies outside
        self.assertEqual(len(at), 3)
        stretch = 1 + k * (9 + 1) / (2 * 5 * 5)  # r^2 over the square of half the diagonal
        x, y = stretch * (3 * math.cos(turned) + math.sin(turned)), stretch * (math.cos(turned) - 3 * math.sin(turned))
        np.testing.assert_allclose(at[:2], [[(5 + x) / 0.1, (5 + y) / 0.1], [50, 50]], rtol=1e-14)  # rounding of some operations
        self.assertAlmostEqual(heading[2], 1 - turned, delta=1e-14)

    def test_an_exposure_has_the_mean_place_across_the_edge_too(self):
        film = Film(Camera(pixel=1, every=3, exposure=2), bed(1))
        np.testing.assert_allclose(spots(film, [[19.5, 1]], [[21.5, 3]])[1], [[0.5, 2]], rtol=1e-14)

    def test_losses_and_noise_have_the_size_asked_for(self):
        beads = 20000
        _, at, _ = spots(Film(Camera(pixel=1, lost=0.3, noise=0.2), bed(beads)), np.tile([7, 9], (beads, 1)))
        found, off = len(at), at - [7, 9]
        self.assertLess(abs(found / beads - 0.7), 5 * math.sqrt(0.21 / beads))  # binomial
        self.assertLess(abs(np.mean(off**2) / 0.04 - 1), 5 / math.sqrt(found))  # chi squared of 2 n
        self.assertLess(np.abs(off.mean(axis=0)).max(), 5 * 0.2 / math.sqrt(found))

    def test_the_random_numbers_belong_to_seed_and_picture(self):
        camera, still = Camera(pixel=1, lost=0.5, noise=0.1), np.tile([7, 9], (50, 1))

        def film(camera, pictures):
            film = Film(camera, bed(50))
            return [spots(film, still)[1].tolist() for _ in range(pictures)]

        self.assertEqual(film(camera, 2), film(camera, 3)[:2])
        self.assertNotEqual(film(camera, 2)[0], film(camera, 2)[1])
        self.assertNotEqual(film(camera, 1), film(dataclasses.replace(camera, seed=2), 1))

    def test_a_particle_that_was_away_for_long_gets_another_number(self):
        here, away = [[10, 10], [9, 9]], [[1, 1], [9, 9]]
        for memory in range(3):
            film = Film(Camera(pixel=1, view=0.5, memory=memory), bed(2))
            for frame in (here, away, away, here):
                particles = spots(film, frame)[0].tolist()
            self.assertEqual(particles, [2 if memory < 2 else 0, 1])  # away in two pictures

    def test_what_does_not_fit_the_bed_is_refused(self):
        dish, tray = (bed(1, window=room_within(is_round, [SIDE, SIDE], 1.0)) for is_round in (True, False))
        for where, keys, message in (
            (bed(1), {"pixel": 0.0}, "pixel = 0: must be above 0"),
            (bed(1), {"every": 2, "exposure": 3}, "exposure = 3"),
            (bed(1), {"view": 0.0}, "view = 0"),
            (bed(1), {"turned": 0.1}, "beyond the box; take 0.913 or less"),  # 1/(cos 0.1 + sin 0.1)
            (bed(1), {"lost": 1.0}, "lost = 1"),
            (bed(1), {"noise": -1.0}, "noise = -1"),
            (bed(1), {"pixel": 1e-3, "images": 1}, "20000 x 20000 pixels"),
            (dish, {"view": 0.7}, "take 0.643 or less, or all of the dish"),
            (dish, {"distortion": 0.1}, "take 0.643 or less"),
            (tray, {"turned": 0.1}, "beyond the bed; take 0.831 or less"),
        ):
            with self.subTest(keys), self.assertRaisesRegex(InputError, message):
                Film(Camera(**{"pixel": 1.0, **keys}), where)

    def test_all_of_a_dish_or_a_picture_within(self):
        dish, tray = (bed(1, window=room_within(is_round, [SIDE, SIDE], 1.0)) for is_round in (True, False))
        self.assertIsNone(window_of(Camera(pixel=1), bed(1)))
        self.assertEqual(window_of(Camera(pixel=1, turned=0.4), dish), (10, 10, 9.1))
        self.assertAlmostEqual(window_of(Camera(pixel=1, distortion=-0.1), dish)[2], 9.1 * (1 - 0.1 * 9.1**2 / 200), delta=1e-13)
        self.assertEqual(window_of(Camera(pixel=1, view=0.6), dish), (0, 0, 12, 12))
        self.assertEqual(window_of(Camera(pixel=1), tray), tray.window)
        film = Film(Camera(pixel=1, noise=0.5), dish)
        least = min(spots(film, [[0.95, 10]])[1][0, 0] for _ in range(100))
        self.assertTrue(-2 < least < 0.5, least)  # no image beyond the wall; 5.9 standard deviations

    def light(self, camera, *frames):
        """Sum of value - background over the pixels that show discs (x, y, radius, value), and its centre in pixels."""
        _, _, radius, value = np.array(max(frames, key=len)).T
        discs = [np.array(frame).reshape(-1, 4)[:, :2] for frame in frames]
        value = draw(camera, bed(1), 1, discs, radius, value) / 220.0 - 0.1
        rows, columns = np.indices(value.shape) + 0.5
        return value.sum(), (value * columns).sum() / value.sum(), len(value) - (value * rows).sum() / value.sum()

    def test_a_picture_shows_discs_of_their_size_where_they_are(self):
        camera, bead = Camera(pixel=0.05, photons=1e9), (13.02, 4.51, 1.0, 1.0)
        self.assertEqual(size_of(camera, bed(1)), [400, 400])
        total, x, y = self.light(camera, [bead])

        def area(radius):  # blurred by a pixel
            return math.pi * (radius**2 + 1)

        self.assertAlmostEqual(total / (0.9 * area(20)), 1, delta=3e-4)  # grey values are whole numbers
        np.testing.assert_allclose([x, y], [13.02 / 0.05, 4.51 / 0.05], atol=0.02)
        below = (*bead[:2], 0.5, 0.5)
        self.assertAlmostEqual(self.light(camera, [below, bead])[0] / total, 1, delta=1e-3)
        self.assertAlmostEqual(self.light(camera, [below])[0] / (0.4 * area(10)), 1, delta=3e-3)
        self.assertAlmostEqual(self.light(camera, [bead], [])[0] / (0.5 * total), 1, delta=2e-3)  # there in one frame of two

    def test_photons_have_the_noise_of_their_number(self):
        photons, pixels = 50, 400 * 400
        grey = draw(Camera(pixel=0.05, photons=photons), bed(1), 1, np.full((1, 1, 2), 10.0), np.array([20.0]), [0.5]) / 220.0
        variance = 0.5 / photons  # its own error: a share sqrt(2/pixels) = 0.35 %, rounding 0.02 %
        self.assertAlmostEqual(grey.mean(), 0.5, delta=4 * math.sqrt(variance / pixels))
        self.assertAlmostEqual(grey.var() / variance, 1, delta=0.015)

    def trajectory(self, **changed):
        """A file of two beads and a rod of one sphere in three frames, whose rows change places in the second one."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        rows = np.array([[0, 1, 2], [1, 0, 2], [0, 1, 2]])
        place = np.arange(9.0).reshape(3, 3)  # of body b in frame t: 3 t + b
        point = np.stack([np.take_along_axis(place, rows, axis=1), np.ones((3, 3)), np.ones((3, 3))], axis=-1)
        tables = {"position/value": point, "position/time": [0.0, 0.1, 0.2], "image/value": np.zeros((3, 3, 3), int), "id/value": 10 - rows,
                  "species": [0, 0, 1], "radius": [1.0, 1.0, 0.5], "box/edges/value": np.tile(np.diag([SIDE, SIDE, 2.0]), (3, 1, 1))}
        rods = {"position/value": point[:, 2:], "image/value": np.zeros((3, 1, 3), int), "mass": [1.0],
                "orientation/value": np.tile([math.cos(0.2), 0, 0, math.sin(0.2)], (3, 1, 1))}
        path = Path(folder.name) / "trajectory.h5md"
        with h5py.File(path, "w") as file:
            file.create_group("parameters")
            for group, parts in (("trajectory", tables | changed), ("trajectory_rods", rods)):
                for name, values in parts.items():
                    file[f"particles/{group}/{name}"] = values
            file["particles/trajectory/box"].attrs["boundary"] = ["periodic", "periodic", "none"]
        return path

    def test_frames_are_read_in_the_order_of_the_first_one(self):
        path = self.trajectory()
        found = read_bed(path)
        self.assertEqual((found.beads, found.rods, found.window, list(found.sphere_radius)), (2, 1, None, [0.5]))
        pictures = list(read_pictures(path, found, Camera(pixel=1.0, every=1, exposure=2)))
        self.assertEqual(len(pictures), 2)  # the third has one frame of two
        for first, (position, image, heading, spheres) in enumerate(pictures):
            self.assertEqual(position[..., 0].tolist(), [[3 * t, 3 * t + 1, 3 * t + 2] for t in (first, first + 1)])
            self.assertEqual((spheres[..., 0].tolist(), image.any()), (position[..., 0].tolist(), False))
            self.assertAlmostEqual(heading[0], 0.4, delta=1e-15)

    def test_damaged_trajectories_are_refused(self):
        for changed, message in (({"species": [0, 1, 0]}, "not the first"), ({"radius": [1.0, 0.0, 0.5]}, "without a radius"),
                                 ({"position/time": [0.0, 0.2, 0.1]}, "not later")):
            with self.subTest(message), self.assertRaisesRegex(InputError, f"trajectory.h5md: damaged HDF5: .*{message}.* repeat the run"):
                read_bed(self.trajectory(**changed))
        path = self.trajectory(**{"position/value": np.full((3, 3, 3), 2 * SIDE)})
        with self.assertRaisesRegex(InputError, "frames 0 to 0: a position outside the box"):
            next(read_pictures(path, read_bed(path), Camera(pixel=1.0)))


if __name__ == "__main__":
    unittest.main()
