"""rodwake scan: scenes that cannot be scanned, what check says of those that can, and info on a scan."""


import rodwake
from scans import CROSSING, ScanTest, axis


class BadScanTest(ScanTest):
    """Refused with exit code 2 before a file is written; `rodwake check` says the same."""

    def refused(self, pattern, lines, *arguments):
        self.write("bad.toml", CROSSING + "[scan]\n" + lines)
        self.refuse_scan(pattern, "bad.toml", "out", *arguments)
        self.refuse(2, pattern, "check", "bad.toml", *arguments)

    def test_axes_that_are_empty(self):
        self.refused(r"bad.toml:\d+:\d+: \[scan\] has no axes", "")
        self.refused("from and to are both 2: the axis is empty", axis("coupling.kappa", 2.0, 2.0, 5))
        self.refused("the axis is empty", axis("rods.1.heading", '"90 deg"', '"90 deg"', 5))
        self.refused("expected 1 to 1000000 numbers, quantities or words, found 0", '[[scan.axes]]\nkey = "coupling.kappa"\nvalues = []\n')
        self.refused("count = 0: must be >= 1", axis("coupling.kappa", 1.0, 2.0, 0))

    def test_keys_that_are_none(self):
        self.refused(r"scan axis coupling.kapa: .*did you mean \"kappa\"\?", axis("coupling.kapa", 1.0, 2.0, 5))
        self.refused("scan axis rods.2.heading: no entry 2: rods has 2", axis("rods.2.heading", 1.0, 2.0, 5))
        self.refused("scan axis noise.rotational_diffusion: the scene has no \\[noise\\]", axis("noise.rotational_diffusion", 0.0, 1.0, 5))
        self.refused("scan.resolution is not what a scan can vary", axis("scan.resolution", 2, 4, 5))
        self.refused("coupling.kappa is set twice", axis("coupling.kappa", 1.0, 2.0, 5) * 2)

    def test_values_that_are_none(self):
        self.refused("scan axis medium.alpha: medium.alpha = -1.0: must be >= ", axis("medium.alpha", -1.0, 1.0, 5))
        self.refused("scan axis medium.alpha: medium.alpha = -1.0: must be >= ",
                     axis("coupling.kappa", 1.0, 2.0, 5) + axis("medium.alpha", -1.0, 1.0, 5))
        self.refused('spacing "log" needs ends of one sign, found -1 and 1', axis("coupling.kappa", -1.0, 1.0, 5, "log"))
        self.refused('spacing "log" needs ends of one sign, found 0 and 1', axis("coupling.kappa", 0.0, 1.0, 5, "log"))
        self.refused("must be a finite number", axis("coupling.kappa", "nan", 1.0, 5))
        self.refused("scan axis rods_run.max_steps: 1000.5 is not a whole number", axis("rods_run.max_steps", 1000.5, 2000, 5))
        self.refused("scan axis rods_run.method: ", '[[scan.axes]]\nkey = "rods_run.method"\nvalues = ["euler"]\n')

    def test_points_beyond_the_limit(self):
        two = axis("coupling.kappa", 1.0, 2.0, 100_000) + axis("rods.1.heading", 0.0, 1.0, 10_000)
        self.refused(r"the scan has 1000000000 points, more than scan.max_points = 20000000; .* these take 5.6 to 56 CPU hours", two)
        self.refused("the scan has 25 points, more than scan.max_points = 10",
                     "max_points = 10\n" + axis("coupling.kappa", 1.0, 2.0, 5) + axis("rods.1.heading", 0.0, 1.0, 5))
        start = ('design = "adaptive"\nresolution = 65536\n' + axis("coupling.kappa", 1.0, 2.0, 32768)
                 + axis("rods.1.heading", 0.0, 1.0, 32768))
        self.refused("the scan has 1073807361 points at the start, more than scan.max_points", start)

    def test_files_of_lists(self):
        lines = 'design = "list"\nfile = "points.csv"\n'
        self.refused('scan.file = "points.csv": no such file', lines)
        for text, pattern in (("coupling.kapa\n1\n", 'did you mean "kappa"'), ("coupling.kappa\n", "the scan has no points"),
                              ("coupling.kappa\n1\nx\n", r"points.csv:3"), ("coupling.kappa,medium.eta\n1\n", r"points.csv:2"),
                              ("coupling.kappa\nnan\n", "points.csv:2|not a finite number"), ("", "points.csv|no points"),
                              ("coupling.kappa,coupling.kappa\n1,2\n", "twice"), ("medium.alpha\n1\n-1\n", "scan axis medium.alpha")):
            self.write("points.csv", text)
            with self.subTest(text):
                self.refused(pattern, lines)

    def test_scenes_without_a_scan(self):
        self.write("none.toml", CROSSING)
        self.refuse_scan(r"no \[scan\] table, so there is nothing to scan", "none.toml", "out")
        self.refuse_scan(r"unknown key \"resolutoin\" \(did you mean \"resolution\"", "scan.toml", "out", "-s", "scan.resolutoin=5")

    def test_folders_of_something_else(self):
        self.write("notes/thesis.tex", "text")
        self.refuse_scan("notes: holds files that are not a rodwake run", "grid.toml", "notes")
        self.write("file", "text")
        self.refuse_scan("file: is a file", "grid.toml", "file")


class CheckTest(ScanTest):
    def test_a_scan_is_described_with_its_cost(self):
        output = self.expect(0, "check", "scan.toml").stdout
        self.assertRegex(output, r"scan: coupling.kappa from 0.1 to 100, .* refined to 32 cells a side")
        self.assertRegex(output, r"scan: .* a point, 1.7e\+03 points if one boundary crosses it, about .* CPU seconds")
        self.assertRegex(self.expect(0, "check", "grid.toml").stdout, r"scan: .* a point, 81 points")
        self.assertIn('[[scan.axes]]\nkey = "coupling.kappa"', output)

    def test_dry_run(self):
        done = self.expect(0, "scan", "scan.toml", "-o", "out", "--dry-run")
        self.assertIn("refined to 32 cells a side", done.stdout)
        self.assertFalse((self.folder / "out").exists())


class InfoTest(ScanTest):
    def test_a_finished_scan(self):
        self.scan("grid.toml", "out", "--quiet")
        output = self.expect(0, "info", "out").stdout
        for part in ("out: finished run", "points.log", '"requested": 81', '"evaluated": 81', '"failed": 0', '"left": 0'):
            self.assertIn(part, output)

    def test_a_scan_that_was_killed(self):
        with self.started("scan", "scan.toml", "-o", "out", "-s", "scan.resolution=4096", "--quiet") as process:
            self.assertTrue(rodwake.wait_until(lambda: self.points("out") > 100, 60))
            process.kill()
            process.wait()
        output = self.expect(0, "info", "out").stdout
        self.assertIn("out: unfinished run", output)
        self.assertRegex(output, r"[1-9]\d+ points evaluated, 0 of them failed, .* CPU seconds; the scan has not ended")


if __name__ == "__main__":
    rodwake.main()
