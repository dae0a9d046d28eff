"""Surroundings that are against the program: closed streams, limits of the system, links, inputs under the names of results,
damaged files. Nothing is lost without a word, nothing of others is touched, and no end is unseemly."""

import errno
import json
import os
import shutil
import signal
import socket
import subprocess
import unittest

from beds import BED
from fits import FitTest
from rodwake import PAIR, PROGRAM, SOURCE, ProgramTest, snapshot, wait_until
from scans import GRID

PLOTS = SOURCE / "plots/rodwake_plot.py"
SHORT = PAIR.replace("output_interval = 10.0", "output_interval = 1.0").replace("t_end = 60.0", "t_end = 5.0")


class Surroundings(ProgramTest):
    def shell(self, line):
        """The process of a line of bash, in which $RODWAKE is the program."""
        return subprocess.run(["bash", "-c", line], cwd=self.folder, text=True, capture_output=True, timeout=120,
                              env={**os.environ, "RODWAKE": str(PROGRAM)})

    def setUp(self):
        super().setUp()
        self.write("pair.toml", SHORT)


class Streams(Surroundings):
    def test_an_error_keeps_its_exit_code_without_standard_error(self):
        for closed in ("2>&-", "2>/dev/full", "2>&- >&- <&-"):
            self.assertEqual(self.shell(f"$RODWAKE rods nowhere.toml {closed}").returncode, 2, closed)
            self.assertEqual(self.shell(f"$RODWAKE rods pair.toml -o out --force {closed}").returncode, 0, closed)
        self.assertEqual(self.shell("$RODWAKE nonsense 2>/dev/full").returncode, 2)

    def test_no_file_takes_the_place_of_a_closed_stream(self):
        self.assertEqual(self.shell("$RODWAKE rods pair.toml -o out <&- >&- 2>&-").returncode, 0)
        self.assertNotIn(b"rods:", (self.folder / "out/rods.csv").read_bytes())
        self.assertEqual(self.status("out"), "finished")

    def test_figures_are_made_without_streams(self):
        done = self.shell("$RODWAKE run pair.toml -o out <&- >&- 2>&-")
        self.assertEqual(done.returncode, 0)
        self.assertTrue((self.folder / "out/report.html").exists())

    def test_a_full_standard_output_is_reported(self):
        self.expect(0, "rods", "pair.toml", "-o", "out", "--quiet")
        for verb in ("info --schema", "info", "info --completion bash", "info out", "help", "help kappa", "help run", "--version", "run --help",
                     "scenes", "new", "check pair.toml"):
            done = self.shell(f"$RODWAKE {verb} >/dev/full")
            self.assertEqual(done.returncode, 1, verb)
            self.assertRegex(done.stderr, "standard output|No space left", verb)


@unittest.skipUnless("RODWAKE_FAULTY_SYSTEM" in os.environ, "needs the library of faults")
class Locks(Surroundings):
    """File systems without locks, as NFS and Lustre may be."""

    def without_locks(self, verb, scene, error):
        system = {"LD_PRELOAD": os.environ["RODWAKE_FAULTY_SYSTEM"], "FAULT_IN": "rodwake", "FAULT_UNDER": os.path.realpath(self.folder),
                  "FAULT_CALL": "lock", "FAULT_AT": "-1", "FAULT_ERRNO": str(error)}
        return subprocess.run([PROGRAM, verb, scene, "-o", "out"], cwd=self.folder, text=True, capture_output=True, timeout=60,
                              env={**os.environ, **system})

    def test_work_goes_on_with_a_warning(self):
        self.write("grid.toml", GRID)
        for error in (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP):
            for verb, scene in (("rods", "pair.toml"), ("scan", "grid.toml")):
                done = self.without_locks(verb, scene, error)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertIn(f"cannot lock files ({os.strerror(error)})", done.stderr)
                self.assertFalse((self.folder / "out/rodwake.lock").exists())
                shutil.rmtree(self.folder / "out")

    def test_the_file_is_the_lock(self):
        (self.folder / "out").mkdir()
        gone = subprocess.Popen(["true"])
        gone.wait()
        for process, code, text in ((os.getpid(), 2, "process .* works in this folder.*cannot lock files.*remove"), (gone.pid, 0, "is gone; taking over")):
            self.write("out/rodwake.lock", f"process {process} on host {socket.gethostname()}\n")
            done = self.without_locks("rods", "pair.toml", errno.ENOLCK)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertRegex(done.stderr, text)


