"""One film in every format, written by hand or by the libraries alone, and films as the converter makes them."""

import os
import shutil
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(os.environ.get("RODWAKE_SOURCE_DIR", Path(__file__).parents[2]))
sys.path.insert(0, str(SOURCE / "convert"))

import gsd.hoomd  # noqa: E402
import h5py  # noqa: E402
import numpy as np  # noqa: E402
from rodwake_convert import command, convert, gsd_film, h5md, lammps  # noqa: E402, F401 (imported before the forks, which are quick then)

EMPTY, UNTRACKED = -(2**63), -(2**63) + 1
SIDES = np.array([24.0, 22.0, 2.0])


def walk(frames=12, beads=20, seed=3):
    """Positions that single precision has, in the box; ids 1, 2, ...; image indices."""
    random = np.random.default_rng(seed)
    start = random.random((beads, 3)) * SIDES * [1, 1, 0.4]
    free = (start + np.cumsum(random.normal(scale=0.4, size=(frames, beads, 3)) * [1, 1, 0.1], axis=0))
    image = np.floor(free / SIDES).astype(int) * [1, 1, 0]
    return (free - image * SIDES).astype(np.float32).astype(float), image


PLACE, IMAGE = walk()


def dump(place=PLACE, columns="id type x y z ix iy", bounds="BOUNDS pp pp ff\n0 24\n0 22\n0 2",
         step=lambda t: 100 * t, image=IMAGE, type_of=lambda i: 1 + (i == 0)):
    text = []
    for t, rows in enumerate(place):
        text.append(f"ITEM: TIMESTEP\n{step(t)}\nITEM: NUMBER OF ATOMS\n{len(rows)}\nITEM: BOX {bounds}\nITEM: ATOMS {columns}\n")
        for i in np.random.default_rng(t).permutation(len(rows)).tolist():
            x, y, z = rows[i].tolist()
            words = {"id": i + 1, "type": type_of(i), "x": x, "y": y, "z": z, "xu": x, "yu": y, "zu": z, "ix": image[t, i, 0], "iy": image[t, i, 1],
                     "xs": x / 24, "ys": y / 22, "xsu": x / 24, "ysu": y / 22}
            text.append(" ".join(str(words[name]) for name in columns.split()) + "\n")
    return "".join(text)


def xyz(place=PLACE, second='Lattice="24 0 0 0 22 0 0 0 2" Properties=species:S:1:pos:R:3:id:I:1:kind:S:1 pbc="T T F" Time={time} Step={step}'):
    text = []
    for t, rows in enumerate(place):
        text.append(f"{len(rows)}\n{second.format(time=t / 10, step=100 * t)}\n")
        text += [f"A {' '.join(map(repr, rows[i].tolist()))} {i + 1} {'rod' if i == 0 else 'bead'}\n" for i in range(len(rows))]
    return "".join(text)


def trackmate(place=PLACE, spot=lambda t, i: {}, more="", edges=None, filtered=None, head='<?xml version="1.0" encoding="UTF-8"?>'):
    n = len(place[0])
    text = [head, '<TrackMate version="7.9"><Model spatialunits="um"><AllSpots>']
    for t, rows in enumerate(place):
        text.append(f'<SpotsInFrame frame="{t}">')
        for i, (x, y, _) in enumerate(rows.tolist()):
            keys = {"ID": n * t + i, "name": "s", "FRAME": t, "POSITION_X": repr(x), "POSITION_Y": repr(y), "POSITION_Z": "0.0",
                    "VISIBILITY": 1} | spot(t, i)
            text.append("<Spot " + " ".join(f'{key}="{value}"' for key, value in keys.items() if value is not None) + "/>")
        text.append("</SpotsInFrame>")
    text.append("</AllSpots><AllTracks>")
    for i in range(n):
        links = [(n * t + i, n * t + n + i) for t in range(len(place) - 1)] if edges is None else edges.get(i, [])
        text.append(f'<Track TRACK_ID="{i}">' + "".join(f'<Edge SPOT_SOURCE_ID="{a}" SPOT_TARGET_ID="{b}"/>' for a, b in links) + "</Track>")
    text.append("</AllTracks>" + more)
    if filtered is not None:
        text.append("<FilteredTracks>" + "".join(f'<TrackID TRACK_ID="{k}"/>' for k in filtered) + "</FilteredTracks>")
    return "\n".join(text) + "</Model></TrackMate>\n"


