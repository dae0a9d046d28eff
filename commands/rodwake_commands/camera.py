"""rodwake camera: simulate imaging of a bed: tracks with noise, losses and distortion, and a scene that measures them.

Measured again, tracks of a bed whose truth is known show how the faults of a camera change a measure. A point r of the bed, relative to
the middle of its box, appears at R(-turned) r (1 + distortion r^2/d^2) from the middle of the picture, where d is half of the picture's
diagonal; x points to the right, y upwards, and the corner (0, 0) lies below on the left. The faults act in this order: the mean over the
exposure, the edge of the picture, spots that are not found, the normal error of a spot's position.

Drawn pictures have no lost spots and no errors of position, which whoever finds spots in them adds. A sphere is a disc of its radius
(distortion moves it and does not stretch it) whose edge the lens blurs. A pixel of mean value v has counted a normal number of photons
whose mean and variance are `photons` v.
"""

import contextlib
import math
import re
import struct
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Optional, Sequence

import numpy as np
from rodwake import InputError, RunError, _core
from rodwake.reading import open_hdf5

from .files import number, refuse_link, refuse_present, write_atomically

UNITS = {"": 1.0, "m": 1.0, "mm": 1e-3, "um": 1e-6, "nm": 1e-9}
LENGTH = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?) *(\w*)")
PICTURES_FOR_STIFFNESS = 32
MOST_PIXELS = 1e8
BACKGROUND, WHITE = 0.1, 220.0  # the noise of photons has room above white
POSITIONS, PHOTONS = 0, 1       # streams of random numbers
ERFC_AT = np.linspace(-6.0, 6.0, 12001)
ERFC = np.array([math.erfc(x) for x in ERFC_AT])  # interpolated to 1e-7, far below a grey value


@dataclass(frozen=True)
class Camera:
    """The options of the command, in SI; the program has checked the ranges that do not depend on the bed."""

    pixel: float             # m
    every: int = 1           # frames from one picture to the next
    exposure: int = 1        # frames whose mean position a spot has, at most `every`
    view: float = 1.0        # sides of the picture over those of the box, above 0 to 1
    turned: float = 0.0      # rad, anticlockwise
    distortion: float = 0.0  # at the corners; negative: barrel
    lost: float = 0.0        # share of the spots that are not found
    memory: int = 3          # pictures without a particle after which it gets another number
    noise: float = 0.0       # standard deviation of a coordinate, m
    seed: int = 1
    images: int = 0          # pictures that are drawn, from the first on
    blur: float = 1.0        # standard deviation of the lens, pixels
    photons: float = 1000.0  # that a white pixel counts

    @property
    def sees_the_box(self):
        return (self.view, self.turned, self.distortion) == (1.0, 0.0, 0.0)

    def random(self, picture, stream):
        """Numbers of one picture and purpose: they do not depend on how many pictures there are, nor on what else is random."""
        return np.random.Generator(np.random.Philox(key=[self.seed, picture], counter=[0, 0, 0, stream]))


@dataclass(frozen=True)
class Bed:
    """What all frames of a trajectory share, in m. `window`: of a bed with a wall, where centres of beads may be: (x, y, radius) of a
    circle or (x0, y0, x1, y1) of a rectangle; None if the box is periodic."""

    box: np.ndarray
    bead_radius: float            # the unit of lengths
    beads: int
    rods: int = 0
    window: Optional[tuple] = None
    sphere_radius: Sequence = ()  # of the spheres of rods, which come after the beads
    time: Sequence = ()           # s
    bead_radii: Sequence = ()

    @property
    def is_round(self):
        return self.window is not None and len(self.window) == 3


def room_within(is_round, box, bead_radius):
    """The window of a bed with a wall: a bead is pressed into the wall by less than a tenth of its radius, at which runs stop."""
    away = 0.9 * bead_radius
    return (0.5 * box[0], 0.5 * box[1], 0.5 * box[0] - away) if is_round else (away, away, box[0] - away, box[1] - away)


