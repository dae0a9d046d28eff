"""Films of other programs, as the converter reads and writes them: each row of issue 51's table that concerns a format."""

import os
import re
import signal
import subprocess
import time

from films import *  # noqa: F403 (helpers of these tests)
from rodwake_convert import supervise

COMMAND = ["/usr/bin/python3", str(SOURCE / "convert/rodwake_convert")]


def put(text, old, new, count=1):
    assert old in text, old
    return text.replace(old, new, count)


class Formats(ConvertTest):
    def test_one_film_in_every_format(self):
        self.assertEqual(self.film("a.dump", dump()).seen(), truth())
        film = self.film("a", xyz())
        self.assertEqual((film.seen(), film.time[3], film.rods["id"].tolist()), (truth(), 0.3, [[1]] * 12))
        self.assertEqual(film.boundary, ["periodic", "periodic", "none"])
        film = self.film("a.xml", trackmate())
        self.assertEqual((film.seen(), film.attributes["length_unit"], film.attributes["certain_ids"]), (truth(0), "um", 0))
        film = self.film("a.csv", table())
        self.assertEqual((film.seen(), film.time[1]), (truth(0), 0.1))
        np.testing.assert_allclose(film.rods["orientation"][0, 0], [np.cos(0.25), 0, 0, np.sin(0.25)])
        write_gsd(self.folder / "a.gsd")
        film = self.film("a.gsd", None)
        np.testing.assert_allclose([row[2:] for row in film.seen()], np.array([row[2:] for row in truth(0)]) - SIDES[:2] / 2, atol=2e-6)
        self.assertEqual((film.image[:, :, :2] == IMAGE[:, 1:, :2]).all(), True)
        self.assertEqual((film.origin[0].tolist(), film.names, film.rods["id"][0].tolist()), ([-12.0, -11.0, -1.0], ["rod", "bead"], [0]))
        self.assertEqual(film.radius[0, 0], 0.75)
        write_h5md(self.folder / "a.h5md")
        film = self.film("a.h5md", None)
        self.assertEqual((film.seen(), film.step[2], film.time[2]), (truth(), 200, 0.2))
        self.assertTrue((film.image == IMAGE).all())
        write_bed(self.folder / "bed.h5md")
        film = self.film("bed.h5md", None)
        self.assertEqual((film.id[0].tolist(), film.rods["orientation"][0].tolist()), ([0, 1], [[0.6, 0, 0, 0.8]]))
        self.assertEqual(film.attributes["length_unit"], "m")

    def test_there_and_back(self):
        """All digits; GSD those of single precision."""
        film = self.film("a.dump", dump())
        for name in ("b.dump", "b.xyz", "b.gsd", "b.csv", "b.h5md"):
            self.assertEqual(self.run_on("film.h5md", None, out=name).code, 0)
            back = self.film(name, None)
            if name != "b.gsd":
                self.assertEqual(back.seen(), film.seen(), name)
            shift = back.origin[0] if name == "b.gsd" else np.zeros(3)
            self.assertEqual((back.id.tolist(), back.step), (film.id.tolist(), film.step), name)
            if name != "b.csv":
                np.testing.assert_allclose(back.position - shift, film.position, atol=2e-6 if name == "b.gsd" else 0, rtol=0, err_msg=name)
                for quantity in ("image", "edges", "species"):
                    self.assertEqual(getattr(back, quantity).tolist(), getattr(film, quantity).tolist(), (name, quantity))
            self.film("a.dump", None)

    def test_a_bed_for_other_programs(self):
        write_bed(self.folder / "bed.h5md")
        for arguments, out, rows in (([], "a.gsd", 4), ([], "a.xyz", 4), (["--rods", "poses"], "a.dump", 3), ([], "a.csv", 3)):
            outcome = self.run_on("bed.h5md", None, *arguments, out=out)
            self.assertEqual((outcome.code, outcome.message), (0, ""))
            film = self.film(out, None, *(["--rod-kind", "1"] if out == "a.dump" else []))
            self.assertEqual(len([row for row in film.seen() if row[0] == 0]), rows, out)
            self.assertEqual(film.rods["id"].shape[1], 2 if rows == 4 else 1, out)
        np.testing.assert_allclose(film.seen()[0][2:], PLACE[0, 2, :2] / 0.4, rtol=1e-12)  # rod 0 is -1 here, since bead 0 has its number
        self.assertEqual(film.seen()[0][1], -1)
        self.assertEqual(self.run_on("bed.h5md", None, "--unit", "mm", "--frames", "1::2", out="a.csv").code, 0)
        film = self.film("a.csv", None)
        np.testing.assert_allclose(film.seen()[-1][2:], PLACE[1, 1, :2] * 1e3)
        self.assertEqual((film.step, self.run_on("a.csv", None, "--unit", "mm", out="b.csv").code), ([100], 2))
        exists = command.run(command.arguments([str(self.folder / "a.csv"), "-o", str(self.folder / "bed.h5md")]))
        self.assertEqual((exists.code, "--force" in exists.message), (1, True))

    def test_boxes_that_change_are_kept(self):
        text = dump()
        at = text.rindex("0 24\n")
        write_gsd(self.folder / "c.gsd", box=lambda t: [24 + 16 * (t == 11), 22, 2, 0, 0, 0])

        def changing(out, group):
            del group["box/edges"]
            group["box/edges/value"] = np.stack([[24.0 + 16 * (t == 11), 22, 2] for t in range(12)])
        write_h5md(self.folder / "c.h5md", edit=changing)
        second = xyz().rindex("Lattice=\"24")
        late = xyz()[:second] + 'Lattice="40' + xyz()[second + 11:]
        for name, content in (("c.dump", text[:at] + "0 40\n" + text[at + 5:]), ("c.xyz", late), ("c.gsd", None), ("c.h5md", None)):
            film = self.film(name, content)
            self.assertEqual(film.edges[:, 0, 0].tolist(), [24.0] * 11 + [40.0], name)
            for out in ("d.xyz", "d.dump", "d.gsd"):
                self.assertEqual(self.run_on("film.h5md", None, out=out).code, 0)
                self.assertEqual(self.film(out, None).edges[:, 0, 0].tolist(), [24.0] * 11 + [40.0], (name, out))
                self.film(name, None)

    def test_dumps(self):
        film = self.film("a.dump", dump(columns="yu id xu type"))
        self.assertEqual((film.seen(), film.image.any()), (truth(), False))
        film = self.film("a.dump", dump(columns="id xs ys ix iy"))
        np.testing.assert_allclose(film.position[..., :2], PLACE[..., :2], rtol=1e-14)
        self.assertTrue((film.image == IMAGE).all())
        self.assertIsNone(self.film("a.dump", dump(columns="id x y")).image)
        film = self.film("a.dump", dump(columns="x y"))
        self.assertTrue((film.id == UNTRACKED).all())
        for bounds in ("BOUNDS abc origin pp pp ff\n24 0 0 -12\n0 22 0 0\n0 0 2 0", "BOUNDS xy xz yz pp pp ff\n-12 12 0\n0 22 0\n0 2 0.0",
                       "BOUNDS\n-12 12\n0 22\n0 2"):
            film = self.film("a.dump", dump(bounds=bounds))
            self.assertEqual((np.diag(film.edges[0]).tolist(), film.origin[0].tolist(), film.boundary[0]), ([24, 22, 2], [-12, 0, 0], "periodic"))
        film = self.film("a.dump", dump(bounds="BOUNDS xy xz yz pp pp pp\n0 29 5\n0 22 0\n0 2 0"))
        self.assertEqual(film.edges[0].tolist(), [[24, 0, 0], [5, 22, 0], [0, 0, 2]])
        self.assertEqual(self.film("a.dump", dump(step=lambda t: [0, 27][t] if t < 2 else 27 + 10**t)).step[:4], [0, 27, 127, 1027])
        film = self.film("a.dump", put(dump(), "ITEM: TIMESTEP\n0", "ITEM: UNITS\nlj\nITEM: TIME\n0.5\nITEM: TIMESTEP\n0"), "--rod-kind", "2")
        self.assertEqual((film.time, film.rods["id"].shape, film.attributes["length_unit"]), (None, (12, 1), "lj"))
        film = self.film("a.dump", dump(step=lambda t: 7))
        self.assertEqual((film.step, len(film.attributes["warnings"])), (list(range(12)), 1))
        self.refused("frame 2: the step 100 does not increase", "a.dump", dump(step=lambda t: min(t, 1) * 100))
        self.refused("frame 1: the step 90 does not increase", "a.dump", dump(step=lambda t: 100 - 10 * t))

    def test_extended_xyz(self):
        plain = 'Properties=species:S:1:pos:R:3 Step={step} pbc="T T F" '
        lattices = ['Lattice = "24 0 0 0 22 0 0 0 2"', "Lattice=[[24, 0, 0], [0, 22, 0], [0, 0, 2]]", "Lattice={{24 0 0 0 22 0 0 0 2}}",
                    'LATTICE="2.4D+01 0 0 1d-15 22 0 0 1e-13 2"', r'comment="a \" Lattice=5" Lattice="24 0 0 0 22 0 0 0 2"']
        for lattice in lattices:
            film = self.film("a.xyz", re.sub(r" \d+ (rod|bead)", "", xyz(second=plain + lattice)))
            self.assertEqual((film.seen(), film.edges[0].tolist()), (truth(0), np.diag(SIDES).tolist()), lattice)
        bare = re.sub(r" \d+ (rod|bead)", "", xyz(second='Lattice="24 0 0 0 22 0 0 0 2" pbc = "T F F" step = {step}'))
        film = self.film("a.xyz", bare)
        self.assertEqual((film.boundary, film.step[1]), (["periodic", "none", "none"], 100))
        film = self.film("a.xyz", re.sub(r"A \S+", "A 0.225D+01", bare, count=1))
        self.assertAlmostEqual(film.position[0, 0, 0], 2.25)
        for comment in ("frame 3 ; i = 3, time = 1.5", "", "Step=T", "a b c", "E=3, step 5"):
            film = self.film("a.xyz", re.sub(r" \d+ (rod|bead)", "", xyz(second=comment)))
            self.assertEqual((film.seen(), film.step, film.time), (truth(0), list(range(12)), None), comment)
        self.assertEqual(self.film("a.xyz", "1\nstep=5 time=2.5\nC 1 2 3\n").time, [2.5])
        self.assertEqual(self.film("a.xyz", "1\ni = 5, t = 2.5\nC 1 2 3\n", "--time-column", "t").time, [2.5])
        changing = "2\n\nC 1 2 0\nC 3 4 0\n1\n\nC 1 2 0\n"
        self.assertEqual(self.film("a.xyz", changing).id.tolist(), [[UNTRACKED, UNTRACKED], [UNTRACKED, EMPTY]])
        self.assertEqual(self.run_on("a.xyz", changing, out="b.csv").code, 0)
        self.assertEqual((self.folder / "b.csv").read_text().splitlines()[1], "0,,1.0,2.0")
        self.assertEqual(self.film("a.xyz", "2\n\nC 1 2 0\nC 3 nan 0\n2\n\nC 1 2 0\nC 3 4 0\n").id.tolist(), [[0, EMPTY], [0, 1]])
        self.assertEqual(self.film("a.xyz", changing[:19]).id.tolist(), [[0, 1]])

    def test_trackmate(self):
        for word in ("2,53", " 1.5", "12px", "0x10", "N/A", "", "1_000", "\u0663"):
            self.refused(f"a.xml:5: POSITION_X = \"{word}\"", "a.xml", trackmate(spot=lambda t, i: {"POSITION_X": word} if (t, i) == (0, 1) else {}))
        film = self.film("a.xml", trackmate(spot=lambda t, i: {"POSITION_X": ["nan", "NaN"][i]} if t == 0 and i < 2 else {}))
        self.assertEqual((film.attributes["without_place"], len(film.seen())), (2, 238))
        self.assertTrue(film.attributes["first_without_place"].endswith("a.xml:4"))
        film = self.film("a.xml", trackmate(edges={0: [(0, 99999), (20, 40)], 1: [(1, 21), (1, 22), (21, 41)], 2: [(2, 23)]},
                                              spot=lambda t, i: {"VISIBILITY": int((t, i) != (1, 3))}))
        attributes = film.attributes
        self.assertEqual([attributes[name] for name in ("dangling", "branches", "hidden")], [1, 2, 1])
        self.assertIn("1 links to spots that are not in the file", attributes["warnings"][0])
        self.assertEqual(sorted(film.id[film.id >= 0].tolist()), [0, 1, 1, 2, 2, 3])
        self.assertEqual({row[1] for row in self.film("a.xml", trackmate(filtered=[3, 4])).seen()}, {UNTRACKED, 0, 1})
        self.refused("no rate of the film is given", "a.xml", trackmate(), "--needs-times")
        self.refused("stands for a spot before", "a.xml", trackmate(spot=lambda t, i: {"ID": 5}))
        self.refused("all spots are in one frame", "a.xml", trackmate(spot=lambda t, i: {"FRAME": 0, "POSITION_Z": t}))
        latin = trackmate(more="<Note text='\u00b5m'/>").encode("latin-1")
        self.assertEqual(self.film("a.xml", latin).seen(), truth(0))  # a label
        self.refused("a <!DOCTYPE>", "a.xml", trackmate(head='<!DOCTYPE a [<!ENTITY b "c">]>'))

    def test_gsd(self):
        write_gsd(self.folder / "a.gsd", step=lambda t: 0)
        film = self.film("a.gsd", None)
        self.assertEqual((film.step, "all frames have the step 0" in film.attributes["warnings"][0]), (list(range(12)), True))
        write_gsd(self.folder / "a.gsd", step=lambda t: 100 - t)
        self.refused("frame 1: the step 99 does not increase", "a.gsd", None)
        with gsd.hoomd.open(str(self.folder / "a.gsd"), "wb") as out:
            for t in range(3000):
                frame = gsd.hoomd.Snapshot()
                frame.configuration.step = t
                frame.particles.N = 10**5
                if t == 0:
                    frame.particles.position = np.ones((10**5, 3), np.float32)
                out.append(frame)
        start = time.monotonic()
        self.refused("3e+08 rows (3000 frames of 100000 particles), which need 17.9 GB", "a.gsd", None)
        self.assertLess(time.monotonic() - start, 10)
        self.assertEqual(self.run_on("a.gsd", None, "--frames", "::1000").code, 0)
        (self.folder / "gsd.py").write_text("raise ImportError('none here')")
        code = "import sys; sys.path[:0] = sys.argv[1:3]; from rodwake_convert.command import main; sys.exit(main(sys.argv[3:]))"
        done = subprocess.run(["/usr/bin/python3", "-c", code, self.folder, SOURCE / "convert", self.folder / "a.gsd", "--look"],
                              capture_output=True, text=True)
        self.assertEqual((done.returncode, "apt-get install python3-gsd" in done.stderr, done.stderr.count("\n")), (1, True, 1))

    def test_h5md_of_others(self):
        def swap(path, *data, **keys):
            """Takes a path away from the group, and puts something else there."""
            def edit(out, group):
                del group[path]
                if data and isinstance(data[0], h5py.ExternalLink):
                    group[path] = data[0]
                elif data or keys:
                    group.create_dataset(path, data=data[0] if data else None, **keys)
            return edit

        def extra(out, group):
            out["particles/walls/position/value"] = np.zeros((1, 1, 2))

        def attributes(out, group):
            group["position/step"].attrs["offset"], group["position"].attrs["unit"], group["position/time"].attrs["unit"] = 30, "mm", "tau"
        write_h5md(self.folder / "a.h5md", edit=swap("box/edges", np.diag(SIDES).astype(np.float32)))
        self.assertEqual(self.film("a.h5md", None).edges[5].tolist(), np.diag(SIDES).tolist())
        write_h5md(self.folder / "a.h5md", edit=attributes)
        film = self.film("a.h5md", None)
        self.assertEqual((film.step[:2], film.attributes["length_unit"], film.time), ([30, 130], "mm", None))
        self.refused('time is in the unit "tau"', "a.h5md", None, "--needs-times")
        for said, change in (("no positions of particles/walls (tracks.group); there are: discs", None),
                             ("holds values of another type", swap("id", np.zeros(21))), ("step is missing", swap("position/step")),
                             ("does not increase", swap("position/step", np.arange(12)[::-1])),
                             ("is of shape [7], and there are 12 frames", swap("position/step", np.arange(7))),
                             ("link to another file", swap("image", h5py.ExternalLink("/etc/b.h5", "x"))),
                             ("several groups of particles: discs, walls", extra),
                             ("1e+12 rows", swap("position/value", shape=(10**6, 10**6, 3), dtype=np.float32, chunks=(1, 1000, 3))),
                             ("box/edges is missing", swap("box/edges"))):
            write_h5md(self.folder / "a.h5md", edit=change)
            self.refused(said, "a.h5md", None, *(["--group", "walls"] if change is None else []))
        with h5py.File(self.folder / "a.h5md", "w") as out:  # two dimensions, edges in time, no ids
            out["particles/all/position/value"], out["particles/all/position/step"] = PLACE[..., :2], np.arange(12) ** 2
            out.require_group("particles/all/box").attrs["boundary"] = ["periodic", "periodic"]
            out["particles/all/box/edges/value"] = np.tile(SIDES[:2], (12, 1))
        film = self.film("a.h5md", None)
        self.assertEqual((film.seen(), film.step[3], film.edges[11].tolist()), (truth(0), 9, np.diag([24, 22, 0]).tolist()))

    def test_numbers_and_texts_that_are_wrong(self):
        d, x = dump(), xyz()
        for said, name, content, *arguments in (
                ("a.dump:10: x = \"1_000\": expected a number", "a.dump", re.sub(r"(iy\n\d+ \d) \S+", r"\1 1_000", d, count=1)),
                ("a.dump:9: no columns x and y", "a.dump", put(d, "x y z", "a b c")),
                ("a.dump:9: no column \"px\"", "a.dump", d, "--column", "x=px"),
                ("has no columns of times", "a.dump", d, "--time-column", "t"),
                ("set tracks.frames_per_second", "a.dump", d, "--needs-times"),
                ("expected a line that begins with ITEM:", "a.dump", put(d, "ATOMS\n20", "ATOMS\n19")),
                ("step 0 has 20 of its 21 atoms", "a.dump", put(d, "ATOMS\n20", "ATOMS\n21")),
                ("is the line cut short?", "a.dump", d[:-9]),
                ("a.dump:10: x = \"1e400\"", "a.dump", re.sub(r"(iy\n\d+ \d) \S+", r"\1 1e400", d, count=1)),
                ("\"\": expected a number", "a.dump", put(d, "0 24\n", "0\n")),
                ("the sides of the box, -24 and 22", "a.dump", put(d, "0 24\n", "24 0\n")),
                ("a.dump:2: \"-5\": expected a whole", "a.dump", put(d, "STEP\n0", "STEP\n-5")),
                ("a.xyz:3: x = \"\u0663\"", "a.xyz", re.sub(r"A \S+", "A \u0663", x, count=1)),
                ("a.xyz:2: no column \"pos\"", "a.xyz", put(x, "pos:R:3", "place:R:3")),
                ("expected nine numbers", "a.xyz", put(x, "24 0 0 0", "24 0 0")),
                ("a.xyz:24: Step=soon: expected a whole number", "a.xyz", put(x, "Step=100", "Step=soon")),
                ("frame 2 has no Step", "a.xyz", put(x, "Step=100", "")),
                ("has no particle with a position in its 0 frames", "a.xyz", ""),
                ("has 20 of its 21 particles", "a.xyz", "21" + x[2:x.index("20\n", 5)]),
                ("no t= (tracks.time_column)", "a.xyz", x, "--time-column", "t"),
                ("the header is", "a.csv", "frame,x,y,z\n"),
                ("a.csv:3: has 2 cells", "a.csv", "frame,x,y\n0,1,2\n0,1\n"),
                ("a.csv:2: x = \"1_0\"", "a.csv", "frame,x,y\n0,1_0,2\n"),
                ("a line of more than 16 MB", "a.csv", "a" * 20_000_000),
                ("not a readable HDF5", "a.h5md", "no such thing"),
                ("not a readable GSD", "a.gsd", "no such thing"),
                ("a.xml:1: no XML", "a.xml", "<a"),
                ("no <TrackMate>", "a.xml", "<a/>")):
            with self.subTest(said):
                self.refused(said, name, content, *arguments)
        self.assertEqual(self.film("a.dump", d.replace("\n", "\r\n")).seen(), truth())
        self.assertEqual(self.film("a.dump", "\ufeff" + d.replace("\n", "\r")).seen(), truth())

    def test_the_command(self):
        """Names of any bytes; one line of error; locale without effect; Ctrl-C; a look."""
        odd = os.fsencode(self.folder) + b"/caf\xe9 \xff.dump"
        with open(odd, "wb") as file:
            file.write(dump().encode())
        for out in (b".h5md", b".gsd", b".xyz"):
            done = subprocess.run([*COMMAND, odd, "-o", odd + out], capture_output=True, env=os.environ | {"LC_ALL": "de_DE.UTF-8"})
            self.assertEqual((done.returncode, done.stderr), (0, b""))
            self.assertEqual(subprocess.run([*COMMAND, odd + out, "--look"], capture_output=True).returncode, 0)
        done = subprocess.run([*COMMAND, odd + b"none", "-o", odd + b".csv"], capture_output=True)
        self.assertEqual((done.returncode, done.stderr), (2, odd + b"none: no such file of tracks\n"))
        done = subprocess.run([*COMMAND, odd, "-o", "/proc/film.csv"], capture_output=True, text=True, errors="surrogateescape")
        self.assertEqual((done.returncode, "/proc/film.csv: cannot be written" in done.stderr, done.stderr.count("\n")), (1, True, 1))
        look = subprocess.run([*COMMAND, odd, "--look"], capture_output=True, text=True, errors="surrogateescape").stdout.splitlines()[-1]
        self.assertEqual(look, "done: 20 particles, 0 rods, box 24 x 22 x 2 (periodic in x, y), no times, steps 0, 100")
        with open(odd, "ab") as file:
            file.write("".join(dump(step=lambda t, k=k: 10**4 * k + t) for k in range(1, 800)).encode())
        for number in (signal.SIGINT, signal.SIGTERM):
            with subprocess.Popen([*COMMAND, odd, "-o", odd + b".csv"], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
                running.stdout.readline()
                running.send_signal(number)
                self.assertEqual((running.wait(10), running.stderr.read()), (128 + number, b""))
        self.assertEqual([name for name in os.listdir(os.fsencode(self.folder)) if name.endswith((b".part", b".csv"))], [])


class Supervisor(ConvertTest):
    def test_what_a_worker_may_do(self):
        part = self.put("a.part", "half")
        supervise.SECONDS, before = 1.0, supervise.SECONDS
        self.addCleanup(setattr, supervise, "SECONDS", before)
        for work, death, said in ((lambda report: time.sleep(60), "time", "the HDF5 library finds no end of this file (1 s without progress)"),
                                  (lambda report: os.kill(os.getpid(), signal.SIGSEGV), "signal", "library crashed on this file (SIGSEGV)"),
                                  (lambda report: np.ones(1 << 28), "memory", "a.h5md: reading it takes more than 1 GB of memory"),
                                  (lambda report: [report(k) or time.sleep(0.2) for k in range(8)], "", "")):
            outcome = supervise.run(work, "a.h5md", "HDF5", [part])
            self.assertEqual((outcome.death, said in outcome.message, outcome.code), (death, True, 2 if death else 0), outcome)
            self.assertEqual(os.path.exists(part), not death)
            part = self.put("a.part", "half")


if __name__ == "__main__":
    unittest.main()
