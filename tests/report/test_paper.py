"""studies/paper: its verdicts, its list of rows, what it runs again and what not, and its page with made-up rows."""

import contextlib
import io
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import tomllib
import unittest
import unittest.mock
from math import isfinite, nan
from pathlib import Path

import browser
import numpy as np
import rodwake
from PIL import Image
from rodwake import SOURCE

sys.path.insert(0, str(SOURCE / "studies"))
from paper_rows import bed, bed_pairs, judge, lab, mechanism, page, subjects, table, theory_pairs  # noqa: E402
from paper_rows.entry import Row, Run, Subject  # noqa: E402
from paper_rows.judge import DIFFERS, MATCHES, UNKNOWN  # noqa: E402

ROWS = [row for subject in subjects.ALL for row in subject.rows]
PROGRAM = """#!/bin/sh
# Stands for rodwake: notes its arguments, and ends as the scene's first comment says.
echo "$*" >> "{calls}"
[ "$1" = plot ] && mkdir -p "$2/figures" && touch "$2/figures/curve.png" && exit 0
scene="$2"
while [ "$1" != -o ]; do shift; done
mkdir -p "$2"
code=$(sed -n 's/^# exit //p' "$scene")
[ "$code" = 0 ] && echo '{{"status": "finished"}}' > "$2/provenance.json"
[ "$code" = 1 ] && echo "no room left" >&2
exit "$code"
"""
CHECK = """# modelled
  bed: 99 runs for 4 runs
# expected cost
  {}
    part or setting                         takes    share
    search for contacts              14 us a step     48 %
"""


class VerdictTest(unittest.TestCase):
    def verdicts(self, rule, cases):
        for arguments, verdict in cases:
            with self.subTest(rule=rule.__name__, arguments=arguments):
                self.assertEqual(rule(*arguments).verdict, verdict)

    def test_a_value_against_a_value(self):
        # value, error, paper's value, its rounding
        self.verdicts(judge.number, [((2.3, 0.1, 2.2, 0.05), MATCHES), ((2.5, 0.1, 2.2, 0.05), UNKNOWN), ((4.1, 0.05, 2.2, 0.05), DIFFERS),
                                     ((2.2, 0.8, 2.2, 0.05), UNKNOWN), ((2.2, nan, 2.2, 0.05), UNKNOWN), ((nan, 0.1, 2.2, 0.05), UNKNOWN), ((9.0, 1.0, 2.2, 0.05), DIFFERS),
                                     ((2.2, 0.0, 2.2, 0.0), MATCHES), ((2.3, 0.0, 2.2, 0.0), DIFFERS), ((-0.5, 0.01, -0.5, 0.05), MATCHES)])

    def test_directions_and_bounds(self):
        self.verdicts(judge.sign, [((-1.9, 0.5, -1), MATCHES), ((-0.9, 0.5, -1), UNKNOWN), ((1.4, 0.5, -1), UNKNOWN), ((1.6, 0.5, -1), DIFFERS),
                                   ((-1.9, nan, -1), UNKNOWN), ((nan, 0.1, -1), UNKNOWN),
                                   ((0.0, 0.0, 1), UNKNOWN), ((0.0, 0.1, 1), UNKNOWN)])
        self.assertEqual(judge.sign(-1.9, nan, -1).difference, "")
        self.verdicts(judge.at_most, [((1.0, 0.1, 1.3), MATCHES), ((1.2, 0.1, 1.3), UNKNOWN), ((1.7, 0.1, 1.3), DIFFERS)])
        self.verdicts(judge.at_least, [((1.0, 0.1, 0.7), MATCHES), ((0.8, 0.1, 0.7), UNKNOWN), ((0.3, 0.1, 0.7), DIFFERS)])
        self.verdicts(judge.between, [((1.0, 0.05, 0.8, 1.2), MATCHES), ((1.15, 0.05, 0.8, 1.2), UNKNOWN), ((0.5, 0.05, 0.8, 1.2), DIFFERS)])

    def test_a_place_between_two(self):
        self.verdicts(judge.bracket, [((0.74, 0.75, 0.74, 0.75), MATCHES), ((0.70, 0.76, 0.74, 0.75), UNKNOWN), ((0.70, 0.74, 0.74, 0.75), UNKNOWN),
                                      ((0.70, 0.72, 0.74, 0.75), DIFFERS), ((0.76, 0.78, 0.74, 0.75), DIFFERS), ((nan, nan, 0.74, 0.75), UNKNOWN)])
        self.assertEqual(bed.crossing({0.70: 0.1, 0.72: 0.4, 0.74: 0.6}, 0.3), (0.70, 0.72))

    def test_a_mean_needs_every_error(self):
        self.assertEqual(judge.weighted((1.0, 2.0), (0.5, 0.5)), (1.5, 0.125**0.5))
        for errors in ((0.5, nan), (0.5, 0.0), (0.5, float("inf"))):
            self.assertFalse(any(map(isfinite, judge.weighted((1.0, 2.0), errors))), errors)

    def test_all_starts_need_starts_that_were_solved(self):
        yes, no, failed = ((100.0, k, theory_pairs.captures({"outcome": outcome, "status": status}))
                           for k, (outcome, status) in enumerate((("pursuit", "ok"), ("undecided", "ok"), ("", "failed"))))
        self.verdicts(theory_pairs.every, [(([], True), UNKNOWN), (([yes, yes], True), MATCHES), (([yes, no], True), DIFFERS), (([no], False), MATCHES),
                                           (([yes, failed], True), UNKNOWN), (([no, failed], False), UNKNOWN), (([yes, no, failed], True), DIFFERS)])

    def test_no_effect_needs_a_small_error_too(self):
        self.verdicts(judge.none, [((0.1, 0.1, 1.0), MATCHES), ((-0.1, 0.1, 1.0), MATCHES), ((0.1, 0.9, 1.0), UNKNOWN), ((-2.0, 0.2, 1.0), DIFFERS)])

    def test_parts_of_a_statement(self):
        yes, no, open_ = (judge.Judged(verdict, verdict) for verdict in judge.VERDICTS)
        self.assertEqual([judge.together(*parts).verdict for parts in ((yes, yes), (yes, open_), (open_, no))], [MATCHES, UNKNOWN, DIFFERS])

    def test_numbers_are_printed_to_their_error(self):
        self.assertEqual(judge.with_error(-1.898, 0.4711, "a"), "-1.90 ± 0.47 a")
        self.assertEqual(judge.with_error(812.3, 35.1), "812 ± 35")
        self.assertIn("unknown", judge.with_error(1.0, nan))