# Trajectories, as rodwake dem writes them (include/rodwake/store/h5md.hpp).


@contextlib.contextmanager
def opened(path):
    """The user named the file: damage is wrong input."""
    try:
        with open_hdf5(path) as file:
            yield file
    except RunError as error:
        raise InputError(f"{error}; give a trajectory.h5md as rodwake dem writes it, or repeat the run if this should be one") from error


def read_bed(path):
    """All but the frames. The checks are for what would otherwise give wrong tracks."""
    with opened(path) as file:
        spheres, parameters = file["particles/trajectory"], file["parameters"].attrs
        edges, species, radius = (np.asarray(spheres[name]) for name in ("box/edges/value", "species", "radius"))
        box, beads, time = np.diag(edges[0])[:2], int(np.sum(species == 0)), np.asarray(spheres["position/time"])
        boundary = [flag.decode() if isinstance(flag, bytes) else flag for flag in spheres["box"].attrs["boundary"]][:2]
        for holds, damage in (((edges == edges[0]).all() and (box > 0).all(), "the box changes, or has no positive sides"),
                              ((species[:beads] == 0).all() and beads > 0, "the beads (species 0) are not the first of its particles"),
                              (radius.shape == species.shape and (radius > 0).all(), "bodies without a radius"),
                              (time.size > 0 and (np.diff(time) > 0).all(), "no frames, or frames that are not later than the one before"),
                              (boundary in (["periodic"] * 2, ["none"] * 2), f"the boundary of its box is {boundary}"),
                              (spheres["position/value"].attrs.get("unit", "m") == "m", "lengths that are not in m")):
            if not holds:
                raise ValueError(damage)
        rods = file["particles/trajectory_rods/mass"].size if "particles/trajectory_rods" in file else 0
        unit = radius[0] if (radius[:beads] == radius[0]).all() else parameters["bead_radius"]
        window = None if boundary[0] == "periodic" else room_within("wall_radius" in parameters, box, radius[:beads].min())
        return Bed(box, float(unit), beads, rods, window, radius[beads:], time, radius[:beads])


def read_pictures(path, bed, camera):
    """The frames of each complete picture: positions in the box of bodies, beads first, [exposure, bodies, 2], the images of the box
    that they are in, headings of the rods in the last frame, and positions of spheres, [exposure, spheres, 2]."""
    def in_order(group, part, frames):
        """Rows of a body may change from frame to frame: the order is that of the first frame."""
        rows = group[f"{part}/value"][frames]
        if "id/value" not in group:
            return rows
        first, now = np.argsort(group["id/value"][0]), np.argsort(group["id/value"][frames], axis=1)
        order = np.empty_like(now)
        order[:, first] = now
        return np.take_along_axis(rows, order[..., None], axis=1)

    with opened(path) as file:
        for first in range(0, bed.time.size - camera.exposure + 1, camera.every):
            frames = slice(first, first + camera.exposure)
            spheres = file["particles/trajectory"]
            found = [in_order(spheres, part, frames)[..., :2] for part in ("position", "image")]
            bodies, heading = [part[:, :bed.beads] for part in found], np.zeros(0)
            if bed.rods:
                rods = file["particles/trajectory_rods"]
                bodies = [np.hstack([part, in_order(rods, name, frames)[..., :2]]) for part, name in zip(bodies, ("position", "image"))]
                heading = _core.rod_heading(*in_order(rods, "orientation", frames)[-1].T)
            if not (np.isfinite(heading).all() and ((0 <= bodies[0]) & (bodies[0] < bed.box)).all()):
                raise ValueError(f"frames {first} to {first + camera.exposure - 1}: a position outside the box, or not finite")
            yield *bodies, heading, found[0]


# The picture, its spots and its pixels.


