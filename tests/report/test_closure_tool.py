"""studies/validate_closure.py: which encounters it makes, and its tables and figure of made-up ones."""

import contextlib
import io
import json
import math
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from PIL import Image
from rodwake import SOURCE, ProgramTest

sys.path.insert(0, str(SOURCE / "studies"))
import validate_closure as tool  # noqa: E402

BENCH = os.environ.get("RODWAKE_BENCH_CLOSURE")
SCENE = """schema = 1
[medium]
eta = 1.0
alpha = 0.5
field = "dynamic"
[medium.dynamic]
box = 16.0
force_width = 0.6
modes = 30
start = "{start}"
[coupling]
kappa = 20.0
gamma1 = 2.0
gamma2 = -1.0
[[rods]]
position = [0.0, 2.0]
[[rods]]
position = [1.0, -2.0]
heading = 0.5
[rods_run]
t_end = 10.0
rtol = 1e-9
contact_distance = 1.0
"""
# Stands for bench_closure: rods that walk straight, and contact after a time that tells how the encounter was made.
PROGRAM = """#!/usr/bin/env python3
import json, sys
TIMES = {"memory": 10.0, "rest": 20.0, "steady": 11.0, "first_order": 9.0, "box": 12.0, "plane": 13.0}
for line in sys.stdin:
    how = line.split()[0]
    turn = 0.1 if how == "steady" else 0.0
    poses = [[0.25 * i, 0, turn * i, 0.25 * i, 5, 0] for i in range(4)]
    print(json.dumps({"ending": "contact", "time": TIMES[how], "cpu_seconds": 0.1, "poses": poses}), flush=True)
"""


def row(start="abreast", couplings=(1, 0, 0), alpha=1, number=0.05, **changed):
    kappa, gamma1, gamma2 = couplings
    made = {"start": start, "kappa": kappa, "gamma1": gamma1, "gamma2": gamma2, "alpha": alpha, "memory": "contact", "memory_time": 10.0,
            "spreading_time": tool.spreading_time(start, alpha), "memory_number": number}
    for how in tool.CLOSURES:
        made |= {how: "contact", f"{how}_time": 10.0, f"{how}_heading": 0.01 * kappa, f"{how}_time_error": 0.012}
    return made | changed


def run(ending, headings):
    return {"ending": ending, "poses": [[0, 0, heading, 0, 5, 0] for heading in headings]}


class EncountersTest(unittest.TestCase):
    def test_each_start_has_every_coupling_and_alpha(self):
        made = tool.encounters(quick=False)
        self.assertEqual(len(made), len(set(made)))
        apolar = {(start, (kappa, 0, 0), alpha) for start in tool.STARTS for kappa in tool.KAPPAS for alpha in tool.ALPHAS}
        self.assertEqual({one for one in made if one[1][0] > 0}, apolar)
        self.assertEqual({start for start, _, _ in made}, {"abreast", *(f"crossing, dx = {dx}" for dx in (-3, 0, 1, 3))})
        polar = {(start, couplings[1:], alpha) for start, couplings, alpha in made if couplings[0] == 0}
        signs = [(one, two) for one in (10, -10) for two in (10, -10)]
        self.assertEqual(polar, {(start, sign, alpha) for start in ("abreast", "crossing, dx = 1", "crossing, dx = 3")
                                 for sign in signs for alpha in (0.1, 1, 10)})

    def test_crossing_rods_start_where_their_name_says(self):
        for dx in (-3, 0, 1, 3):
            words = tool.case("memory", f"crossing, dx = {dx}", (1, 0, 0), 0.3).split()
            self.assertEqual([float(word) for word in words[11:16]], [0, 0, 0, dx, -5])
            self.assertAlmostEqual(float(words[16]), math.pi / 2, places=8)

    def test_rest_is_asked_for_beside_the_same_encounter_in_steady_wakes(self):
        options = type("Options", (), {"only": ["rest"], "quick": False})
        cases = tool.wanted(options)
        self.assertEqual(len(cases), 2 * 2 * len(tool.KAPPAS) * len(tool.ALPHAS))
        for rest, steady in zip(cases[::2], cases[1::2]):
            self.assertEqual((rest.split()[0], steady.split()[0]), ("rest", "steady"))
            self.assertEqual(rest.split()[1:], steady.split()[1:])


class RunsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.program = self.folder / "program"
        self.program.write_text(PROGRAM)
        self.program.chmod(0o755)

    def made(self):
        runs = tool.Runs(self.program, self.folder)
        with contextlib.redirect_stdout(io.StringIO()):
            runs.make([tool.case(how, "abreast", (1, 0, 0), 1) for how in ("memory", "rest", *tool.CLOSURES, "box", "plane")])
        return runs

    def test_rest_and_memory_are_compared_apart(self):
        runs = self.made()
        encounter = "abreast", (1, 0, 0), 1
        self.assertAlmostEqual(tool.compared(runs, *encounter)["steady_time_error"], 0.1)
        rest = tool.compared(runs, *encounter, medium="rest", closures=("steady",))
        self.assertAlmostEqual(rest["steady_time_error"], 11 / 20 - 1)
        self.assertAlmostEqual(rest["steady_heading"], 0.2)  # the last pose is that of the end
        self.assertNotIn("first_order", rest)
        self.assertAlmostEqual(rest["memory_number"], 0.1 / 0.25 * 25 / 4)
        self.assertEqual(tool.on_points(runs, rest)["plane_time"], 13.0)

    def test_encounters_that_are_there_are_not_made_again(self):
        known = self.made().known
        self.program.unlink()
        self.assertEqual(self.made().known, known)
        with (self.folder / "runs.jsonl").open("a") as file:
            file.write(json.dumps({"case": "cut"})[:-3])
        self.assertEqual(self.made().known, known)