class RowsTest(unittest.TestCase):
    def test_every_figure_and_film_of_the_paper_has_a_row(self):
        places = " ".join(row.place for row in ROWS)
        for number in range(1, 13):
            self.assertIn(f"Fig. {number} ", places)
        for number in range(1, 11):
            self.assertRegex(places, rf"Movie S{number}\b")

    def test_every_row_belongs_to_one_claim(self):
        """What is not counted (inputs, films) repeats no verdict in the table."""
        names = [name for _, names in subjects.CLAIMS for name in names.split()]
        self.assertEqual(sorted(names), sorted(subjects.ROWS))
        self.assertEqual([row.id for row in ROWS if not row.counted], ["apparatus", *(f"S{number}" for number in range(1, 11))])

    def test_the_page_of_the_docs_has_these_rows(self):
        """docs/paper.md has the table as it was made; its first three columns are those of the rows here."""
        text = (SOURCE / "docs/paper.md").read_text(encoding="utf-8")
        there = re.findall(r"(?m)^\| (\w+)(?: \([qf]\))? \| (.*?) \| (.*?) \| .*\*\*(?:matches|differs|inconclusive)\*\*", text.replace("\\|", "¦"))
        rows = [(row.id, row.place, table.lengths(row.says.replace("|", "¦"))) for row in ROWS if row.counted]
        self.assertEqual(there, rows)

    def test_rows_name_what_there_is(self):
        self.assertEqual(len({row.id for row in ROWS}), len(ROWS))
        one = lab.Lab("rodwake", "unused", 1, True)
        for row in ROWS:
            named = {figure["name"] for run in row.runs for figure in tomllib.loads(one.scene(run).read_text())["figures"]}
            self.assertLessEqual(set(row.figures), named, row.id)

    def test_a_name_stands_for_one_run(self):
        runs = [run for row in ROWS for run in row.runs]
        self.assertEqual(len({run.name for run in runs}), len(set(runs)))


