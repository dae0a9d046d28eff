"""rodwake scenes and rodwake new: what is shipped, and a scene to begin with."""

import os
import pty
import shutil
import subprocess

import rodwake
from rodwake import SCENES, SOURCE, ProgramTest, snapshot


class ScenesVerbTest(ProgramTest):
    def test_every_scene_is_listed_with_what_it_shows(self):
        text = self.expect(0, "scenes").stdout
        for scene in SCENES.glob("*.toml"):
            first = scene.read_text().splitlines()[0]
            self.assertTrue(first.startswith("# "), scene)
            self.assertRegex(text, rf"(?m)^{scene.stem}\n    {first.split()[1]} ", scene)
        self.assertIn("\nfitting/problems/monopole\n", text)
        self.assertLessEqual(max(map(len, text.split("rodwake scenes pair")[0].splitlines())), 79)

    def test_one_is_printed(self):
        for name in ("pair", "pair.toml", "scenes/pair.toml"):
            self.assertEqual(self.expect(0, "scenes", name).stdout, (SCENES / "pair.toml").read_text())
        self.refuse(2, r'pari: no such scene is shipped \(did you mean "pair"\?\)', "scenes", "pari")

    def test_all_are_copied_with_the_data_they_read(self):
        self.expect(0, "scenes", "-o", ".")
        for folder in ("scenes", "fitting/problems", "fitting/data"):
            for file in (SOURCE / folder).iterdir():
                self.assertEqual((self.folder / folder / file.name).read_bytes(), file.read_bytes())
        self.expect(0, "check", "fitting/problems/monopole.toml", "--quiet")
        before = snapshot(self.folder)
        self.expect(0, "scenes", "-o", ".")
        self.assertEqual(snapshot(self.folder), before)
        self.write("scenes/pair.toml", "mine")
        self.refuse(2, "scenes/pair.toml: already exists and differs", "scenes", "-o", ".")
        self.expect(0, "scenes", "-o", ".", "--force", "--quiet")
        self.assertEqual((self.folder / "scenes/pair.toml").read_bytes(), (SCENES / "pair.toml").read_bytes())

    def test_where_nothing_can_be_written(self):
        self.write("file", "")
        self.refuse(1, "file/fitting/data/README.md: cannot be written: Not a directory", "scenes", "-o", "file")

    def test_an_installed_program_has_its_own(self):
        (self.folder / "prefix/bin").mkdir(parents=True)
        program = shutil.copy(rodwake.PROGRAM, self.folder / "prefix/bin/rodwake")
        self.write("prefix/share/rodwake/scenes/own.toml", "# Mine.\nschema = 1\n")
        (self.folder / "prefix/share/rodwake/fitting/problems").mkdir(parents=True)
        done = subprocess.run([program, "scenes"], capture_output=True, text=True)
        self.assertRegex(done.stdout, r"\Aown\n    Mine\.\n\n")


class NewTest(ProgramTest):
    def test_every_kind_passes_check(self):
        for number, options in enumerate((
                [], ["--rods", 1], ["--rods", 20, "--kappa", "1e-6"], ["--kind", "bed"],
                ["--kind", "bed", "--rods", 5, "--phi-b", 0.9], ["--kind", "scan"],
                ["--kind", "scan", "--start", "parallel", "--kappa", "1e6"], ["--kind", "critical"])):
            done = self.expect(0, "new", f"{number}.toml", *options)
            self.assertIn(f"rodwake run {number}.toml", done.stderr)
            self.expect(0, "check", "--quiet", f"{number}.toml")
            text = self.expect(0, "new", *options).stdout
            self.assertEqual((self.folder / f"{number}.toml").read_text(), text)

    def test_answers_are_in_the_scene(self):
        self.assertIn("\nkappa = 2.5 ", self.expect(0, "new", "--kappa", 2.5).stdout)
        self.assertEqual(self.expect(0, "new", "--rods", 7).stdout.count("[[rods]]"), 7)
        self.assertIn("\nphi_b = 0.7 ", self.expect(0, "new", "--kind", "bed", "--phi-b", 0.7).stdout)
        self.assertIn('"rods.1.position.1"', self.expect(0, "new", "--kind", "scan", "--start", "parallel").stdout)

    def test_what_it_makes_runs(self):
        self.expect(0, "new", "my.toml")
        self.expect(0, "rods", "my.toml", "--quiet")
        self.expect(0, "new", "scan.toml", "--kind", "scan")
        self.expect(0, "scan", "scan.toml", "--quiet", "-s", "scan.resolution=16", "-s", "scan.audit=10")
        self.expect(0, "new", "critical.toml", "--kind", "critical")
        self.expect(0, "scan", "critical.toml", "--quiet", "-o", "critical")
        rows = (self.folder / "critical/critical.csv").read_text().splitlines()
        self.assertEqual(len(rows), 12, rows)  # a value for each alpha

    def test_refusals(self):
        self.refuse(2, "--kappa: a scene of kind bed has no use for it", "new", "--kind", "bed", "--kappa", 1)
        self.refuse(2, 'bd is none of rods, bed, scan, critical .did you mean "bed"', "new", "--kind", "bd")
        self.write("my.toml", "mine")
        self.refuse(2, "my.toml: already exists", "new", "my.toml")
        self.expect(0, "new", "my.toml", "--force")

    def asked(self, answers, *options):
        """Standard output and what the terminal shows, for these lines typed; the exit code."""
        keyboard, terminal = pty.openpty()
        with subprocess.Popen([rodwake.PROGRAM, "new", *options], cwd=self.folder, stdin=terminal, stderr=terminal,
                              stdout=subprocess.PIPE, text=True) as process:
            os.close(terminal)
            os.write(keyboard, answers.encode())
            out = process.communicate(timeout=20)[0]
        shown = b""
        try:
            while more := os.read(keyboard, 4096):
                shown += more
        except OSError:  # the other end is closed and all is read
            pass
        os.close(keyboard)
        return out, shown.decode(), process.returncode

    def test_three_questions_on_a_terminal(self):
        text, shown, code = self.asked("bed\n\nmuch\n0.7\n")
        self.assertEqual(code, 0)
        self.assertEqual([shown.count(question) for question in ("What to model", "How many rods", "Area fraction")], [1, 1, 2])
        self.assertIn("much is not a number", shown)
        self.assertIn("\nphi_b = 0.7 ", text)
        self.assertEqual(text.count("[[granular.rods]]"), 2)

    def test_only_what_options_leave_open_is_asked(self):
        text, shown, code = self.asked("3\n", "--kind", "rods", "--kappa", "2")
        self.assertEqual((code, text.count("[[rods]]")), (0, 3))
        self.assertIn("How many rods", shown)
        self.assertNotIn("kappa", shown)

    def test_an_end_of_input_is_no_answer(self):
        _, shown, code = self.asked("\x04")
        self.assertEqual(code, 2)
        self.assertIn("no answer", shown)


if __name__ == "__main__":
    rodwake.main()
