#!/usr/bin/python3
"""Beads and rods in the pictures of `rodwake camera --images`, found and linked: tracks.csv and film.toml.

    rodwake camera results/bed -o film --images 200
    examples/film/find_spots.py film
    rodwake run film/film.toml

A peer of the tracks that `rodwake camera` writes itself: it knows the pictures alone. Beads (white discs of one radius) begin as the maxima
of the smoothed picture and are then fitted, all together: Gauss and Newton on the difference between the picture and one drawn of the
discs. What is grey and not at an edge is a rod; the third moment along its axis tells its thin end. The nearest place, if it is nearer
than a radius, is the same particle in the next picture; particles are remembered for three pictures.
"""

import argparse
import re
from pathlib import Path

import matplotlib.image
import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree
from scipy.special import erf

BACKGROUND, WHITE, GREY = 0.1, 220.0, 0.5  # as the camera draws: black, white of 255, rods
MEMORY = 3                                 # pictures


def read(path):
    """[row from below][column], white is 1."""
    return matplotlib.image.imread(path)[::-1] * (255 / WHITE)


def patches(shape, places, reach):
    """Rows, columns and offsets of the pixels about each place; those outside of the picture are at its edge, and `inside` is false."""
    steps = np.arange(-reach, reach + 1)
    middle = np.floor(places).astype(int)
    column, row = middle[:, 0, None, None] + steps[None, None, :], middle[:, 1, None, None] + steps[None, :, None]
    inside = (column >= 0) & (column < shape[1]) & (row >= 0) & (row < shape[0])
    dx, dy = column + 0.5 - places[:, 0, None, None], row + 0.5 - places[:, 1, None, None]
    return np.clip(row, 0, shape[0] - 1), np.clip(column, 0, shape[1] - 1), dx, dy, inside


def fitted(picture, places, radius, blur, rounds=4):
    """Places of discs whose drawing is nearest to the picture, in pixels."""
    for _ in range(rounds):
        row, column, dx, dy, inside = patches(picture.shape, places, int(radius + 4 * blur + 1))
        off = np.hypot(dx, dy) + 1e-9
        drawn = np.full(picture.shape, BACKGROUND)
        np.maximum.at(drawn, (row, column), np.where(inside, BACKGROUND + (1 - BACKGROUND) * 0.5 * (1 - erf((off - radius) / (blur * np.sqrt(2)))), 0))
        slope = (1 - BACKGROUND) * np.exp(-0.5 * ((off - radius) / blur) ** 2) / (blur * np.sqrt(2 * np.pi)) * inside
        left = (picture - drawn)[row, column]
        by_x, by_y = slope * dx / off, slope * dy / off
        a, b, c = (np.sum(one * two, axis=(1, 2)) for one, two in ((by_x, by_x), (by_x, by_y), (by_y, by_y)))
        x, y = (np.sum(one * left, axis=(1, 2)) for one in (by_x, by_y))
        step = np.stack([c * x - b * y, a * y - b * x], axis=1) / (a * c - b * b)[:, None]
        places = places + np.clip(step, -0.3 * radius, 0.3 * radius)
    return places


def beads_in(picture, radius, blur):
    smooth = ndimage.gaussian_filter(picture, 0.5 * radius)
    top = (smooth == ndimage.maximum_filter(smooth, int(radius))) & (smooth > 0.65)
    places = np.argwhere(top)[:, ::-1] + 0.5
    height, width = picture.shape
    whole = np.all((places > radius) & (places < np.array([width, height]) - radius), axis=1)
    found = fitted(picture, places[whole], radius, blur)
    return found[np.all(np.isfinite(found), axis=1)]


def rods_in(picture, radius):
    """(x, y, heading) of what is grey and thick."""
    smooth = ndimage.median_filter(picture, 5)
    grey = ndimage.binary_opening(np.abs(smooth - GREY) < 0.2, iterations=max(2, int(0.4 * radius)))
    labels, count = ndimage.label(grey)
    found = []
    for part in range(1, count + 1):
        row, column = np.nonzero(labels == part)
        if len(row) < 3 * radius**2:
            continue
        x, y = column - column.mean(), row - row.mean()
        axis = np.linalg.eigh(np.cov(x, y))[1][:, 1]
        axis *= np.sign(np.sum((x * axis[0] + y * axis[1]) ** 3))  # more reaches far on the thin side
        found.append((column.mean() + 0.5, row.mean() + 0.5, np.arctan2(axis[1], axis[0])))
    return found


class Linker:
    """Numbers of particles from picture to picture."""

    def __init__(self, reach):
        self.reach, self.next = reach, 0
        self.places, self.numbers, self.seen = np.empty((0, 2)), np.empty(0, int), np.empty(0, int)

    def link(self, picture, places):
        numbers = np.full(len(places), -1)
        live = picture - self.seen <= MEMORY + 1
        self.places, self.numbers, self.seen = self.places[live], self.numbers[live], self.seen[live]
        if len(self.places) and len(places):
            far, old = cKDTree(self.places).query(places)
            back = cKDTree(places).query(self.places)[1]
            mutual = (far < self.reach) & (back[old] == np.arange(len(places)))
            numbers[mutual] = self.numbers[old[mutual]]
            keep = ~np.isin(self.numbers, numbers[mutual])
            self.places, self.numbers, self.seen = self.places[keep], self.numbers[keep], self.seen[keep]
        new = numbers < 0
        numbers[new] = self.next + np.arange(new.sum())
        self.next += int(new.sum())
        self.places = np.concatenate([self.places, places])
        self.numbers, self.seen = np.append(self.numbers, numbers), np.append(self.seen, np.full(len(places), picture))
        return numbers


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("folder", type=Path, help="of rodwake camera, with images and camera.toml")
    options.add_argument("--blur", type=float, default=1.0, help="of the lens, pixels [1]")
    options = options.parse_args()
    scene = (options.folder / "camera.toml").read_text(encoding="utf-8")
    value = lambda key: float(re.search(rf"^{key} = ([-+.e\d]+)", scene, re.M)[1])
    radius = value("bead_radius") / value("pixel")
    beads, rods, lines = Linker(radius), Linker(4 * radius), ["frame,particle,x,y,theta,kind"]
    for frame, path in enumerate(sorted((options.folder / "images").glob("*.png"))):
        picture = read(path)
        of_rods = rods_in(picture, radius)
        found = beads_in(picture, radius, options.blur)
        lines += [f"{frame},{n},{x:.4f},{y:.4f},,bead" for n, (x, y) in zip(beads.link(frame, found), found)]
        numbers = rods.link(frame, np.array([rod[:2] for rod in of_rods]).reshape(-1, 2))
        lines += [f"{frame},{1000000 + n},{x:.4f},{y:.4f},{theta:.5f},rod" for n, (x, y, theta) in zip(numbers, of_rods)]
    (options.folder / "found.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    scene = re.sub(r"^localisation = .*\n", "", scene.replace('"tracks.csv"', '"found.csv"'), flags=re.M)
    (options.folder / "film.toml").write_text(scene, encoding="utf-8")
    print(f"{len(lines) - 1} spots in {options.folder / 'found.csv'}; rodwake run {options.folder / 'film.toml'} measures them")


if __name__ == "__main__":
    main()