class DensityTest(unittest.TestCase):
    def test_separations_of_a_scan(self):
        """Both distances at the start are pooled, and the sign changes between the last sure density and the next."""
        points = [(0.70, 18, 2.0), (0.70, 24, 1.0), (0.74, 18, 0.1), (0.74, 24, -0.1), (0.78, 18, -2.0), (0.78, 24, -1.0), (0.78, 15, 9.0)]
        lines = [f"{phi},{distance * bed_pairs.A!r},{change},0.2" for phi, distance, change in points]
        with tempfile.TemporaryDirectory(prefix="rodwake-paper-") as name:
            folder = Path(name)
            (folder / "scan.csv").write_text("\n".join(["granular.phi_b,granular.rods.0.position.1,delta_y,delta_y_error", *lines]))
            self.assertAlmostEqual(bed_pairs.pooled(folder, lambda phi: phi < 0.72)[0], 1.5)
            self.assertEqual([rule(folder).verdict for rule in (bed_pairs.avoid, bed_pairs.attract, bed_pairs.weakens)], [MATCHES, MATCHES, UNKNOWN])
            changed = bed_pairs.sign_change(folder)
            self.assertEqual((changed.verdict, changed.ours), (UNKNOWN, "between 0.7 and 0.78"))


class MechanismTest(unittest.TestCase):
    def verdict(self, judged, *aic, misfit=0.4):
        """With these AIC of strain, rows, rows_strain in both directions; of fewer runs there are others."""
        head = "phi,rows,medium,runs,model,aic,misfit,couplings,values,errors"
        lines = [f"0.78,{rows},{medium},{runs},{name},{one - bonus},{misfit},gamma_rows kappa,0.01 2.0,0.01 0.5" for rows in (0, 90)
                 for medium, runs, bonus in (("medium", 50, 0), ("medium", 25, 1000), ("line", 50, 1000))
                 for name, one in zip(("strain", "rows", "rows_strain"), aic) if name != "rows" or bonus == 0]
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "mechanism.csv"
            file.write_text("\n".join([head, *lines]) + "\n", encoding="utf-8")
            with unittest.mock.patch.object(mechanism, "KEPT", file):
                return judged()

    def test_a_better_law_without_strain_refutes_strain(self):
        for aic, verdict in (((90.0, 95.0, 92.0), MATCHES), ((100.0, 95.0, 104.0), UNKNOWN), ((110.0, 95.0, 106.0), DIFFERS)):
            self.assertEqual(self.verdict(mechanism.strain_turns(0.78), *aic).verdict, verdict, aic)
        self.assertEqual(self.verdict(mechanism.strain_turns(0.70), 1.0, 2.0, 3.0).verdict, UNKNOWN)
        unfit = self.verdict(mechanism.strain_turns(0.78), 110.0, 95.0, 106.0, misfit=1e-4)  # a law that does not fit refutes nothing
        self.assertEqual((unfit.verdict, unfit.ours.count("p = 0.0001")), (UNKNOWN, 2))

    def test_kappa_is_that_beside_the_rows(self):
        found = self.verdict(mechanism.kappa(0.78), 1.0, 2.0, 3.0)
        self.assertEqual(found.verdict, MATCHES)
        self.assertIn("2.00 ± 0.50", found.ours)


class LabCase(unittest.TestCase):
    """A lab whose program is a script, in a fresh folder."""

    def setUp(self):
        self.enterContext(contextlib.redirect_stdout(io.StringIO()))
        folder = tempfile.TemporaryDirectory(prefix="rodwake-paper-")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.calls = self.folder / "calls"
        program = self.folder / "program"
        program.write_text(PROGRAM.format(calls=self.calls))
        program.chmod(0o755)
        self.lab = lab.Lab(program, self.folder / "out", 1, True)

    def run_of(self, code, settings=(), quick=()):
        scene = self.folder / f"scene_{code}.toml"
        scene.write_text(f"# exit {code}\n")
        self.lab.scene = lambda run: scene
        self.lab.command = lambda run, quick, *extra: ["rodwake", "run", str(scene), *self.lab.settings(run, quick), *extra]
        return Run("one", scene.name, settings, quick)


def wait_until(true):
    while not true():
        time.sleep(0.01)


