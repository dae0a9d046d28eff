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
        for key, value, pattern in [
                ("medium.alpha", "0", r"medium\.alpha = 0: must be"),
                ("medium.alpha", "-1", r"medium\.alpha = -1: must be"),
                ("medium.eta", "-1", r"medium\.eta = -1: must be > -1"),
                ("medium.eta", "nan", "must be a finite number"),
                ("rods.0.heading", "nan", "must be a finite number"),
                ("rods.1.position.0", "inf", "must be a finite number"),
                ("rods_run.t_end", "0", "rods_run.t_end = 0: must be"),
                ("rods_run.t_end", "inf", "must be a finite number")]:
            for verb in ("check", "rods", "run"):
                self.refuse(2, pattern, verb, "pair.toml", "-s", f"{key}={value}")

    def test_rods_in_one_place_without_a_contact_distance(self):
        self.refuse(2, r"rods\[0\].* and rods\[1\].* start at the same point", "rods", "pair.toml", "-s", "rods_run.contact_distance=",
                    "-s", "rods.1.position.1=2.5")

    def test_a_nan_in_the_file_has_a_place(self):
        self.write("nan.toml", PAIR.replace("eta = 1.0", "eta = nan"))
        self.refuse(2, r"nan\.toml:4:\d+: medium\.eta = nan: must be a finite number", "rods", "nan.toml")

    def test_all_errors_at_once(self):
        self.write("bad.toml", PAIR.replace("eta = 1.0", "eta = -2.0").replace("kappa", "kapa").replace("t_end", "tend"))
        done = self.refuse(2, r"bad\.toml:4:\d+: medium\.eta", "rods", "bad.toml")
        self.assertRegex(done.stderr, r'bad\.toml:7:1: \[coupling\] unknown key "kapa" \(did you mean "kappa"\?\)')
        self.assertRegex(done.stderr, r'unknown key "tend" \(did you mean "t_end"\?\)')

    def test_a_typo_in_an_override(self):
        self.refuse(2, r'unknown key "kapa" \(did you mean "kappa"\?\)', "rods", "pair.toml", "-s", "coupling.kapa=1")
        self.refuse(2, "medium", "rods", "pair.toml", "-s", "medim.eta=1")
        self.refuse(2, "-s", "rods", "pair.toml", "-s", "nonsense")

    def test_files_that_cannot_be_read(self):
        self.refuse(2, "nope.toml: no such file", "rods", "nope.toml")
        self.refuse(2, r"\.: ", "rods", ".")
        self.write("empty.toml", "")
        self.refuse(2, r"empty\.toml:", "rods", "empty.toml")
        self.write("text.toml", "this is no TOML\n")
        self.refuse(2, r"text\.toml:1:", "rods", "text.toml")

    def test_a_million_rods(self):
        self.write("million.toml", "schema = 1\n[rods_run]\nt_end = 1.0\n"
                   + "".join(f"[[rods]]\nposition = [{k}, 0]\n" for k in range(10**6)))
        self.refuse(2, "larger than 16 MiB; a scene may have at most 1000 rods", "rods", "million.toml")
        self.write("many.toml", rodwake.crowd(2000))
        self.refuse(2, "rods: 2000 entries; at most 1000", "rods", "many.toml")

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
