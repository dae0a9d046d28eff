"""rodwake run: what a run leaves behind, and who may write over it."""

import csv
import json
import shutil
import subprocess
import re

import h5py
import rodwake
from rodwake import PAIR, THEORY_PAIR, ProgramTest, snapshot

CONTACT_TIME = 40.595264757446582  # tests/data/rod_trajectories.json: the pair of scenes/pair.toml


class RunTest(ProgramTest):
    def test_quickstart_leaves_everything(self):
        self.expect(0, "run", THEORY_PAIR, "-o", "out", "--quiet")
        out = self.folder / "out"
        names = {str(p.relative_to(out)) for p in out.rglob("*") if p.is_file()}
        self.assertEqual(names, {"scene.toml", "provenance.json", "log.txt", "manifest.json", "result.h5", "rods.csv", "outcome.json",
                                 "field_cut_0.csv", "report.html", "explore.html", "figures/trajectories.png", "figures/strain.png",
                                 "figures/wake.png"})
        self.assert_outcome(json.loads((out / "outcome.json").read_text()))
        self.assert_provenance(json.loads((out / "provenance.json").read_text()))
        self.assert_self_contained((out / "report.html").read_text())
        self.assert_csv_and_hdf5_agree(out)
        # The resolved scene is a scene, and stands for the same thing.
        again = self.expect(0, "check", out / "scene.toml").stdout
        self.assertEqual(again.split("# modelled")[0], self.expect(0, "check", THEORY_PAIR).stdout.split("# modelled")[0])

    def assert_outcome(self, outcome):
        self.assertEqual((outcome["outcome"], outcome["pair"], outcome["solver"]["status"]), ("contact", [0, 1], "stopped_at_event"))
        # rtol 1e-8 a step; the global error is up to 100 times that (include/rodwake/integrate/ode.hpp).
        self.assertAlmostEqual(outcome["time"] / CONTACT_TIME, 1.0, delta=1e-6)
        # The root is bracketed to some roundings of the time, 40 * 2^-52, and the rods close in at a speed up to 2.
        self.assertAlmostEqual(outcome["min_separation"], 0.1, delta=1e-12)

    def assert_provenance(self, record):
        self.assertEqual((record["program"], record["status"], record["scene"]), ("rodwake", "finished", str(THEORY_PAIR)))
        self.assertIn(" run ", record["command"])
        self.assertGreater(record["wall_seconds"], 0.0)

    def assert_self_contained(self, html):
        self.assertEqual(html.count("data:image/png;base64,"), 3)
        self.assertEqual(re.findall(r"""src\s*=\s*["'](?!data:)[^"']*""", html), [])
        self.assertEqual(re.findall(r"""href\s*=\s*["'](?:\w+:|/)[^"']*""", html), [])  # links go to files beside the page

    def assert_csv_and_hdf5_agree(self, out):
        rows = list(csv.DictReader((out / "rods.csv").read_text().splitlines()))
        self.assertEqual(list(rows[0]), ["t", "x0", "y0", "theta0", "x1", "y1", "theta1"])
        with h5py.File(out / "result.h5") as file:
            scene = file["/rods/scene"]
            self.assertEqual(scene["t"].attrs["unit"], b"f/(mu v0)")
            self.assertEqual([float(r["t"]) for r in rows], list(scene["t"]))
            for rod in (0, 1):
                for name in ("x", "y", "theta"):
                    self.assertEqual([float(r[f"{name}{rod}"]) for r in rows], list(scene[name][:, rod]))
            grid = file["/field/grid"]
            self.assertEqual(grid["Ux"].shape, (121, 181))
            self.assertEqual((grid["x"][0], grid["x"][-1], grid["y"][0], grid["y"][-1]), (-12.0, 6.0, -6.0, 6.0))
            cut = list(csv.DictReader((out / "field_cut_0.csv").read_text().splitlines()))
            self.assertEqual([float(r["x"]) for r in cut], list(file["/field/cuts/0/s"]))

    def test_a_finished_run_is_not_written_over(self):
        self.write("pair.toml", PAIR)
        self.expect(0, "rods", "pair.toml")  # results/pair by default
        self.refuse(0, "results/pair: holds a finished run.*--force", "rods", "pair.toml")
        self.expect(0, "run", "pair.toml", "--quiet")  # which adds the report
        self.refuse(0, "holds a finished run", "run", "pair.toml", "--quiet")
        self.expect(0, "rods", "pair.toml", "--force", "-s", "coupling.kappa=0.25")
        self.assertIn("kappa = 0.25", (self.folder / "results/pair/scene.toml").read_text())
        self.assert_no_temporaries()

    def test_what_is_gone_of_a_finished_run_is_made_again(self):
        self.write("pair.toml", PAIR + "[field]\n[[field.cuts]]\nfrom = -1.0\nto = 2.0\n")
        self.expect(0, "run", "pair.toml", "-o", "out", "--quiet")
        out = self.folder / "out"
        names = set(snapshot(out))
        whole = {name: (out / name).read_bytes() for name in ("rods.csv", "field_cut_0.csv")}
        figure = next(name for name in names if name.startswith("figures/"))
        for verb, gone in (("rods", ["rods.csv"]), ("field", ["field_cut_0.csv"]), ("rods", ["outcome.json"]),
                           ("rods", ["manifest.json"]), ("run", ["result.h5", "rods.csv", figure]), ("run", ["report.html"])):
            for name in gone:
                (out / name).unlink()
            done = self.expect(0, verb, "pair.toml", "-o", "out")
            self.assertRegex(done.stderr, "gone; made again")
            self.assertNotIn("did not finish", done.stderr)
            self.assertEqual((set(snapshot(out)), self.status("out")), (names, "finished"), gone)  # what was drawn stays, too
            for name, content in whole.items():
                self.assertEqual((out / name).read_bytes(), content)
            with h5py.File(out / "result.h5") as file:
                self.assertLessEqual({"rods", "field"}, set(file))
            self.refuse(0, "holds a finished run", verb, "pair.toml", "-o", "out")

    def test_what_is_gone_of_another_stage_is_not_finished(self):
        self.write("pair.toml", PAIR + "[field]\n[[field.cuts]]\nfrom = -1.0\nto = 2.0\n")
        for verb in ("rods", "field"):
            self.expect(0, verb, "pair.toml", "-o", "out")
        for name in ("field_cut_0.csv", "rods.csv"):
            (self.folder / "out" / name).unlink()
        done = self.expect(0, "rods", "pair.toml", "-o", "out")
        self.assertIn("field: field_cut_0.csv is gone; left so by this command", done.stderr)
        self.assertEqual(self.status("out"), "unfinished")
        self.expect(0, "field", "pair.toml", "-o", "out")
        self.assertEqual(self.status("out"), "finished")
        self.assertTrue((self.folder / "out/field_cut_0.csv").exists())

    def test_force_leaves_nothing_of_the_run_before(self):
        variant = '[[variants]]\nname = "left"\nset = { "coupling.kappa" = -0.5 }\n'
        cut = '[field]\n[[field.cuts]]\nfrom = -1.0\nto = 2.0\n'
        self.write("pair.toml", PAIR + variant + cut)
        self.expect(0, "run", "pair.toml", "-o", "out", "--quiet")
        self.assertTrue((self.folder / "out/variants/left/rods.csv").is_file())
        self.assertTrue((self.folder / "out/field_cut_0.csv").is_file())
        self.write("pair.toml", PAIR)
        self.expect(0, "rods", "pair.toml", "-o", "out", "--force")
        self.assertEqual(set(snapshot(self.folder / "out")),
                         {"scene.toml", "provenance.json", "log.txt", "manifest.json", "result.h5", "rods.csv", "outcome.json"})

    def test_files_of_others_are_safe(self):
        self.write("pair.toml", PAIR)
        self.write("out/thesis.tex", "text")
        self.refuse(2, "not a rodwake run", "rods", "pair.toml", "-o", "out")
        self.expect(0, "rods", "pair.toml", "-o", "out", "--force")
        self.assertEqual((self.folder / "out/thesis.tex").read_text(), "text")

    def test_an_unfinished_run_is_taken_over(self):
        self.write("pair.toml", PAIR)
        self.expect(0, "rods", "pair.toml", "-o", "whole")
        for status in ("unfinished", "interrupted", "failed"):
            self.write(f"{status}/provenance.json", json.dumps({"status": status, "stages": {"rods": status}}))
            shutil.copy(self.folder / "whole/scene.toml", self.folder / status)
            self.write(f"{status}/result.h5.tmp99999", "of a run that was killed")
            done = self.expect(0, "rods", "pair.toml", "-o", status)
            self.assertIn("did not finish", done.stderr)
            self.assertEqual(self.status(status), "finished")
            self.assertEqual((self.folder / status / "rods.csv").read_bytes(), (self.folder / "whole/rods.csv").read_bytes())
        self.assert_no_temporaries()

    def test_another_scene_does_not_wipe_a_run(self):
        self.write("pair.toml", PAIR)
        self.expect(1, "rods", "pair.toml", "-o", "out", "-s", "rods_run.max_steps=5")  # failed: what it has is kept
        other = ("-s", "coupling.kappa=7")
        self.refuse(2, "holds the stage rods of another scene .*kappa = 7", "rods", "pair.toml", "-o", "out", *other)
        self.refuse(2, "holds the stage rods of another scene", "field", THEORY_PAIR, "-o", "out")
        self.expect(0, "rods", "pair.toml", "-o", "out", *other, "--force")

    def test_stages_of_a_scene_add_up(self):
        self.expect(0, "rods", THEORY_PAIR, "-o", "out")
        self.expect(0, "field", THEORY_PAIR, "-o", "out")
        self.expect(0, "run", THEORY_PAIR, "-o", "whole", "--no-figures")
        for name in ("rods.csv", "outcome.json", "field_cut_0.csv"):
            self.assertEqual((self.folder / "out" / name).read_bytes(), (self.folder / "whole" / name).read_bytes())
        with h5py.File(self.folder / "out/result.h5") as parts, h5py.File(self.folder / "whole/result.h5") as whole:
            self.assertEqual(set(parts), set(whole))
        self.assertIn("rods: done already", self.expect(0, "run", THEORY_PAIR, "-o", "out").stderr)
        self.assertTrue((self.folder / "out/report.html").exists())
        self.refuse(0, "holds a finished run", "run", THEORY_PAIR, "-o", "out")

    def test_the_command_on_record_can_be_replayed(self):
        self.write("a pair.toml", PAIR)
        self.expect(0, "rods", "a pair.toml", "-o", "out", "-s", "coupling.kappa=0.25", "-s", 'title="it\'s; $HOME"')
        command = json.loads((self.folder / "out/provenance.json").read_text())["command"]
        subprocess.run(["sh", "-c", command + " --force"], cwd=self.folder, check=True, capture_output=True)
        self.assertIn("kappa = 0.25", (self.folder / "out/scene.toml").read_text())
        self.assertIn("it's; $HOME", (self.folder / "out/scene.toml").read_text())

    def test_a_solve_that_fails_keeps_what_it_has_and_says_so(self):
        self.write("pair.toml", PAIR)
        done = self.expect(1, "rods", "pair.toml", "-o", "out", "-s", "rods_run.max_steps=5")
        self.assertRegex(done.stderr, "stopped at t=.*max_steps")
        self.assertEqual(self.status("out"), "failed")
        outcome = json.loads((self.folder / "out/outcome.json").read_text())
        self.assertEqual(outcome["solver"]["status"], "failed")
        self.assertIn("stopped at t=", (self.folder / "out/log.txt").read_text())
        self.expect(0, "rods", "pair.toml", "-o", "out")
        self.assertEqual(self.status("out"), "finished")

    def test_threads_do_not_change_results(self):
        variants = "".join(f'[[variants]]\nname = "v{k}"\nset = {{ "coupling.kappa" = {k}.0 }}\n' for k in range(4))
        self.write("pair.toml", PAIR + variants)
        self.expect(0, "rods", "pair.toml", "-o", "one", "-j", 1)
        self.expect(0, "rods", "pair.toml", "-o", "four", "-j", 4)
        for path in sorted((self.folder / "one").rglob("rods.csv")):
            other = self.folder / "four" / path.relative_to(self.folder / "one")
            self.assertEqual(path.read_bytes(), other.read_bytes())
        self.assertEqual(len(list((self.folder / "four").rglob("rods.csv"))), 5)


if __name__ == "__main__":
    rodwake.main()
