"""Scans: the same bytes whoever evaluates the points."""

import contextlib
import os
import signal
import subprocess
import sys
import time
import unittest
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import rodwake
from distributed import Client, LocalCluster
from program import SCENES, new_folder, run_scene

AXES = {"coupling.kappa": np.geomspace(0.1, 10, 5), "rods.1.position.0": np.linspace(-6, 6, 7)}


class ScanTest(unittest.TestCase):
    def setUp(self):
        self.pair = rodwake.Scene.load(SCENES / "pair.toml")

    def csv_of(self, executor=None, scene=None, axes=AXES, **options):
        folder = new_folder(self) / "scan"
        rodwake.scan(scene or self.pair, axes, executor=executor, folder=folder, **options)
        return (folder / "scan.csv").read_bytes()

    def test_a_table_with_units(self):
        table = rodwake.scan(self.pair, AXES, threads=2)
        self.assertEqual(len(table), 35)
        np.testing.assert_array_equal(np.unique(table["coupling.kappa"]), AXES["coupling.kappa"])
        self.assertEqual(set(table["status"]), {"ok"})
        self.assertEqual(table.attrs["units"]["time"], "f/(mu v0)")
        row = table.iloc[17]
        poses = [[0, 2.5, 0], [row["rods.1.position.0"], -2.5, 0]]
        alone = rodwake.simulate(poses, rodwake.Medium(), kappa=row["coupling.kappa"], t_end=60.0, contact_distance=0.1)
        self.assertEqual(row["outcome"], alone.outcome)
        self.assertAlmostEqual(row["time"], alone.time, delta=83e-8 * alone.time)  # 83 rtol (integrate/ode.hpp)

    def test_critical_values(self):
        """Straight walkers at right angles, b apart, pass |x - b|/sqrt(2) from each other; the same from a pool."""
        crossing = self.pair.copy().set("coupling.kappa", 0.0).set("rods.0.position", [0.0, 0.0])
        crossing = crossing.set("rods.1.position", [0.0, -5.0]).set("rods.1.heading", np.pi / 2)
        options = {"limits": (0.0, 9.0), "axes": {"rods.1.position.1": [-5.0, -4.0]}, "tolerance": 1e-10}
        found = rodwake.critical(crossing, "rods.1.position.0", ["contact", "other"], **options)
        expected = [b + side * 0.1 * np.sqrt(2.0) for b in (5.0, 4.0) for side in (-1, 1)]
        np.testing.assert_allclose(found["value"], expected, atol=1e-9)
        self.assertEqual(set(found["kind"]), {"grazing"})
        with ThreadPoolExecutor(2) as pool:
            again = rodwake.critical(crossing, "rods.1.position.0", ["contact", "other"], executor=pool, **options)
        self.assertTrue(found.equals(again))
        with self.assertRaisesRegex(rodwake.InputError, "limits: give the range"):
            rodwake.critical(crossing, "rods.1.position.0")

    def test_what_version_0_3_called_proved_is_verified(self):
        folder = new_folder(self) / "scan"
        rodwake.scan(self.pair, {"coupling.kappa": [0.0]}, folder=folder)  # who walks straight has a closed form
        table = folder / "scan.csv"
        table.write_text(table.read_text().replace("verified", "proved"))
        self.assertIn(",proved,", table.read_text())
        self.assertEqual(list(rodwake.open_run(folder).table("scan.csv")["certificate"]), ["verified"])

    def test_executors_of_the_standard_library(self):
        ours = self.csv_of(threads=1)
        self.assertEqual(ours, self.csv_of(threads=2))
        for pool in (ThreadPoolExecutor, ProcessPoolExecutor):
            with pool(2) as executor:
                self.assertEqual(ours, self.csv_of(executor), pool)
                self.assertEqual(ours, self.csv_of(executor, chunk=3), pool)

    def test_dask(self):
        with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, local_directory=str(new_folder(self))) as cluster:
            with Client(cluster) as client:
                self.assertEqual(self.csv_of(threads=2), self.csv_of(client))

    def test_ctrl_c_ends_a_scan_of_dask(self):
        """Whoever is at the terminal signals the workers, too."""
        for whole_group in (False, True):
            folder = new_folder(self)
            script = (f"import rodwake, time\nfrom distributed import Client, LocalCluster\n"
                      f"if __name__ == '__main__':\n"
                      f"    scene = rodwake.Scene.load({str(SCENES / 'pair.toml')!r})\n"
                      f"    axes = {{'coupling.kappa': [0.1 + 0.01 * k for k in range(300)], 'rods.1.position.0': [0.01 * k - 6 for k in range(1000)]}}\n"
                      f"    cluster = LocalCluster(2, threads_per_worker=1, dashboard_address=None, local_directory={str(folder)!r})\n"
                      f"    try:\n        rodwake.scan(scene, axes, executor=Client(cluster), folder={str(folder / 'scan')!r})\n"
                      f"    except KeyboardInterrupt:\n        print('stopped', time.time(), flush=True)\n        import os; os._exit(0)\n")
            (folder / "script.py").write_text(script)
            with subprocess.Popen([sys.executable, str(folder / "script.py")], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                                  start_new_session=True) as process:
                try:
                    while not (folder / "scan/points.log").exists():
                        self.assertIsNone(process.poll())
                        time.sleep(0.1)
                    time.sleep(2)
                    signalled = time.time()
                    (os.killpg if whole_group else os.kill)(process.pid, signal.SIGINT)
                    word, at = process.communicate(timeout=30)[0].split()
                finally:
                    with contextlib.suppress(ProcessLookupError):
                        os.killpg(process.pid, signal.SIGKILL)
            self.assertEqual(word, "stopped")
            self.assertLess(float(at) - signalled, 5.0)  # a second, and what a busy machine adds
            self.assertEqual(rodwake.open_run(folder / "scan").status, "interrupted")
            self.assertFalse((folder / "scan/rodwake.lock").exists())
            self.assertGreater((folder / "scan/points.log").stat().st_size, 0)

    def test_the_scan_of_a_scene_refines_alike(self):
        scene = rodwake.Scene.load(SCENES / "phase_parallel.toml")
        scene.set({"scan.resolution": 16, "scan.audit": 20, "scan.axes.0.count": 4, "scan.axes.1.count": 4})
        with ThreadPoolExecutor(2) as executor:
            self.assertEqual(self.csv_of(scene=scene, axes=None, threads=1), self.csv_of(executor, scene=scene, axes=None))
        program = run_scene(self, SCENES / "phase_parallel.toml", "scan.resolution=16", "scan.audit=20", "scan.axes.0.count=4", "scan.axes.1.count=4",
                            verb="scan")
        self.assertEqual((program.folder / "scan.csv").read_bytes(), self.csv_of(scene=scene, axes=None))

    def test_a_scan_goes_on(self):
        folder, calls = new_folder(self) / "scan", []

        class Failing(ThreadPoolExecutor):
            def submit(self, *call):
                calls.append(call)
                if len(calls) == 4:
                    raise OSError("the cluster is gone")
                return super().submit(*call)

        with Failing(1) as executor, self.assertRaisesRegex(OSError, "the cluster is gone"):
            rodwake.scan(self.pair, AXES, executor=executor, folder=folder, chunk=5)
        table = rodwake.scan(self.pair, AXES, folder=folder)
        self.assertEqual(len(table), 35)
        self.assertEqual((folder / "scan.csv").read_bytes(), self.csv_of())

    def test_scans_of_beds(self):
        text = ('schema = 1\n[granular]\nbeads = 40\nbox = "16 a"\nequilibrate = "0.002 s"\nduration = "0.004 s"\n[scan]\ndesign = "grid"\n'
                '[[scan.axes]]\nkey = "granular.beads"\nvalues = [30, 40]\n')
        scene = rodwake.Scene.parse(text)
        with ProcessPoolExecutor(2) as executor:
            self.assertEqual(self.csv_of(scene=scene, axes=None, threads=1), self.csv_of(executor, scene=scene, axes=None))
        folder = new_folder(self) / "scan"
        rodwake.scan(scene, folder=folder)
        beds = [rodwake.open_run(one.parent) for one in sorted(folder.glob("points/**/summary.json"))]
        self.assertEqual(sorted(bed.json("summary.json")["beads"] for bed in beds), [30, 40])

    def test_wrong_axes_are_refused(self):
        for axes, word in (({"coupling.kapa": [1, 2]}, "kappa"), ({"coupling.kappa": []}, "values"), ({"medium.eta": [-2.0]}, "eta|-1")):
            with self.assertRaisesRegex(rodwake.InputError, word):
                rodwake.scan(self.pair, axes)
        for axes, options, word in (({"coupling.kappa": 3}, {}, "axes.*list of values"), ({"coupling.kappa": "1, 2"}, {}, "axes"), (AXES, {"chunk": -1}, "chunk = -1"),
                                    (AXES, {"threads": -1}, "threads = -1"), (AXES, {"threads": 0.5}, "threads")):
            with self.assertRaisesRegex(rodwake.InputError, word):
                rodwake.scan(self.pair, axes, **options)
        for scene, options, word in (("pair.toml", {}, "scene: expected"), (self.pair, {"axes": [1]}, "axes: expected"), (self.pair, {"axes": {3: [1]}}, "axes"),
                                     (self.pair, {"axes": AXES, "executor": 3}, "executor: expected"), (self.pair, {"axes": AXES, "progress": 1}, "progress")):
            with self.assertRaisesRegex(TypeError, word):
                rodwake.scan(scene, **options)


if __name__ == "__main__":
    unittest.main()