class Drawing(Surroundings):
    def test_figures_that_failed_are_reported_where_children_are_ignored(self):
        self.expect(0, "rods", "pair.toml", "-o", "out")
        (self.folder / "out/figures").write_text("in the way\n")
        done = self.shell("trap '' CHLD; $RODWAKE plot out")
        self.assertEqual(done.returncode, 1, done.stderr)

    def test_a_run_killed_while_it_draws_goes_on_with_its_figures(self):
        with self.started("run", "pair.toml", "-o", "out", start_new_session=True) as process:
            drawing = wait_until(lambda: (self.folder / "out/provenance.json").exists() and self.status("out") == "finished", 60)
            self.assertTrue(drawing)
            os.killpg(process.pid, signal.SIGKILL)
        before = (self.folder / "out/rods.csv").stat().st_mtime_ns
        self.assertFalse((self.folder / "out/report.html").exists(), "killed too late")
        self.expect(0, "run", "pair.toml", "-o", "out")
        self.assertTrue((self.folder / "out/report.html").exists())
        self.assertTrue(list((self.folder / "out/figures").glob("*.png")))
        self.assertEqual((self.folder / "out/rods.csv").stat().st_mtime_ns, before, "computed again")
        self.refuse(0, "holds a finished run", "run", "pair.toml", "-o", "out")


class Limits(Surroundings):
    def test_a_file_that_is_too_large_is_reported(self):
        self.write("scan.toml", GRID)
        for verb, scene in (("rods", "pair.toml"), ("scan", "scan.toml")):
            done = self.shell(f"ulimit -f 8; $RODWAKE {verb} {scene} -o {verb}")
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertRegex(done.stderr, "(?i)file too large")
            self.assertEqual(self.shell(f"$RODWAKE {verb} {scene} -o {verb}").returncode, 0, verb)

    def test_fewer_threads_than_asked_for(self):
        done = self.shell("ulimit -v 4000000; $RODWAKE rods pair.toml -o out -j 1000")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stderr, r"only \d+ of 1000 threads can be started")


class SmallStack(FitTest):
    def test_a_fit_on_a_small_stack(self):
        """Of 80 kB, of which the system takes up to 16 for places by chance and the environment."""
        self.make_profile()
        self.write("fit.toml", 'schema = 1\n[fit]\nparameters = ["f_over_mu", "eta"]\nstart = { f_over_mu = 1.5, eta = 2.0 }\n'
                   'fixed = { xi = 22.0 }\n[[fit.profiles]]\nfile = "ux.csv"\n')
        done = subprocess.run(["bash", "-c", f"ulimit -s 80; exec {PROGRAM} fit fit.toml -o out -j 2"], cwd=self.folder, text=True,
                              capture_output=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr)


