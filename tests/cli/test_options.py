"""The command line: help, options common to all verbs, info and plot."""

import json
import re
import subprocess

import rodwake
from rodwake import PAIR, THEORY_PAIR, ProgramTest, snapshot

VERBS = ("scenes", "new", "check", "field", "rods", "dem", "measure", "fit", "scan", "tradeoff", "run", "impact", "plot", "info", "help")
COMMON = {"--output", "--set", "--threads", "--seed", "--dry-run", "--quiet", "--verbose", "--force", "--log-json"}
# Of the common options, those that count; a verb that is not here has all.
OPTIONS = {"scenes": {"--output", "--force", "--quiet"}, "new": {"--force"}, "help": set(), "check": {"--output", "--set", "--seed", "--quiet"}, "impact": {"--dry-run"}, "plot": {"--dry-run", "--quiet"}, "info": set()}


class HelpTest(ProgramTest):
    def test_every_verb_has_help_with_examples(self):
        overview = self.expect(0, "--help").stdout
        for verb in VERBS:
            self.assertRegex(overview, rf"(?m)^  {verb} ")
            text = self.expect(0, verb, "--help").stdout
            self.assertRegex(text, rf"Examples:\n  rodwake {verb}")
            self.assertIn("Exit codes:", text)
            self.assertEqual(set(re.findall(r"(?m)^  .*?(--[a-z-]+)", text)) & COMMON, OPTIONS.get(verb, COMMON), verb)
        listed = re.search(r"Subcommands:\n((?:  .*\n)+)", overview).group(1)
        self.assertEqual(tuple(re.findall(r"(?m)^  (\w+) ", listed)), VERBS)

    def test_an_option_that_does_not_count_is_refused(self):
        for verb, options in OPTIONS.items():
            for option in COMMON - options:
                value = [] if option in ("--quiet", "--verbose", "--force", "--dry-run") else ["1"]
                self.refuse(2, f"{option}: rodwake {verb} has no such option", verb, *(["--cases"] if verb == "impact" else []), "x", option, *value)

    def test_the_examples_in_the_help_are_right(self):
        """Every example line parses: with --help appended to it, it exits with 0."""
        for verb in VERBS:
            for line in re.findall(r"(?m)^  (rodwake .*)$", self.expect(0, verb, "--help").stdout):
                self.expect(0, *line.split(" > ")[0].split()[1:], "--help")

    def test_version(self):
        for option in ("--version", "-V"):
            self.assertRegex(self.expect(0, option).stdout, r"^rodwake \d+\.\d+\.\d+\n$")

    def test_help_without_dashes(self):
        overview = self.expect(0, "--help").stdout
        self.assertEqual(self.expect(0).stdout, overview)
        self.assertEqual(self.expect(0, "help").stdout, overview)
        for verb in VERBS:
            self.assertEqual(self.expect(0, "help", verb).stdout, self.expect(0, verb, "--help").stdout)

    def test_usage_errors(self):
        self.refuse(2, "--hlep", "run", THEORY_PAIR, "--hlep")
        self.refuse(2, "--frobnicate", "--frobnicate", "run", THEORY_PAIR)
        self.refuse(2, "SCENE is required", "run")
        self.refuse(2, "extra", "check", THEORY_PAIR, "extra")
        for option, value in (("--threads", "0"), ("--threads", "many"), ("--threads", "1e9"), ("--seed", "-1"), ("--seed", "x")):
            self.refuse(2, option, "rods", THEORY_PAIR, option, value)
        for value in (-1, 2**63, 2**64 - 1, "1e300"):
            done = self.refuse(2, rf"--seed: .* is not a whole number from 0 to {2**63 - 1}\n", "rods", THEORY_PAIR, "--seed", value)
            self.assertLess(len(done.stderr), 300)


class CommonOptionsTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("pair.toml", PAIR)

    def test_overrides(self):
        self.expect(0, "rods", "pair.toml", "-s", "coupling.kappa=0.25", "--set", "rods.1.position.0=1.5",
                    "-s", "rods_run.method=bdf", "-o", "out")
        scene = (self.folder / "out/scene.toml").read_text()
        for line in ("kappa = 0.25", "position = [1.5, -2.5]", 'method = "bdf"'):
            self.assertIn(line, scene)
        outcome = json.loads((self.folder / "out/outcome.json").read_text())
        self.assertEqual(outcome["solver"]["method"], "bdf")

    def test_dry_run_changes_nothing(self):
        self.expect(0, "rods", "pair.toml", "-o", "out")
        before = snapshot(self.folder)
        for verb in ("rods", "run"):
            done = self.expect(0, verb, "pair.toml", "--dry-run")
            self.assertIn("# modelled", done.stdout)
            self.expect(0, verb, "pair.toml", "--dry-run", "-o", "out", "--force")
        self.expect(0, "field", THEORY_PAIR, "--dry-run")
        self.expect(0, "plot", "out", "--dry-run")
        self.assertEqual(snapshot(self.folder), before)

    def test_quiet_is_silent(self):
        for verb, scene in (("rods", "pair.toml"), ("run", "pair.toml"), ("field", THEORY_PAIR)):
            done = self.expect(0, verb, scene, "--quiet", "-o", verb)
            self.assertEqual((done.stdout, done.stderr), ("", ""))
        done = self.expect(0, "plot", "run", "--quiet")
        self.assertEqual((done.stdout, done.stderr), ("", ""))
        self.assertEqual(self.expect(0, "plot", "run").stdout.split(), ["run/figures/trajectories.png", "run/report.html"])

    def test_verbose_says_more(self):
        plain = self.expect(0, "rods", "pair.toml", "-o", "a").stderr
        verbose = self.expect(0, "rods", "pair.toml", "-o", "b", "-v").stderr
        self.assertIn("rods: contact", plain)
        self.assertNotIn("rods pair.toml", plain)
        self.assertIn("rods pair.toml -o b -v", verbose)

    def test_json_log(self):
        self.write('p"ir.toml', PAIR)
        self.expect(0, "rods", 'p"ir.toml', "-o", "out", "--quiet", "--log-json", "log.jsonl")
        self.expect(1, "rods", 'p"ir.toml', "-o", "bad", "--quiet", "--log-json", "log.jsonl", "-s", "rods_run.max_steps=3")
        lines = [json.loads(line) for line in (self.folder / "log.jsonl").read_text().splitlines()]
        for line in lines:
            self.assertEqual(set(line), {"time", "level", "message"})
        self.assertTrue(any(line["level"] == "info" and line["message"].startswith("rods: contact") for line in lines))
        self.assertTrue(any('p"ir.toml' in line["message"] for line in lines))
        self.assertTrue(any(line["level"] == "error" and "max_steps" in line["message"] for line in lines))

    def test_seed_is_on_record(self):
        self.expect(0, "rods", "pair.toml", "-o", "out", "--seed", 2**63 - 1)
        self.assertEqual(json.loads((self.folder / "out/provenance.json").read_text())["seed"], 2**63 - 1)