@unittest.skipUnless(BENCH, "a build without benchmarks")
class BenchTest(ProgramTest):
    def test_memory_and_rest_are_the_two_starts_of_a_scene(self):
        words = "1 0.5 20 2 -1 16 0.6 30 10 1 0 2 0 1 -2 0.5"
        done = subprocess.run([BENCH], input=f"memory {words}\nrest {words}\n", capture_output=True, text=True, check=True)
        times = []
        for line, start in zip(done.stdout.splitlines(), ("steady", "rest"), strict=True):
            self.write("pair.toml", SCENE.format(start=start))
            self.expect(0, "rods", "pair.toml", "-o", start)
            outcome = json.loads((self.folder / start / "outcome.json").read_text())
            self.assertEqual((json.loads(line)["ending"], outcome["outcome"]), ("contact", "contact"))
            self.assertAlmostEqual(json.loads(line)["time"], outcome["time"], delta=1e-5)
            times.append(outcome["time"])
        self.assertGreater(times[1], times[0] + 0.1)


class TablesTest(unittest.TestCase):
    def test_one_table_a_start_of_steady_wakes_alone(self):
        rows = [row(start, (kappa, 0, 0), alpha) for start in tool.STARTS for alpha in (0.1, 3) for kappa in (1, 10)]
        text = "\n".join(tool.map_tables(rows))
        self.assertEqual([line for line in text.splitlines() if line.startswith("Steady wakes")],
                         [f"Steady wakes, {start}:" for start in tool.STARTS])
        self.assertEqual(text.count("| 0.1 | +1.2 %, 0.01 | +1.2 %, 0.1 |"), len(tool.STARTS))

    def test_polar_rods_and_those_that_turn_away_have_tables_of_their_own(self):
        polar = [row("abreast", couplings, alpha) for alpha in (0.1, 1) for couplings in tool.POLAR]
        away = [row("crossing, dx = 0", (-100, 0, 0), 10, steady="contact", memory="undecided")]
        text = "\n".join(tool.map_tables([*away, *polar]))
        self.assertIn("| start | alpha | gamma1 = 10, gamma2 = 10 | gamma1 = 10, gamma2 = -10 |", text)
        self.assertIn("| abreast | 1 | +1.2 %, 0 | +1.2 %, 0 | +1.2 %, 0 | +1.2 %, 0 |", text)
        self.assertIn("| alpha | crossing, dx = 0 |\n|---|---|\n| 10 | **contact, not undecided** |", text)

    def test_a_rest_table_has_the_time_that_a_wake_takes(self):
        lines = tool.rest_tables([row("abreast", alpha=3), row("crossing, dx = 1", alpha=10)])
        self.assertIn("| 3 | 19 | +1.2 %, 0.01 |", lines)  # 3 5^2/4
        self.assertIn("| 10 | 65 | +1.2 %, 0.01 |", lines)  # 10 (1 + 5^2)/4

    def test_the_summary_counts_every_encounter_once(self):
        rows = [row(number=number) for number in (0.0, 0.03, 0.05, 0.2, 0.5, 2.0, 200.0)]
        counts = [int(line.split("|")[2]) for line in tool.summary(rows)[3:]]
        self.assertEqual(counts, [1, 2, 1, 1, 1, 1])

    def test_a_run_that_failed_is_not_near(self):
        """It stopped before it could go astray, so that its headings differ little."""
        memory, steady, failed = run("undecided", (0, 0, 0.5, 0.5)), run("undecided", (0, 0, 0.3, 0.3)), run("failed", (0, 0))
        self.assertAlmostEqual(tool.heading_difference(steady, memory), 0.2)
        self.assertTrue(math.isnan(tool.heading_difference(failed, memory)))
        rows = [row(), row(first_order="failed", first_order_heading=math.nan), row(first_order_heading=0.005)]
        cells = [cell.strip() for cell in tool.summary(rows)[3].split("|")]
        self.assertEqual(cells[2:5], ["3", "3", "2"])
        self.assertEqual(cells[6:9], ["0.01 (0.01)", "0.0075 (0.01)", "1"])


class FigureTest(unittest.TestCase):
    def test_every_start_has_its_panel(self):
        rows = [row(start, (kappa, 0, 0), alpha) for start in tool.STARTS for alpha in (1, 10) for kappa in (1, 3)]
        maps = tool.panels_of([*rows, row("abreast", (0, 10, 10))], "") | tool.panels_of(rows[:4], "from rest: ")
        self.assertEqual(list(maps), [*tool.STARTS, "from rest: abreast"])
        self.assertEqual([len(panel) for panel in maps.values()], [4] * 6)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "map.png"
            for some in (maps, {"abreast": rows[:4]}):
                tool.draw_maps(some, path)
                with Image.open(path) as image:
                    colours = len(image.convert("RGB").getcolors(1 << 24))
                self.assertGreater(colours, 100)  # of the bar


if __name__ == "__main__":
    unittest.main()
