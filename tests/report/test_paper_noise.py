"""studies/paper: the rows on rotational noise, with made-up results."""

import json
import sys
import tempfile
import unittest
from math import sqrt
from pathlib import Path

import numpy as np
from rodwake import SOURCE

sys.path.insert(0, str(SOURCE / "studies"))
from paper_rows import noise  # noqa: E402
from paper_rows.judge import DIFFERS, MATCHES, UNKNOWN  # noqa: E402

HEAD = "noise.rotational_diffusion,coupling.kappa,status,capture_probability,capture_probability_low,capture_probability_high"


class NoiseRowsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="rodwake-paper-")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def bed(self, reduced, error, D=0.01, D_error=0.001):
        found = {"rotational_diffusion": {"value": reduced, "error": error}, "D_r": {"value": D, "error": D_error}, "speed": {"value": 3.0, "error": 0.1}}
        (self.folder / "measure.json").write_text(json.dumps({"heading_diffusion": found}))
        return self.folder

    def scan(self, *points):
        rows = [f"{D!r},{kappa},ok,{p},{max(p - 0.05, 0)},{min(p + 0.05, 1)}" for D, kappa, p in points]
        (self.folder / "scan.csv").write_text("\n".join([HEAD, *rows, "1e-3,10,failed,,,"]) + "\n")
        return self.folder

    def test_capture_at_the_noise_of_the_bed(self):
        scan = self.scan((1e-4, 10, 1.0), (1e-2, 10, 0.2), (1e-3, 100, 1.0), (1e-3, 10, 0.6))
        self.assertAlmostEqual(noise.half_lost(noise.curve(scan, 10)), 1e-3 * 10 ** 0.25, 12)  # 0.6 to 0.2 over a decade
        p, error = noise.at(noise.curve(scan, 10), sqrt(1e-7))
        self.assertAlmostEqual(p, 0.8, 12)
        self.assertAlmostEqual(error, 0.0375 / 1.96, 3)
        for reduced, error, verdict in ((1e-4, 1e-5, MATCHES), (1e-2, 1e-3, DIFFERS), (1.8e-3, 1e-4, UNKNOWN), (1e-3, 6e-4, UNKNOWN), (1e-3, None, UNKNOWN)):
            self.assertEqual(noise.captured_in_noise(self.bed(reduced, error), scan).verdict, verdict, reduced)
        self.assertIn("half are lost at D_r = 0.0018", noise.captured_in_noise(self.bed(1e-4, 1e-5), scan).ours)

    def test_the_spread_of_free_rods(self):
        """Two rods side by side, in steps, against the formula."""
        D, speed, time, steps = 1e-3, 3.0, 10.0, 400
        random = np.random.default_rng(1)
        heading = np.cumsum(np.sqrt(2 * D * time / steps) * random.normal(size=(4000, 2, steps)), axis=2)
        y = (speed * np.sin(heading) * time / steps).sum(axis=2)
        self.assertAlmostEqual(np.std(y[:, 0] - y[:, 1]) / noise.free_spread(D, speed, time), 1.0, delta=0.04)  # 4000 runs: 1.1 %, headings 1 %

    def test_what_fifty_runs_leave(self):
        (self.folder / "runs.csv").write_text("run,half_box_separation_change\n1,-0.0016\n2,-0.0004\n3,\n4,0.0008\n")
        for change, verdict in ((-4e-3, MATCHES), (-1e-5, UNKNOWN)):  # 3 a over sqrt(50): 0.42 +- 0.21 a, against 5 a and 0.0125 a
            pair = {"half_box_separation_change": change, "half_box_separation_change_error": 1e-4}
            (self.folder / "summary.json").write_text(json.dumps({"pair": pair}))
            self.assertEqual(noise.averaged(self.bed(0.01, 1e-3), self.folder).verdict, verdict, change)
        self.assertIn("runs spread by 3.0 a, headings that diffuse freely would spread them by 16.2 a", noise.averaged(self.bed(0.01, 1e-3), self.folder).ours)
        (self.folder / "runs.csv").write_text("run,half_box_separation_change\n1,-0.0008\n2,-0.0004\n3,\n")
        self.assertEqual(noise.averaged(self.bed(0.01, 1e-3), self.folder).verdict, UNKNOWN)


if __name__ == "__main__":
    unittest.main()