def table(place=PLACE):
    rows = [f"{t},{t / 10},{i},{x!r},{y!r},{'0.5' if i == 0 else ''},{'rod' if i == 0 else 'bead'}\n"
            for t, frame in enumerate(place) for i, (x, y, _) in enumerate(frame.tolist())]
    return "frame,t,particle,x,y,theta,kind\n" + "".join(rows)


def write_gsd(path, place=PLACE, step=lambda t: 100 * t, box=lambda t: [24, 22, 2, 0, 0, 0], **first):
    with gsd.hoomd.open(str(path), "wb") as out:
        for t, rows in enumerate(place):
            frame = gsd.hoomd.Snapshot()
            frame.configuration.step, frame.configuration.box = step(t), box(t)
            frame.particles.N, frame.particles.types, frame.particles.typeid = len(rows), ["rod", "bead"], [int(i > 0) for i in range(len(rows))]
            frame.particles.position = (rows - SIDES / 2).astype(np.float32)
            frame.particles.image = IMAGE[t, :len(rows)] if len(IMAGE[t]) >= len(rows) else None
            frame.particles.diameter = [1.5] * len(rows)
            frame.log["time"] = np.array([t / 10])
            out.append(frame)


def write_h5md(path, place=PLACE, group="discs", edit=None, libver=None):
    """As other programs do: ids in time, a row that is empty, single precision, fixed step and time."""
    with h5py.File(path, "w", libver=libver) as out:
        particles, frames = out.create_group("particles/" + group), len(place)
        order = np.stack([np.random.default_rng(t).permutation(place.shape[1]) for t in range(frames)])
        rows = np.take_along_axis(place, order[..., None], axis=1)
        particles.create_dataset("position/value", data=np.concatenate([rows, np.full((frames, 1, 3), 7.0)], axis=1).astype(np.float32))
        particles["position/step"], particles["position/time"] = 100, 100.0
        particles["position/time"].attrs["unit"] = "ms"
        ids = particles.create_dataset("id/value", (frames, place.shape[1] + 1), np.int32, fillvalue=-1)
        ids[:, :-1] = order + 1
        image = np.take_along_axis(IMAGE[:frames, :place.shape[1]], order[..., None], axis=1)
        particles["image/value"] = np.concatenate([image, np.zeros((frames, 1, 3), int)], axis=1)
        box = particles.create_group("box")
        box.attrs["dimension"], box.attrs["boundary"] = 3, ["periodic", "periodic", "none"]
        box["edges"] = SIDES
        if edit:
            edit(out, particles)


def write_bed(path):
    """The layout of a bed of rodwake: two beads and a rod of two spheres, lengths in m."""
    def edit(out, spheres):
        del spheres["id"], spheres["image"], spheres["box/edges"]
        spheres["id/value"] = np.tile(np.arange(4, dtype=np.int32), (3, 1))
        spheres["species"], spheres["radius"] = np.int32([0, 0, 1, 1]), np.full(4, 0.4)
        spheres["box/edges/value"] = np.tile(np.diag(SIDES), (3, 1, 1))
        rods = out.create_group("particles/trajectory_rods")
        rods["position/value"] = PLACE[:3, 2:3]
        rods["position/step"], rods["orientation/value"], rods["id/value"] = 100, np.tile([0.6, 0, 0, 0.8], (3, 1, 1)), np.zeros((3, 1), np.int32)
        out.require_group("parameters").attrs["bead_radius"] = 0.4
        out.require_group("parameters/kinds").attrs.update({"bead": np.int32(0), "rod": np.int32(1)})
        out.require_group("parameters/units").attrs["length"] = "m"
    write_h5md(path, PLACE[:3, :3], "trajectory", edit)