class Others(Surroundings):
    def test_an_input_is_not_replaced_by_a_result(self):
        self.write("scene.toml", SHORT)
        self.refuse(2, r"scene\.toml: is read by this command", "rods", "scene.toml", "-o", ".", "--force")
        self.write("there/scan.csv", "coupling.kappa\n0.1\n")
        self.write("list.toml", SHORT + '[scan]\ndesign = "list"\nfile = "there/scan.csv"\n')
        self.refuse(2, r"scan\.csv: is read by this command", "scan", "list.toml", "-o", "there", "--force")

    def test_a_run_in_the_folder_of_its_scene(self):
        self.write("mine.toml", SHORT)
        self.expect(0, "rods", "mine.toml", "-o", ".", "--force")
        self.expect(0, "rods", "scene.toml", "-o", ".", "--force")  # of the run itself

    def test_nothing_is_written_through_links(self):
        self.expect(0, "rods", "pair.toml", "-o", "out")
        self.write("elsewhere/precious.txt", "precious")
        for name, target in (("log.txt", "elsewhere/precious.txt"), ("rods.csv", "elsewhere/precious.txt"), ("variants", "elsewhere")):
            shutil.copytree(self.folder / "out", self.folder / "linked")
            (self.folder / "linked" / name).unlink(missing_ok=True)
            (self.folder / "linked" / name).symlink_to(self.folder / target)
            before = snapshot(self.folder / "elsewhere")
            done = self.expect(2, "rods", "pair.toml", "-o", "linked", "--force")
            self.assertRegex(done.stderr, f"{name}: is a link")
            self.assertEqual(snapshot(self.folder / "elsewhere"), before)
            shutil.rmtree(self.folder / "linked")
        (self.folder / "out/figures").symlink_to(self.folder / "elsewhere")
        self.assertRegex(self.expect(1, "plot", "out").stderr, "figures: is a link")
        for verb, name in (("replay", "replay"), ("camera", "camera"), ("tradeoff", "tradeoff_bed")):
            (self.folder / "out" / name).symlink_to(self.folder / "elsewhere")
            arguments = ("bed.toml", "-o", "out", "--limit", "0.1") if verb == "tradeoff" else ("out",)
            self.write("bed.toml", BED)
            self.assertRegex(self.expect(2, verb, *arguments).stderr, f"{name}: is a link")
        self.assertEqual(snapshot(self.folder / "elsewhere"), before)

    def test_a_result_kept_elsewhere_is_read(self):
        self.expect(0, "rods", "pair.toml", "-o", "out")
        shutil.move(self.folder / "out/rods.csv", self.folder / "moved.csv")
        (self.folder / "out/rods.csv").symlink_to(self.folder / "moved.csv")
        self.write("more.toml", SHORT + "[field]\nx = [-5, 3]\ny = [-2, 2]\nnx = 5\nny = 3\n")
        self.expect(0, "field", "more.toml", "-o", "out")
        self.assertTrue((self.folder / "out/rods.csv").is_symlink())

    def test_words_of_files_do_not_reach_the_terminal_as_they_are(self):
        self.write("points.csv", "x,y\n\x1b[31m" + "9" * 5_000_000 + ",1\n")
        done = self.expect(2, "field", "--points", "points.csv")
        self.assertNotIn("\x1b", done.stderr)
        self.assertLess(len(done.stderr), 500)
        self.write("odd.toml", SHORT + '[odd]\n"\\u001b[2J" = 1\n')
        self.assertNotIn("\x1b", self.expect(2, "check", "odd.toml").stderr)


class Damaged(Surroundings):
    def test_info_of_a_changed_byte(self):
        """The library that reads HDF5 crashes on some of these; the program does not."""
        self.expect(0, "rods", "pair.toml", "-o", "out")
        whole = (self.folder / "out/result.h5").read_bytes()
        for place in range(96, len(whole), max(1, len(whole) // 60)):
            spoilt = bytearray(whole)
            spoilt[place] ^= 0xFF
            (self.folder / "spoilt.h5").write_bytes(spoilt)
            done = self.run_program("info", "spoilt.h5", errors="replace")
            self.assertIn(done.returncode, (0, 2), f"byte {place}: {done.stderr}")

    def test_rods_that_cannot_reach_each_other_do_not_pursue(self):
        far = SHORT.replace("[0.0, 2.5]", "[0.0, 0.0]").replace("[0.0, -2.5]", "[-1e12, 0.0]")
        self.write("far.toml", far)
        self.expect(0, "rods", "far.toml", "-o", "far")
        self.assertEqual(json.loads((self.folder / "far/outcome.json").read_text())["outcome"], "undecided")


if __name__ == "__main__":
    unittest.main()