class InfoTest(ProgramTest):
    def test_versions_and_cpu(self):
        text = self.expect(0, "info").stdout
        for name in ("rodwake", "compiler", "SUNDIALS", "HDF5", "cpu", "features"):
            self.assertRegex(text, rf"(?m)^{name} +\S")

    def test_a_run_and_its_result_file(self):
        self.write("pair.toml", PAIR)
        self.expect(0, "rods", "pair.toml", "-o", "out")
        file = self.expect(0, "info", "out/result.h5").stdout
        self.assertRegex(file, r"(?m)^/rods/scene/theta \[\d+\]\[2\]  unit = \"rad\"$")
        run = self.expect(0, "info", "out").stdout
        self.assertTrue(run.startswith("out: finished run\n"))
        self.assertIn('"outcome": "contact"', run)
        self.assertTrue(run.endswith(file))

    def test_what_is_neither(self):
        self.write("garbage", "garbage")
        self.write("folder/garbage", "garbage")
        self.refuse(2, "garbage: not a readable HDF5 file", "info", "garbage")
        self.refuse(2, "folder: holds no rodwake run", "info", "folder")
        self.refuse(2, "nope: no such file or folder", "info", "nope")

    def test_a_damaged_record(self):
        self.write("run/provenance.json", "{")
        self.refuse(2, "holds no rodwake run", "info", "run")

    def test_scene_reference_is_the_page_in_docs(self):
        page = (rodwake.SOURCE / "docs/scene.md").read_text()
        self.assertEqual(self.expect(0, "info", "--scene-reference").stdout, page)

    def test_schema_is_the_file_that_the_plots_read(self):
        text = (rodwake.SOURCE / "plots/rodwake_plots/schema.json").read_text(encoding="utf-8")
        self.assertEqual(self.expect(0, "info", "--schema").stdout, text)
        told = json.loads(text)
        self.assertEqual(set(told), {"schema", "tables", "keys", "figures", "fit_parameters", "measures"})
        self.assertIn({"measure": "force", "key": "speed", "title": "Speed", "unit": "a/s", "factor": 1.0,
                       "meaning": "of the rod along its heading"}, told["measures"])


class PlotTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("pair.toml", PAIR)

    def test_figures_of_a_run(self):
        self.expect(0, "rods", "pair.toml", "-o", "out")
        self.expect(0, "plot", "out/result.h5", "--pdf", "--width", "column", "--style", "slides")
        self.refuse(2, "neither column, page nor a length", "plot", "out", "--width", "broad")
        figures = sorted(path.suffix for path in (self.folder / "out/figures").iterdir())
        self.assertEqual(figures, [".pdf", ".png"])
        self.assertTrue((self.folder / "out/report.html").is_file())

    def test_a_listing_that_nobody_reads_to_its_end(self):
        self.expect(0, "rods", "pair.toml", "-o", "out", "--quiet")
        done = subprocess.run(["bash", "-o", "pipefail", "-c", '"$0" plot out | head -1', rodwake.PROGRAM], cwd=self.folder,
                              capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr, done.stdout.count("\n")), (0, "", 1))
        self.assertTrue((self.folder / "out/report.html").is_file())

    def test_what_is_no_run(self):
        self.write("folder/file", "")
        self.refuse(2, "nope: not a run directory", "plot", "nope")
        self.refuse(2, "pair.toml: not a run directory", "plot", "pair.toml")
        self.refuse(2, "folder: holds no rodwake run", "plot", "folder")

    def test_a_run_without_results(self):
        self.write("out/provenance.json", '{"status": "unfinished"}')
        self.refuse(1, "scene.toml: no such file", "plot", "out")

    def test_a_missing_python_package(self):
        away = self.write("away/h5py.py", "raise ImportError('No module named h5py')").parent
        done = self.expect(1, "run", "pair.toml", "-o", "out", "--quiet", env={"PYTHONPATH": str(away)})
        self.assertIn("a Python package is missing: No module named h5py", done.stderr)
        self.assertIn("rodwake plot out tries again", done.stderr)
        self.assertEqual(self.status("out"), "finished")
        self.assertTrue((self.folder / "out/result.h5").is_file())
        self.expect(0, "plot", "out")


if __name__ == "__main__":
    rodwake.main()
