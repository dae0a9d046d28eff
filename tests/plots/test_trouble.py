"""Figures that cannot be drawn, files that cannot be written, signals, and nobody who listens: /usr/bin/python3 tests/plots/test_trouble.py"""

import contextlib
import errno
import os
import resource
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path
from unittest import mock

import matplotlib.image

from fit_case import FitCase
from made_up_granular import write_granular
from made_up_result import ALL_KINDS, LINE, PATHS
from made_up_scan import KAPPA, METHOD, write_scan
from plot_case import PROGRAM, PlotCase
from rodwake_plots import canvas, draw, field
from test_theory import PlotsTest as Theory

NO_TEX = r"\frac{a"


class TroubleCase(PlotCase):
    build = Theory.build

    def names(self):
        return sorted(path.name for path in (self.folder / "figures").glob("*") if path.name != ".gitignore")

    def page(self):
        return (self.folder / "report.html").read_text()


class NoTexTest(TroubleCase):
    """A text that is no TeX is shown as it stands, and that is said once."""

    def scan(self, **label):
        write_scan(self.folder, design="grid", axes=(KAPPA | label, METHOD | {"values": ["bdf", "$\\a", "$\\frac$"]}), count=5)

    def test_the_label_of_an_axis(self):
        (self.folder / "result.h5").unlink()
        self.scan(label=NO_TEX)
        done = self.plot()
        self.assertEqual((done.returncode, done.stderr.count("\n")), (0, 2), done.stderr)
        self.assertIn(f'coupling.kappa: label = "{NO_TEX}" is not TeX', done.stderr)
        self.assertIn('"$\\frac$" is not TeX', done.stderr)
        self.assertIn("phase_diagram.png", self.names())
        for page in ("report.html", "scan.html"):
            self.assertIn(NO_TEX, (self.folder / page).read_text().replace("\\\\", "\\"), page)

    def test_titles_and_labels_of_runs(self):
        self.build(figures=LINE + f"title = '${NO_TEX}$'\n" + PATHS, variants=1)
        self.edit(lambda file: file["rods/variant0"].attrs.update(label=r"$\nothing{$, run $x$"))
        done = self.plot()
        self.assertEqual((done.returncode, done.stderr.count("is not TeX"), done.stderr.count("\n")), (0, 2, 2), done.stderr)
        self.assertEqual(self.names(), ["line.png", "paths.png"])

    def test_a_text_that_nobody_looked_at(self):
        made = canvas.figure(4, 3)
        axes = made.subplots()
        axes.set(xlabel=f"${NO_TEX}$", title=f"two\nlines ${NO_TEX}$")
        axes.plot([0, 1], label=f"${NO_TEX}$")
        axes.legend()
        with contextlib.redirect_stderr(None):
            canvas.save(made, self.folder / "a.png")
        self.assertGreater(matplotlib.image.imread(self.folder / "a.png")[..., :3].var(), 0.005)

    edit = Theory.edit


def broken(what, why):
    """Drawing cuts, telling of them or finding them fails."""
    return mock.patch.dict(draw.KINDS, cut=draw.KINDS["cut"]._replace(**{what: mock.Mock(side_effect=ValueError(why))}))


class FailureTest(TroubleCase):
    """A figure that fails takes neither the others nor the report with it."""

    def test_the_report_says_why(self):
        self.build(figures=LINE + PATHS)
        for what, expected in (("draw", "Not shown: internal error: ValueError: no &lt;luck&gt;"), ("caption", "no &lt;luck&gt;")):
            with broken(what, "no <luck>"):
                done = self.plot()
            self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
            self.assertIn('figure "line": internal error: ValueError: no <luck>', done.stderr)
            self.assertNotIn("paths", done.stderr)
            self.assertIn("paths.png", self.names())
            self.assertIn(expected, self.page())
            self.assertIn('<img alt="paths"', self.page())

    def test_a_picture_from_before_is_not_taken_for_it(self):
        self.build(figures=LINE + PATHS)
        self.assertEqual(self.plot().returncode, 0)
        with broken("draw", "no luck"):
            self.assertEqual(self.plot().returncode, 1)
        self.assertNotIn('<img alt="line"', self.page())
        (self.folder / "figures/line.png").unlink()
        done = self.plot("--report-only")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r'figure "line": .*line\.png: not drawn yet')
        self.assertIn("not drawn yet", self.page())

    def test_a_section_that_cannot_be_made(self):
        self.build(figures=LINE)
        (self.folder / "outcome.json").write_text('{"solver": 3}')
        done = self.plot()
        self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
        self.assertIn("Solver of the report: internal error", done.stderr)
        self.assertIn("line.png", self.page())

    def test_what_there_is_cannot_be_made(self):
        self.build(figures="")
        with broken("defaults", "no luck"):
            self.assertEqual([one.kind for one in self.figures()].count("cut"), 1)

    def figures(self):
        from rodwake_plots import run_dir
        with run_dir.RunDir(self.folder) as run:
            return draw.figures_of(run)


class NameTest(FitCase):
    def test_a_parameter_does_not_lead_out_of_the_folder(self):
        """Its name becomes that of a file."""
        name, one = f"x/../../{'out' * 100}", next(iter(self.record["parameters"].values()))
        self.rewrite(parameters=self.record["parameters"] | {name: one}, likelihood={name: next(iter(self.record["likelihood"].values()))})
        self.ask()
        self.assertEqual(self.plot().returncode, 0)
        self.assertRegex(" ".join(path.name for path in (self.folder / "figures").iterdir()), r"fit_likelihood_x_\.\._\.\._out\w+\.png")
        self.assertEqual({path.parent for path in self.folder.rglob("*.png")}, {self.folder / "figures"})