def widest_view(camera, bed):
    """The largest view whose corners lie inside the bed."""
    c, s, stretch = abs(math.cos(camera.turned)), abs(math.sin(camera.turned)), 1.0 - 1.5 * min(camera.distortion, 0.0)
    if bed.is_round:
        return 2.0 * bed.window[2] / math.hypot(*bed.box) / stretch
    x0, y0, x1, y1 = bed.window or (0.0, 0.0, *bed.box)
    return min((x1 - x0) / (c * bed.box[0] + s * bed.box[1]), (y1 - y0) / (s * bed.box[0] + c * bed.box[1])) / stretch


def sees_all(camera, bed):
    """A pincushion would draw parts of a dish out of the picture."""
    return camera.sees_the_box or (bed.is_round and camera.view == 1.0 and camera.distortion <= 0.0)


def size_of(camera, bed):
    """Columns and rows of a picture, in pixels."""
    return [math.ceil(camera.view * side / camera.pixel * (1.0 - 1e-12)) for side in bed.box]


def check(camera, bed):
    """Refuses what the program cannot see of the options alone."""
    def require(holds, name, legal):
        if not holds:
            raise InputError(f"camera: {name} = {getattr(camera, name):g}: must be {legal}")

    require(0.0 < camera.pixel < min(bed.box), "pixel", "above 0 and below the side of the box, m")
    require(camera.exposure <= camera.every, "exposure", "from 1 to the frames between pictures")
    require(0.0 < camera.view <= 1.0, "view", "above 0 and at most 1")
    require(0.0 <= camera.lost < 1.0, "lost", "0 or more and below 1")
    require(0.0 <= camera.noise < min(bed.box), "noise", "0 or more and below the side of the box, m")
    widest = widest_view(camera, bed)
    if not sees_all(camera, bed) and camera.view > widest:
        raise InputError(f"camera: view = {camera.view:g}: so turned and distorted the picture reaches beyond the "
                         f"{'bed' if bed.window else 'box'}; take {widest:.3g} or less"
                         f"{', or all of the dish: view = 1 and distortion 0 or less' if bed.is_round else ''}")
    columns, rows = size_of(camera, bed)
    if camera.images and columns * rows > MOST_PIXELS:
        raise InputError(f"camera: pictures of {columns} x {rows} pixels: at most 1e8; take a larger pixel, or a smaller view")


def window_of(camera, bed):
    """The part of the bed that is seen, m in the picture, as Bed.window; None: all of a periodic box."""
    if not sees_all(camera, bed):
        return (0.0, 0.0, *(camera.view * bed.box))
    if bed.is_round:
        x, y, radius = bed.window
        return x, y, radius * (1.0 + camera.distortion * (2.0 * radius / (camera.view * math.hypot(*bed.box)))**2)
    return bed.window


def fold(points, box):
    inside = points - box * np.floor(points / box)
    return np.where(inside < box, inside, 0.0)


def in_picture(camera, bed, points):
    """Where points of the bed, (N, 2), appear, m in the picture; NaN far outside, where a barrel folds back."""
    from_middle, picture = points - 0.5 * bed.box, camera.view * bed.box
    far = np.sum(from_middle**2, axis=1) / (0.25 * np.sum(picture**2))
    c, s = math.cos(camera.turned), math.sin(camera.turned)
    turned = from_middle @ np.array([[c, -s], [s, c]])
    return np.where((far <= 3.0)[:, None], (1.0 + camera.distortion * far)[:, None] * turned + 0.5 * picture, np.nan)


