"""The command line: help, options common to all verbs, info and plot."""

import json
import re
import subprocess

import rodwake
from rodwake import PAIR, THEORY_PAIR, ProgramTest, snapshot

VERBS = ("scenes", "new", "check", "field", "rods", "dem", "measure", "fit", "scan", "tradeoff", "design", "run", "impact", "camera", "convert", "replay", "explore", "plot", "info", "help")
COMMON = {"--output", "--set", "--threads", "--seed", "--dry-run", "--quiet", "--verbose", "--force", "--log-json"}
# Of the common options, those that count; a verb that is not here has all.
OPTIONS = {"scenes": {"--output", "--force", "--quiet"}, "new": {"--force"}, "help": set(), "check": {"--output", "--set", "--seed", "--quiet"}, "impact": {"--dry-run"}, "design": COMMON - {"--verbose", "--log-json"}, "camera": {"--output", "--seed", "--force", "--quiet"}, "convert": {"--output", "--force", "--quiet"}, "replay": {"--output", "--threads", "--force", "--quiet"}, "explore": {"--output", "--set", "--force", "--quiet"}, "plot": {"--output", "--dry-run", "--quiet"}, "info": set()}


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

    def test_keys_columns_and_files(self):
        for name, pattern in (
                ("coupling.kappa", r"^coupling\.kappa: key of a scene, in \[coupling\]\n(  .*\n)*  unit +mu v0/f"),
                ("rods.0.position", r"^rods\.position: key of a scene, in \[\[rods\]\]\n"),
                ("rods[1].position.0", r"^rods\.position: key of a scene, in \[\[rods\]\]\n"),
                ("kappa", r"^coupling\.kappa: key of a scene"), ("fit.start.eta", r"^fit\.start: key of a scene"),
                ("units", r"^units: key of a scene, in the top level"),
                ("[scan]", r"^\[scan\]: table of a scene\n(.*\n)*    resolution "), ("scan.axes", r"^\[\[scan\.axes\]\]: table"),
                ("granular", r"^\[granular\]: table"), ("scan.csv", r'^scan\.csv: file of a run, made by the stage "scan"\n(.*\n)*    turn<k> +rad '),
                ("fit_profile_0.csv", r"^fit_profile_<k>\.csv: file of a run"), 
                ("mean_speed", r"(?m)^mean_speed<k>: column of runs\.csv.*\n  meaning +of the rod along its heading"),
                ("mean_speed1", r"(?m)^mean_speed<k>: column of scan\.csv.*\n(  .*\n)*  unit +m/s"),
                ("psi6", r"(?m)^psi6: column of table\.csv"), ("min_separation", r"(?m)^min_separation: key of outcome\.json"),
                ("capture", r"^capture: how a run of rods ends\n  criterion contact, bound, orbit or pursuit\n"),
                ("outcome", r"^contact: how(.*\n)*pursuit: how(.*\n)*escape: how(.*\n)*undecided: how(.*\n)*capture: how"),
                ("outcome", r"(?m)^outcome: column of scan\.csv"), ("error", r"(?m)^  unit +as in the row"),
                ("measure.json", r"(?m)^    psi6 ")):
            output = self.expect(0, "help", name).stdout
            self.assertRegex(output, pattern)
            self.assertNotRegex(output, r"unit +\S*\{")
        self.assertRegex(self.expect(0, "new", "--help").stdout, r"--start(.*\n)+? .*for --kind scan \[perpendicular\]")
        self.refuse(2, "coupling.kapa: no command.*near it: coupling.kappa", "help", "coupling.kapa")
        self.refuse(2, "near it: .*mean_speed", "help", "mean_sped")
        self.refuse(2, "near it: .*contact_distance", "help", "contact_distanc")
        self.refuse(2, "rodwake help lists the commands", "help", "qwertyuiop")
        self.refuse(2, "extra: not expected; rodwake help takes one NAME", "help", "coupling.kappa", "extra")

    def test_every_key_of_a_scene_has_help(self):
        names = set(re.findall(r"(?m)^\| `(\w+)` \|", (rodwake.SOURCE / "docs/scene.md").read_text().split("## Parameters of")[0]))
        for name in sorted(names)[::25]:  # a process each
            if name not in VERBS:
                self.assertIn(name, self.expect(0, "help", name).stdout)


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
        self.assertNotIn("pair.toml -o a", plain)
        self.assertIn("rods -j 1 pair.toml -o b -v", verbose)

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
        self.refuse(2, "garbage: not a readable HDF5 file.*and nothing else that info knows: CSV", "info", "garbage")
        self.write("empty.csv", "")
        self.refuse(2, "empty.csv: is empty", "info", "empty.csv")
        self.write("bad.json", "{")
        self.refuse(2, "bad.json: not valid JSON", "info", "bad.json")
        self.refuse(2, "folder: holds no rodwake run", "info", "folder")
        self.refuse(2, "nope: no such file or folder", "info", "nope")

    def test_long_files_are_reported_in_short(self):
        rows = "".join(f"{k},{'contact' if k % 4 else 'escape'},{k / 8 if k % 2 else ''}\n" for k in range(4096))
        self.write("run/scan.csv", "coupling.kappa,outcome,time\n" + rows)
        output = self.expect(0, "info", "run/scan.csv").stdout
        self.assertLess(len(output.splitlines()), 20)
        self.assertRegex(output, r"^4096 rows, 3 columns\n  coupling\.kappa +mu v0/f +0 to 4095 +\S.*\n  outcome +1 +contact 3072, escape 1024 +contact, pursuit")
        self.assertRegex(output, r"  time +0\.125 to 511\.875, 2048 empty +of contact")
        self.assertIn("\n0,escape,\n1,contact,0.125\n2,contact,\n... 4090 rows ...\n4093,", output)
        self.write("data.csv", "# a comment\nx,y\n1,2\n3,four\n")
        self.assertRegex(self.expect(0, "info", "data.csv").stdout, r"^2 rows, 2 columns\n  x +1 to 3 *\n  y +2, four 1 *\n\nx,y\n1,2\n3,four\n$")
        self.write("data.csv", ";x;y\n% theirs\n0;1,5;2\n1;3;4;\n")  # an index without a name, a comma in a field, a separator at the end
        self.assertRegex(self.expect(0, "info", "data.csv").stdout, r"^2 rows, 2 columns\n  x +3, 1,5 1 *\n  y +2 to 4 *\n\n;x;y\n0;1,5;2\n")
        self.write("long.json", json.dumps({"list": list(range(1000)), "table": {f"k{k}": k for k in range(1000)}}))
        output = self.expect(0, "info", "long.json").stdout
        self.assertEqual(json.loads(output)["list"], [0, 1, 2, "... 1000 in all ...", 999])
        self.assertEqual(len(json.loads(output)["table"]), 41)
        self.write("log.txt", "".join(f"line {k}\n" for k in range(5000)))
        self.assertIn("line 179\n... 4800 lines ...\nline 4980\n", self.expect(0, "info", "log.txt").stdout)
        (self.folder / "figure.png").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(100))
        self.assertIn("108 bytes; open it with a viewer", self.expect(0, "info", "figure.png").stdout)

    def test_a_damaged_record(self):
        self.write("run/provenance.json", "{")
        self.refuse(2, "holds no rodwake run", "info", "run")

    def test_references_are_the_pages_in_docs(self):
        for option, name in (("--scene-reference", "scene"), ("--figure-reference", "figures"), ("--file-reference", "files")):
            page = (rodwake.SOURCE / f"docs/{name}.md").read_text()
            self.assertTrue(self.expect(0, "info", option).stdout == page, f"docs/{name}.md: regenerate it: ninja reference")
        self.assertIn("### `scan_runs.csv`\n\nThe columns of `scan.csv`.\n", page)
        self.assertRegex(page, r"### `series.csv`\n[^#]*\n\| `c_T` \| a/s \| speed of transverse sound \|\n\| `C11` ")  # no row for c_T_error
        self.assertIn("| `omega_static` |", page)

    def test_schema_is_the_file_that_the_plots_read(self):
        text = (rodwake.SOURCE / "plots/rodwake_plots/schema.json").read_text(encoding="utf-8")
        self.assertEqual(self.expect(0, "info", "--schema").stdout, text)
        record = json.loads(text)
        self.assertEqual(set(record), {"schema", "tables", "keys", "figures", "fit_parameters", "measures"})
        self.assertIn({"measure": "force", "key": "speed", "title": "Speed", "unit": "a/s", "factor": 1.0,
                       "meaning": "of the rod along its heading"}, record["measures"])


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

    def test_a_folder_named_as_an_option(self):
        self.expect(0, "run", "pair.toml", "-o", "-x", "--no-figures")
        self.expect(0, "plot", "--width", "column", "--", "-x")
        self.assertTrue((self.folder / "-x/report.html").is_file())
        self.write("-x.xyz", "1\na comment\nA 1 2 0\n")
        self.expect(0, "convert", "-o", "-out.csv", "--", "-x.xyz")
        self.assertTrue((self.folder / "-out.csv").is_file())

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
