"""Every scene of scenes/ is legal and runs. Of its figures those are drawn, all by one process, whose kind and keys no earlier scene had."""

import json
import sys
import tomllib

import rodwake
from rodwake import SCENES, SOURCE, ProgramTest
from shorter import LONG, shorter

sys.path.insert(0, str(SOURCE / "plots"))
import rodwake_plot  # noqa: E402


class ScenesTest(ProgramTest):
    def scenes(self):
        found = sorted(SCENES.glob("*.toml"))
        self.assertIn(rodwake.THEORY_PAIR, found)
        return found

    def test_check(self):
        for scene in self.scenes():
            with self.subTest(scene.name):
                text = self.expect(0, "check", scene).stdout
                self.assertTrue(text.endswith(f"{scene}: ok\n"))

    def test_run(self):
        drawn_before = set()
        for scene in (scene for scene in self.scenes() if scene.stem not in LONG):
            with self.subTest(scene.name):
                looks = {(figure["kind"], *sorted(figure)): figure for figure in tomllib.loads(scene.read_text())["figures"]}
                figures = [figure for look, figure in looks.items() if look not in drawn_before]
                drawn_before |= looks.keys()
                inline = ",".join("{" + ",".join(f"{key}={json.dumps(value)}" for key, value in figure.items()) + "}" for figure in figures)
                chosen = ["-s", f"figures=[{inline}]"] if figures else []
                self.expect(0, "run", scene, "--quiet", "--no-figures", *shorter(scene.stem), *chosen)
                out = self.folder / "results" / scene.stem
                self.assertEqual(self.status(out), "finished")
                self.assertFalse((out / "figures").exists())
                if not figures:
                    continue
                self.assertEqual(rodwake_plot.main([str(out), "--quiet"]), 0)
                drawn = list((out / "figures").iterdir())
                named = {figure["name"] for figure in figures}
                added = ("fit", "phase_diagram", "scan_curve")  # where no figure that was asked for shows the fit or the scan
                self.assertEqual({path.stem for path in drawn if path.suffix == ".png" and
                                  (path.stem in named or not path.stem.startswith(added))}, named)
                films = {figure["name"] for figure in figures if figure["kind"] in ("movie", "rods_movie", "medium_film")}
                self.assertEqual({path.stem for path in drawn if path.suffix != ".png"}, films)
                self.assertTrue((out / "report.html").is_file())


if __name__ == "__main__":
    rodwake.main()