class Film:
    """Spots of picture after picture, and the numbers of their particles."""

    def __init__(self, camera, bed):
        check(camera, bed)
        self.camera, self.bed, self.pictures, self.particles = camera, bed, 0, 0
        self.number, self.last = np.zeros((2, bed.beads + bed.rods), dtype=int)  # of each body, and the last picture with it, from 1

    def spots(self, position, image, heading):
        """Particles (from 0, in the order of first sight), positions in pixels (N, 2) and headings (NaN: a bead) of the next picture."""
        camera, bed = self.camera, self.bed
        self.pictures += 1
        at = position[0] if camera.exposure == 1 else fold(np.mean(position + image * bed.box, axis=0), bed.box)
        heading, seen = np.concatenate([np.full(bed.beads, np.nan), heading]), np.ones(len(at), dtype=bool)
        if not camera.sees_the_box:
            at, heading = in_picture(camera, bed, at), heading - camera.turned
            seen = ((at >= 0.0) & (at < camera.view * bed.box)).all(axis=1)

        # All bodies draw their numbers, so that another view loses the same ones.
        random = camera.random(self.pictures, POSITIONS)
        seen &= random.random(len(at)) >= camera.lost
        at = at + camera.noise * random.standard_normal(at.shape) if camera.noise else at
        if camera.noise and bed.window is None and camera.sees_the_box:
            at = fold(at, bed.box)

        # A particle that was not seen for long is another one.
        new = seen & ((self.last == 0) | (self.pictures - self.last > camera.memory + 1))
        self.number[new] = self.particles + np.arange(new.sum())
        self.particles += int(new.sum())
        self.last[seen] = self.pictures
        return self.number[seen], at[seen] / camera.pixel, heading[seen]


def draw(camera, bed, picture, spheres, radius, value):
    """Grey values [rows, columns], from the top, of spheres at [exposure, N, 2], m; the brightest of those above each other is seen."""
    columns, rows = size_of(camera, bed)
    mean = np.zeros((rows, columns), dtype=np.float32)
    for points in spheres:
        frame = np.full_like(mean, BACKGROUND)
        for (x, y), r, white in zip(in_picture(camera, bed, fold(points, bed.box)) / camera.pixel, radius / camera.pixel, value):
            if not math.isfinite(x):
                continue
            reach = r + 4.0 * camera.blur
            (i0, i1), (j0, j1) = ([int(min(max(edge, 0), most)) for edge in (at - reach, at + reach + 1)] for at, most in ((x, columns), (y, rows)))
            off = np.hypot(np.arange(i0, i1) + 0.5 - x, (np.arange(j0, j1) + 0.5 - y)[:, None])  # pixel k reaches from k to k + 1
            inside = 0.5 * np.interp((off - r) / (math.sqrt(2.0) * camera.blur), ERFC_AT, ERFC)
            np.maximum(frame[j0:j1, i0:i1], BACKGROUND + (white - BACKGROUND) * inside, out=frame[j0:j1, i0:i1], casting="same_kind")
        mean += frame / np.float32(len(spheres))
    noise = camera.random(picture, PHOTONS).standard_normal(mean.shape, dtype=np.float32)
    return np.clip(np.rint(WHITE * (mean + np.sqrt(mean / np.float32(camera.photons)) * noise)), 0, 255).astype(np.uint8)[::-1]


def png(grey):
    """A PNG file of 8-bit grey values, [rows, columns] from the top."""
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    rows, columns = grey.shape
    lines = np.hstack([np.zeros((rows, 1), dtype=np.uint8), grey])  # each begins with its filter, none
    header = struct.pack(">IIBBBBB", columns, rows, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines.tobytes(), 6)) + chunk(b"IEND", b"")


# The command.


def length(option, text, bead_radius):
    """"0.05 a", "25 um", "1e-5" (m), in m."""
    found = LENGTH.fullmatch(text)
    scale = UNITS | {"a": bead_radius}
    if not found or found[2] not in scale or not math.isfinite(float(found[1])):
        raise InputError(f'{option} {text}: is not a length such as "0.05 a" or "25 um"')
    return float(found[1]) * scale[found[2]]