class Film:
    """What rodwake reads of a converted film: by frame, {id: position} of beads and of rods."""

    def __init__(self, path):
        with h5py.File(path) as file:
            group, own = file["particles/trajectory"], dict(file["rodwake"].attrs)
            self.step, self.attributes = group["position/step"][()].tolist(), own
            self.time = group["position/time"][()].tolist() if "position/time" in group else None
            self.id, self.position = group["id/value"][()], group["position/value"][()]
            self.image = group["image/value"][()] if "image" in group else None
            self.edges = group["box/edges/value"][()] if "box/edges" in group else None
            self.origin = group["box/origin/value"][()] if "box/origin" in group else None
            self.boundary = [flag if isinstance(flag, str) else flag.decode() for flag in group["box"].attrs["boundary"]]
            self.names = [name if isinstance(name, str) else name.decode() for name in group["species/value"].attrs.get("names", [])]
            self.radius = group["radius/value"][()] if "radius" in group else None
            self.species = group["species/value"][()]
            rods = file.get("particles/trajectory_rods")
            self.rods = None if rods is None else {name: rods[name + "/value"][()] for name in ("position", "id", "orientation")}

    def seen(self):
        """(frame, id, x, y) of all rows with a particle, beads and rods."""
        found = []
        for ids, position in [(self.id, self.position)] + ([(self.rods["id"], self.rods["position"])] if self.rods else []):
            found += [(t, int(ids[t, i]), *position[t, i, :2].tolist()) for t, i in zip(*np.nonzero(ids != EMPTY))]
        return sorted(found)


def truth(first=1, place=PLACE):
    return sorted((t, i + first, *xyz[:2]) for t, rows in enumerate(place.tolist()) for i, xyz in enumerate(rows))


class ConvertTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)

    def put(self, name, content):
        path = self.folder / name
        if content is not None:
            path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return str(path)

    def run_on(self, name, content, *arguments, out="film.h5md"):
        """The outcome of a conversion; messages name the file by its name alone."""
        options = command.arguments([self.put(name, content), "-o", str(self.folder / out), "--force", *arguments])
        outcome = command.run(options)
        outcome.message = outcome.message.replace(f"{self.folder}/", "")
        return outcome

    def film(self, name, content, *arguments, **keys):
        outcome = self.run_on(name, content, *arguments, **keys)
        self.assertEqual((outcome.code, outcome.message), (0, ""))
        self.lines = outcome.lines
        return Film(self.folder / "film.h5md")

    def refused(self, said, name, content, *arguments, **keys):
        outcome = self.run_on(name, content, *arguments, **keys)
        self.assertEqual((outcome.code, outcome.death), (2, ""), outcome)
        self.assertTrue(outcome.message.startswith(name), outcome.message)
        self.assertIn(said, outcome.message)
        self.assertEqual([path.name for path in self.folder.iterdir() if path.name.endswith(".part")], [])


WORDS = [b"nan", b"-inf", b"1e400", b"-1", b"", b'"', b"[", b"\x00", b"9" * 400, b"\xff\xfe", b"0x", b"1e-400", b"1_0", "\u0663".encode()]


def damaged(good, chance):
    """The bytes of `good` with one to three injuries: bits, bytes, zeros, cuts, insertions, words that are no numbers."""
    data = bytearray(good)
    for _ in range(chance.randint(1, 3)):
        at, length, how = chance.randrange(len(data) + 1), chance.randint(1, 64), chance.randrange(7)
        if how < 2 and data:
            data[at % len(data)] = chance.randrange(256) if how else data[at % len(data)] ^ 1 << chance.randrange(8)
        elif how == 2:
            data[at:at + length] = bytes(len(data[at:at + length]))
        elif how == 3:
            del data[at:at + length]
        elif how == 4:
            data[at:at] = chance.randbytes(length)
        elif how == 5:
            data[at:at + chance.randint(1, 6)] = chance.choice(WORDS)
        elif chance.random() < 0.2:
            del data[at:]
    return bytes(data)


def small_films(folder):
    """name -> bytes of a small film in every format; "sums.h5md" has a checksum on every byte that matters."""
    place = PLACE[:6, :8]
    write_gsd(folder / "a.gsd", place)
    write_h5md(folder / "a.h5md", place)

    def with_sums(out, group):
        for name in ("position/value", "id/value", "image/value"):
            data, fill = group[name][()], group[name].fillvalue
            del group[name]
            group.create_dataset(name, data=data, fletcher32=True, chunks=(2, *data.shape[1:]), fillvalue=fill)
    write_h5md(folder / "sums.h5md", place, edit=with_sums, libver="latest")  # its metadata have sums, too
    texts = {"a.dump": dump(place), "a.xyz": xyz(place), "a.xml": trackmate(place), "a.csv": table(place)}
    return {name: text.encode() for name, text in texts.items()} | {name: (folder / name).read_bytes() for name in ("a.gsd", "a.h5md", "sums.h5md")}
