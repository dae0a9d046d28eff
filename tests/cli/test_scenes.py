"""Every scene of scenes/ is legal and runs. Its figures are drawn, by one process, if one is of a kind that no earlier scene had with these
keys."""

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
                self.expect(0, "run", scene, "--quiet", "--no-figures", *shorter(scene.stem))
                out = self.folder / "results" / scene.stem
                self.assertEqual(self.status(out), "finished")
                self.assertFalse((out / "figures").exists())
                figures = tomllib.loads(scene.read_text())["figures"]
                looks = {(figure["kind"], *sorted(figure)) for figure in figures}
                if looks <= drawn_before:
                    continue
                drawn_before |= looks
                self.assertEqual(rodwake_plot.main([str(out), "--quiet"]), 0)
                named = {figure["name"] + ".png" for figure in figures}
                films = {figure["name"] for figure in figures if figure["kind"] in ("movie", "rods_movie", "medium_film")}
                drawn = list((out / "figures").iterdir())
                self.assertEqual({path.name for path in drawn if path.suffix == ".png"}, named)
                self.assertEqual({path.stem for path in drawn if path.suffix != ".png"}, films)
                self.assertTrue((out / "report.html").is_file())


if __name__ == "__main__":
    rodwake.main()