class LabTest(LabCase):
    def test_what_is_done_is_not_done_again(self):
        run = self.run_of(0)
        self.assertEqual(self.lab.open([run, run]), [run])
        self.lab.make(run)
        self.assertEqual(self.lab.open([run]), [])
        self.assertEqual(self.lab.found(run), (self.folder / "out/runs/one", False))
        other = self.run_of(0, ("x=1",))
        self.assertEqual(self.lab.open([other]), [other])
        self.assertIsNone(self.lab.found(other))
        self.lab.make(other)
        self.assertIn("--force", self.calls.read_text().splitlines()[1])

    def test_figures_that_are_missing_are_drawn(self):
        run = self.run_of(0)
        self.lab.scene(run).write_text('# exit 0\n[[figures]]\nname = "curve"\n')
        self.lab.make(run)
        self.assertEqual(self.lab.open([run]), [run])
        self.lab.make(run)
        self.assertEqual(self.lab.open([run]), [])
        self.assertEqual(self.calls.read_text().splitlines()[1].split()[0], "plot")

    def test_a_stopped_run_goes_on(self):
        run = self.run_of(130)
        for _ in range(2):
            with self.assertRaises(SystemExit) as stopped:
                self.lab.make(run)
            self.assertEqual(stopped.exception.code, 130)
        self.assertNotIn("--force", self.calls.read_text().splitlines()[1])
        self.assertEqual(self.lab.open([run]), [run])

    def test_a_full_result_stands_for_the_quick_one(self):
        run = self.run_of(0, quick=("runs=2",))
        self.lab.quick = False
        self.lab.make(run)
        self.lab.quick = True
        self.assertEqual((self.lab.open([run]), self.lab.found(run)[1]), ([], False))

    def test_a_verdict_of_full_results_is_kept(self):
        """For whom has quick ones or none, until the scene or its settings change."""
        file, run = self.folder / "full.csv", self.run_of(0, quick=("runs=2",))
        row = Row("r", "Fig. 1", "says", lambda folder: judge.holds(True, folder.name), (run,))
        subjects = [Subject("all", (row, Row("other", "Fig. 1", "says", lambda: judge.unknown("experiment"))))]
        self.lab.make(run)
        table.keep(self.lab, table.judge_all(self.lab, subjects, {}), file)
        self.assertEqual(table.kept_verdicts(file), {})  # it is a quick one
        self.lab.quick = False
        self.lab.make(run)
        (self.folder / "out/runs/one/provenance.json").write_text('{"status": "finished", "version": "1.2"}')
        table.keep(self.lab, table.judge_all(self.lab, subjects, {}), file)
        kept = table.kept_verdicts(file)
        self.assertEqual((list(kept), kept["r"]["ours"], kept["r"]["version"]), (["r"], "one", "1.2"))

        shutil.rmtree(self.folder / "out/runs/one")
        for there in (True, False):  # the quick run
            (_, (found, other)), = table.judge_all(self.lab, subjects, kept)
            self.assertEqual((found.judged, found.quick, found.kept), (judge.Judged(MATCHES, "one"), False, "1.2"), there)
            self.assertEqual((other.judged.verdict, other.kept), (UNKNOWN, ""))
            self.assertIn("(f)", table.markdown([(subjects[0], [found])]))
            shutil.rmtree(self.folder / "out/runs/one.quick", ignore_errors=True)
        self.lab.scene(run).write_text("# exit 0, and another line\n")
        (_, (found, _)), = table.judge_all(self.lab, subjects, kept)
        self.assertEqual(found.judged.verdict, UNKNOWN)

    def test_a_failed_run_cannot_tell(self):
        run = self.run_of(1)
        self.lab.make(run)
        found = table.judge_row(self.lab, Row("r", "Fig. 1", "says", lambda folder: judge.holds(True, "x"), (run,)))
        self.assertEqual((found.judged.verdict, found.judged.difference), (UNKNOWN, "no room left"))

    def test_what_a_failed_run_leaves_of_other_settings_does_not_count(self):
        self.lab.make(self.run_of(0))
        other = self.run_of(1, ("x=1",))
        self.lab.make(other)
        self.assertIsNone(self.lab.found(other))
        self.lab.make(other)
        self.assertIn("--force", self.calls.read_text().splitlines()[2])

    def test_a_stop_counts_though_the_run_ends_well(self):
        self.addCleanup(signal.signal, signal.SIGINT, signal.signal(signal.SIGINT, signal.default_int_handler))
        begun = self.folder / "begun"
        main = threading.main_thread().ident
        stop = threading.Thread(target=lambda: (wait_until(begun.exists), signal.pthread_kill(main, signal.SIGINT)), daemon=True)
        stop.start()
        script = f"trap 'exit 0' INT; touch {begun}; echo stopped >&2; while :; do sleep 0.02; done"
        self.assertEqual(lab.wait_for(["/bin/sh", "-c", script]), (0, "stopped\n", True))
        stop.join()

    def test_a_judge_that_breaks_cannot_tell(self):
        run = self.run_of(0)
        self.lab.make(run)
        for error in (IndexError, OverflowError, AttributeError, np.linalg.LinAlgError):
            def judged(_, error=error):
                raise error("broken")
            self.assertEqual(table.judge_row(self.lab, Row("r", "Fig. 1", "says", judged, (run,))).judged.verdict, UNKNOWN)

    def test_a_missing_program_is_reported_and_a_page_makes_its_folder(self):
        command = [sys.executable, SOURCE / "studies" / "paper", "-o", self.folder / "new" / "page"]
        done = subprocess.run([*command, "--program", self.folder / "nothing"], capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1))
        self.assertIn("no such program", done.stderr)
        subprocess.run([*command, "--page"], capture_output=True, check=True)
        self.assertTrue((self.folder / "new" / "page" / "paper.html").is_file())

    def test_the_cost_that_check_tells(self):
        for line, seconds in (("granular run: about 45 CPU seconds each, 2.2e+03 for 50 runs", 2200),
                              ("granular run: about 46 CPU seconds each, 1.9e+02 for 4 runs; 2.3e+03 for all 11 beds", 2300),
                              ("scan: 800 runs, about 51 CPU seconds each (the bed as written), 4.2e+04 in all (12 hours)", 42000),
                              ("granular run: about 23 CPU seconds", 23), ("rods: about 2.7 ms each, 11 ms for 4 runs: 47 steps", 0.011),
                              ("output of a run: no frames", None)):
            with self.subTest(line):
                self.assertEqual(lab.expected_seconds(CHECK.format(line)), seconds)