def scene_text(camera, bed, interval, pictures, command):
    window = window_of(camera, bed)
    numbers = ", ".join(map(number, window or bed.box))
    seen = f'window = "periodic"           # the whole box\nbox = [{numbers}]' if window is None else \
        f"window = {{ {'circle' if len(window) == 3 else 'rectangle'} = [{numbers}] }}"
    error = f"localisation = {number(camera.noise)}   # m\n" if camera.noise else ""
    enough = "true" if pictures >= PICTURES_FOR_STIFFNESS else f"false     # of {PICTURES_FOR_STIFFNESS} pictures and more"
    # Tracks have one radius: of several sizes that with which they cover what they cover.
    radii = np.asarray(bed.bead_radii)
    radius = bed.bead_radius if radii.size == 0 or np.ptp(radii) == 0.0 else float(np.sqrt(np.mean(np.square(radii))))
    return (f'# {command}\nschema = 1\ntitle = "A bed, seen by a camera"\n\n[tracks]\nfile = "tracks.csv"\n'
            f"frames_per_second = {number(1.0 / interval)}\npixel = {number(camera.pixel)}                   # m\n"
            f"bead_radius = {number(radius)}\n{seen}\n{error}\n"
            f"[measure]\norder = true\norder_interval = {number(max(1, pictures // 40) * interval)}\n"
            f"microrheology = {enough}\nblock = {number(0.25 * interval * (pictures - 1))}\n")


def main(request):
    run = Path(request.text("target"))
    folder = Path(request.text("output") or (run if run.is_dir() else run.parent) / "camera")
    if not request.text("output"):  # a folder that the user names may be a link
        refuse_link(folder)
    refuse_link(folder / "images")
    for name in ("tracks.csv", "camera.toml", "images"):
        if not request.flag("force"):
            refuse_present(folder / name)

    file = run if run.is_file() else run / "trajectory.h5md"
    if not run.is_dir() and not run.is_file():
        raise InputError(f"{run}: not a run directory; rodwake dem SCENE makes one")
    if not file.is_file():
        raise InputError(f"{run}: holds no frames (trajectory.h5md); run its scene with granular.output.formats = [\"h5md\"] and one run")
    bed = read_bed(file)
    camera = Camera(
        pixel=length("--pixel", request.text("pixel", "0.05 a"), bed.bead_radius), every=request.whole("every", 1),
        exposure=request.whole("exposure", 1), view=request.number("view", 1), turned=math.radians(request.number("turned", 0)),
        distortion=request.number("distortion", 0), lost=request.number("lost", 0), memory=request.whole("memory", 3),
        noise=length("--noise", request.text("noise", "0"), bed.bead_radius), seed=request.whole("seed", 1), images=request.whole("images", 0),
        blur=request.number("blur", 1), photons=request.number("photons", 1000))
    if bed.time.size < camera.every + camera.exposure:
        raise InputError(f"{file}: {bed.time.size} frames are fewer than two pictures")
    interval = camera.every * (bed.time[-1] - bed.time[0]) / (bed.time.size - 1)

    film, rows, spots = Film(camera, bed), ["frame,particle,x,y,theta,kind\n"], 0
    radius = np.concatenate([bed.bead_radii, bed.sphere_radius])
    white = np.where(np.arange(len(radius)) < bed.beads, 1.0, 0.5)  # beads are white and rods grey: a finder has it easy
    for picture, (position, image, heading, spheres) in enumerate(read_pictures(file, bed, camera)):
        particles, at, theta = film.spots(position, image, heading)
        spots += len(particles)
        rows += [f"{picture},{particle},{number(x)},{number(y)},{f',bead' if math.isnan(angle) else f'{number(angle)},rod'}\n"
                 for particle, (x, y), angle in zip(particles.tolist(), at.tolist(), theta.tolist())]
        if picture < camera.images:
            write_atomically(folder / f"images/{picture:06}.png", png(draw(camera, bed, picture + 1, spheres, radius, white)))

    drawn = min(camera.images, film.pictures)
    earlier = drawn
    while (image := folder / f"images/{earlier:06}.png").exists():  # of a longer film before this one
        image.unlink()
        earlier += 1
    write_atomically(folder / "tracks.csv", "".join(rows))
    write_atomically(folder / "camera.toml", scene_text(camera, bed, interval, film.pictures, request.text("command")))
    if not request.flag("quiet"):
        print(f"{folder / 'tracks.csv'}: {film.pictures} pictures, {spots} spots{f'; {drawn} drawn in images' if drawn else ''}\n"
              f"{folder / 'camera.toml'}: rodwake run {folder / 'camera.toml'} measures them")
