"""studies/validate_extremes.py: the quick cells end well, and bad cells are seen."""

import csv
import json
import os
import subprocess
import sys

import rodwake
from rodwake import PROGRAM, SOURCE, ProgramTest

sys.path.insert(0, str(SOURCE / "studies"))
from extremes.cells import Lab, not_finite

TOOL = SOURCE / "studies" / "validate_extremes.py"


class ExtremesTest(ProgramTest):
    def stub(self, text):
        """A program that does something else."""
        path = self.write("stub", "#!/bin/sh\n" + text)
        path.chmod(0o755)
        return path

    def tool(self, program, *arguments):
        return subprocess.run([sys.executable, TOOL, "--program", program, "--quick", "--keep", self.folder / "out", *arguments],
                              text=True, capture_output=True, timeout=300, env=os.environ, check=False)

    def record(self):
        return json.loads((self.folder / "out" / "extremes.json").read_text())

    def test_quick_cells(self):
        done = self.tool(PROGRAM, "--seed", "2")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        record = self.record()
        self.assertEqual((record["bad"], record["seed"], record["quick"]), (0, 2, True))
        self.assertGreater(record["cells"], 400)
        with open(self.folder / "out" / "cells.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), record["cells"])
        self.assertEqual([row for row in rows if "unnamed" in row["status"] or row["verdict"] == "bad"], [])
        for group in ("field: anywhere", "pairs, extremes: batch", "rods: one rod", "beds: frequency", "fits: few points"):
            self.assertIn(group, record["groups"])
        again = self.tool(self.stub("exit 9\n"), "--seed", "2") # goes on where all is done: runs nothing
        self.assertEqual((again.returncode, self.record()["cells"]), (0, record["cells"]))

    def test_a_nan_is_bad(self):
        names = "Ux,Uy,exx,exy,eyy,lapx,lapy,gradx_tr,grady_tr,dipUx,dipUy"
        stub = self.stub(f"cat > /dev/null; echo {names}; for i in $(seq 20); do echo 1,1,1,1,1,nan,1,1,1,1,1; done\n")
        self.assert_bad(stub, "not finite", "field")

    def test_an_end_without_a_name_is_bad(self):
        self.assert_bad(self.stub("echo 'Segmentation fault' >&2; exit 139\n"), "unnamed", "fits,beds")

    def assert_bad(self, program, status, only):
        done = self.tool(program, "--only", only)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn(f": {status}", done.stderr)
        self.assertGreater(self.record()["bad"], 0)

    def test_a_time_exceeded_is_bad(self):
        lab = Lab(self.stub("exec sleep 60\n"), self.folder / "lab", 1, True)
        self.assertEqual(lab.run("rods", limit=0.2).refused(), ("timeout", "bad"))

    def test_names_of_failures(self):
        for code, text, expected in [
                (2, "rodwake: a.toml:3:1: medium.eta = -2: must be", ("refused", "reported")),
                (1, "rods: integration stopped at t=1 of 2 (CV_ERR_FAILURE, step 1e-9", ("CV_ERR_FAILURE", "reported")),
                (1, "rods: integration stopped at t=1 of 2 (COLLISION, step 1e-9", ("COLLISION", "reported"))]:
            lab = Lab(self.stub(f"echo '{text}' >&2; exit {code}\n"), self.folder / "lab", 1, True)
            self.assertEqual(lab.run("rods", limit=10).refused(), expected)

    def test_what_is_not_finite(self):
        for text in ("t,x\n0,nan\n", '{"time": NaN}', "1,-inf,2", "Infinity"):
            self.assertIsNotNone(not_finite(text), text)
        for text in ("information,finance", '{"runs": null}', "1e-300,0"):
            self.assertIsNone(not_finite(text), text)


if __name__ == "__main__":
    rodwake.main()