class PageTest(LabCase):
    def made_up(self):
        run = self.run_of(0)
        self.lab.make(run)
        figures = self.folder / "out/runs/one/figures"
        figures.mkdir()
        pictures = [Image.new("RGB", (800, 600), colour) for colour in ("white", "navy")]
        pictures[0].save(figures / "curve.png")
        pictures[0].save(figures / "film.gif", save_all=True, append_images=pictures[1:], duration=100)
        ends = (judge.holds(True, "U_x & |x|^(1/2)"), judge.number(4.0, 0.1, 2.2, 0.05, "a"), judge.unknown("experiment"))
        names = (("curve", "film"), ("curve",), ())
        rows = [Row(f"row{k}", f"Fig. {k}", "says | so", lambda folder, end=end: end, (run,), name, "since") for k, (end, name) in enumerate(zip(ends, names))]
        return table.judge_all(self.lab, [Subject("Made up", tuple(rows))])

    def test_page(self):
        text = page.document(self.lab, self.made_up())
        self.assertEqual(browser.references(text), [])
        for width in (1200, 400):
            seen = browser.look(text, width)
            self.assertEqual((seen["errors"], seen["loaded"], seen["beyond"]), ([], [], []))
            self.assertEqual((seen["figures"], [natural > 0 for _, natural, _ in seen["images"]]), (2, [True, True]))
            self.assertEqual(seen["headings"], ["Made up"])
        self.assertIn("U<sub>x</sub> &amp; |x|<sup>1/2</sup>", text)
        self.assertEqual(page.typeset("U_x(x) of φ_b in row hop_a"), "U<sub>x</sub>(x) of φ<sub>b</sub> in row hop_a")

    def test_a_shared_reason_stands_once(self):
        (subject, rows), = self.made_up()
        lines = table.markdown([(subject, [rows[1], rows[1]])]).splitlines()
        self.assertEqual((lines[0].split(";")[0], lines[-1]), ("0 matches, 2 differs, 0 inconclusive", "(a) since"))
        self.assertTrue(all(line.endswith("**differs** (a) |") for line in lines if line.startswith("| row1")))

    def test_table(self):
        lines = table.markdown(self.made_up()).splitlines()
        self.assertEqual(lines[0].split(";")[0], "1 matches, 1 differs, 1 inconclusive")
        rows = [line for line in lines if line.startswith("| row") and "---" not in line][1:]
        self.assertEqual([row.count(" | ") for row in rows], [5, 5, 5])
        self.assertIn("**differs**. since", rows[1])
        self.assertIn("says \\| so", rows[0])


if __name__ == "__main__":
    rodwake.main()