class WriteTest(TroubleCase):
    def test_a_disk_that_breaks(self):
        """The files of before stay, nothing is left half written."""
        self.build(figures=LINE)
        self.assertEqual(self.plot().returncode, 0)
        before = {path: path.read_bytes() for path in self.folder.rglob("*.*")}
        with mock.patch("os.fsync", side_effect=OSError(errno.EIO, os.strerror(errno.EIO))):
            done = self.plot()
        self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
        for name in ("line.png", "report.html"):
            self.assertIn(f"{name}: cannot be written: Input/output error", done.stderr)
        self.assertEqual({path: path.read_bytes() for path in self.folder.rglob("*.*")}, before)

    def test_files_that_become_too_large(self):
        """As on a full disk: the limit is met while a file is written."""
        self.build(figures=LINE + PATHS)
        done = subprocess.run([sys.executable, PROGRAM, self.folder], capture_output=True, text=True,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (9000, 9000)))
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        for name in ("line.png", "paths.png", "report.html"):
            self.assertRegex(done.stderr, rf"{name}: cannot be written: File too large")
        self.assertEqual((self.names(), list(self.folder.glob("*.html"))), ([], []))

    def test_no_place_for_figures(self):
        self.build(figures=LINE)
        (self.folder / "figures").write_text("a file")
        self.assert_fails('figure "line":', "line.png: cannot be written")
        self.assertIn("cannot be written", self.page())


class SignalTest(TroubleCase):
    def stopped(self, number, when, times=1, **how):
        """The program, ended by the signal once `when(process)` is true: one line, no traceback, nothing half done."""
        with subprocess.Popen([sys.executable, PROGRAM, self.folder], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **how) as program:
            end = time.monotonic() + 60
            while not when(program) and time.monotonic() < end:
                time.sleep(0.005)
            for _ in range(times):
                program.send_signal(number)
            _, output = program.communicate(timeout=30)
        self.assertEqual((program.returncode, output.count("\n")), (128 + number, 1), output)
        self.assertIn("stopped by a signal", output)
        self.assertEqual([path for path in self.folder.rglob("*") if ".tmp" in path.name], [])

    def takes_signals(self, program):
        """From early on: most of the packages are not imported yet."""
        with contextlib.suppress(OSError):
            status = Path(f"/proc/{program.pid}/status").read_text()
            return int(status.split("SigCgt:")[1].split()[0], 16) >> (signal.SIGTERM - 1) & 1
        return False

    def works(self, pid):
        try:
            return "State:\tZ" not in Path(f"/proc/{pid}/status").read_text()
        except OSError:
            return False

    def test_at_the_start(self):
        self.stopped(signal.SIGINT, self.takes_signals)
        self.stopped(signal.SIGTERM, self.takes_signals, times=50)

    def test_while_figures_are_drawn(self):
        self.build(figures=ALL_KINDS)
        for number in (signal.SIGINT, signal.SIGTERM):
            self.stopped(number, lambda program: program.stdout.readline())
        for name in self.names():
            self.assert_picture(matplotlib.image.imread(self.folder / "figures" / name))

    def test_while_a_film_is_made(self):
        """ffmpeg does not go on alone."""
        write_granular(self.folder, rods=1, frames=4, figures='[[figures]]\nname = "film"\nkind = "movie"\n', columns=14, rows=16)
        (self.folder / "result.h5").unlink()
        program = self.folder / "bin/ffmpeg"
        program.parent.mkdir()
        program.write_text(f'#!/bin/sh\nfor last; do :; done\necho film > "$last"\necho $$ > {self.folder}/ffmpeg.pid\nexec sleep 60\n')
        program.chmod(0o755)
        pid = self.folder / "ffmpeg.pid"
        self.stopped(signal.SIGTERM, lambda _: pid.is_file() and pid.read_text().endswith("\n"),
                     env={**os.environ, "PATH": f"{program.parent}:{os.environ['PATH']}"})
        until = time.monotonic() + 10.0  # it has its signal, but whoever collects orphans may take a moment
        while self.works(pid.read_text().strip()):
            self.assertLess(time.monotonic(), until, "ffmpeg goes on")
            time.sleep(0.01)
        self.assertEqual(self.names(), [])


class NobodyListensTest(TroubleCase):
    """Closed or full standard streams change neither the files nor the exit code."""

    def assert_report(self, code, *redirections):
        for redirection in redirections:
            done = subprocess.run(["bash", "-c", f'"$0" "$1" "$2" {redirection}', sys.executable, PROGRAM, self.folder], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stdout, done.stderr), (code, "", ""), redirection)

    def test_all_is_drawn(self):
        self.build(figures=LINE + '[[figures]]\nname = "lone"\nkind = "fit"\n')  # left out, which is reported
        for redirection in (">/dev/full 2>/dev/full", ">&- 2>&-"):
            self.assert_report(0, redirection)
            self.assertEqual(self.names(), ["line.png"])
            self.assert_picture(matplotlib.image.imread(self.folder / "figures/line.png"))
            self.assertTrue(self.page().endswith("</html>\n"))
            (self.folder / "report.html").unlink()

    def test_an_error_is_one_all_the_same(self):
        (self.folder / "scene.toml").unlink()
        self.assert_report(1, "2>/dev/full", "2>&-", ">&- 2>&- <&-")


del Theory  # its tests run in their own file

if __name__ == "__main__":
    unittest.main()
