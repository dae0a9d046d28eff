"""Input that cannot be used and output that cannot be written: a clear error, and nothing half-written."""

import resource
import signal
import subprocess

import rodwake
from rodwake import PAIR, THEORY_PAIR, ProgramTest, snapshot


class BadInputTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("pair.toml", PAIR)

    def test_values_out_of_range(self):
        for verb in ("check", "rods", "run"):
            self.refuse(2, r"medium\.alpha = -1: must be", verb, "pair.toml", "-s", "medium.alpha=-1")

    def test_rods_in_one_place_without_a_contact_distance(self):
        self.refuse(2, r"rods\[0\].* and rods\[1\].* start at the same point", "rods", "pair.toml", "-s", "rods_run.contact_distance=",
                    "-s", "rods.1.position.1=2.5")

    def test_a_stage_the_scene_does_not_have(self):
        self.refuse(2, r"no \[field\] table", "field", "pair.toml")
        self.refuse(2, r"no \[field\] table", "field", "pair.toml", "--dry-run")
        self.refuse(2, r"no \[rods_run\] table", "rods", rodwake.SCENES / "ufield.toml")


class UnwritableTest(ProgramTest):
    """A path below a file is unwritable for everybody, also for root."""

    def setUp(self):
        super().setUp()
        self.write("pair.toml", PAIR)
        self.write("file", "content")

    def test_output_folder(self):
        self.refuse(2, "file: is a file", "rods", "pair.toml", "-o", "file")
        self.refuse(1, "file/out: cannot make the folder: Not a directory", "rods", "pair.toml", "-o", "file/out")
        self.refuse(1, "cannot make the folder", "run", "pair.toml", "-o", "/proc/rodwake")

    def test_default_output_folder(self):
        self.write("results", "a file")
        self.refuse(1, "results/pair: cannot make the folder", "rods", "pair.toml")

    def test_json_log(self):
        self.expect(1, "rods", "pair.toml", "-o", "out", "--log-json", "file/log")
        self.assertFalse((self.folder / "out").exists())  # nothing was begun
        self.expect(0, "rods", "pair.toml", "-o", "out")

    def test_standard_output(self):
        self.write("points.csv", "x,y,xi,eta\n1,2,3,4\n")
        for arguments in (["info"], ["check", "pair.toml"], ["field", "--points", "points.csv"], ["info", "--scene-reference"]):
            with open("/dev/full", "w") as full:
                done = self.run_with_stdout(full, *arguments)
            self.assertEqual(done.returncode, 1, arguments)
            self.assertRegex(done.stderr, "rodwake: .*(cannot write|No space left)", arguments)

    def run_with_stdout(self, stdout, *arguments):
        return subprocess.run([rodwake.PROGRAM, *arguments], cwd=self.folder, stdout=stdout, stderr=subprocess.PIPE, text=True)

    def test_a_full_disk(self):
        """A limit on the size of files stands for it: writing beyond fails as on a full disk."""
        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
        done = self.expect(1, "field", THEORY_PAIR, "-o", "out", preexec_fn=limit)
        self.assertRegex(done.stderr, "rodwake: .*(HDF5|cannot write)")
        self.assertEqual(self.status("out"), "failed")
        self.assertNotIn("result.h5", snapshot(self.folder / "out"))
        self.assert_no_temporaries()
        self.assertRegex((self.folder / "out/log.txt").read_text(), "error: .*(HDF5|cannot write)")
        self.expect(0, "field", THEORY_PAIR, "-o", "out")

    def test_a_result_that_cannot_be_replaced(self):
        self.expect(0, "rods", "pair.toml", "-o", "out")
        (self.folder / "out/rods.csv").unlink()
        self.write("out/rods.csv/in_the_way", "")
        done = self.expect(1, "rods", "pair.toml", "-o", "out", "--force")
        self.assertRegex(done.stderr, "out/rods.csv: cannot rename")
        self.assertEqual(self.status("out"), "failed")
        self.assert_no_temporaries()
        self.assertNotIn("result.h5", snapshot(self.folder / "out"))


if __name__ == "__main__":
    rodwake.main()
