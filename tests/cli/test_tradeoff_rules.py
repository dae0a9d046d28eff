"""The rules of `rodwake tradeoff`: which settings a scene allows, errors between runs, and which candidate is chosen."""

import json
import math
import os
import sys
import tempfile
import tomllib
import unittest
from pathlib import Path

import numpy as np

PROGRAM, SOURCE = Path(os.environ["RODWAKE_PROGRAM"]), Path(os.environ.get("RODWAKE_SOURCE_DIR", Path(__file__).parents[2]))
sys.path[:0] = [str(PROGRAM.parent / "python"), str(SOURCE / "commands")]  # before tests/support, which has a rodwake of its own

from rodwake import InputError, _core  # noqa: E402
from rodwake_commands import tradeoff, tradeoff_parts, tradeoff_rods  # noqa: E402
from rodwake_commands.tradeoff_study import Candidate, QuantityError, Study, cheapest, most_accurate, pareto_front, reference_quantity  # noqa: E402

PAIR = """schema = 1
[medium]
eta = 1.0
alpha = 1.0
[coupling]
kappa = 0.5
[rods_run]
t_end = 8.0
contact_distance = 0.1
[[rods]]
position = [0.0, 1.0]
[[rods]]
position = [0.0, -1.0]
"""


def candidate(key, seconds, bias, bias_error=0.0, scatter=0.0, status="ok"):
    found = QuantityError("speed", "m/s", 2.0 + bias, scatter / math.sqrt(10), scatter, bias, bias_error, 2.0)
    return Candidate([key], seconds, 10, [found], status)


def two_beds():
    return [candidate("slow=1", 8.0, 0.0, 0.01, 0.2), candidate("fast=1", 1.0, 0.05, 0.03, 0.2)]


def tables(text, *settings):
    """The resolved scene as TOML, and its tables."""
    resolved = _core.parse_scene(text, "pair.toml", list(settings)).to_toml()
    return resolved, tomllib.loads(resolved)


def solve(ending, time, x, path=(), solved=1.0):
    """One run as tradeoff_rods.rod_errors takes it."""
    return {"solved": np.array([solved]), "ending": np.array([ending]), "contact_time": np.array([time]), "final_state": np.array([[x, 0.0]]),
            "path": np.array([[x, 0.0] for x in path]) if path else np.empty((0, 0))}


class ChoiceTest(unittest.TestCase):
    def test_a_bias_counts_as_far_as_it_exceeds_its_error(self):
        beds = two_beds()  # b^2 = 0.05^2 - 0.03^2 = 0.04^2; 0.2^2/(0.05^2 - 0.04^2) = 44.4 runs of 1 s, against 16 of 8 s
        rough = cheapest(beds, "speed", 0.05)
        self.assertEqual((rough.candidate, rough.runs, rough.seconds), (beds[1], 45, 45.0))
        self.assertAlmostEqual(rough.bias, 0.04)
        self.assertLessEqual(rough.error, 0.05)

    def test_an_error_below_the_bias_of_the_fast_bed_takes_the_slow_one(self):
        beds = two_beds()
        fine = cheapest(beds, "speed", 0.021)
        self.assertEqual((fine.candidate, fine.runs), (beds[0], 91))  # (0.2/0.021)^2 = 90.7
        self.assertIsNone(cheapest(beds, "speed", 0.0))

    def test_the_best_mixture_of_bias_and_scatter_within_a_time(self):
        beds = two_beds()
        self.assertEqual(most_accurate(beds, "speed", 8.5).candidate, beds[1])  # 1 slow run: 0.2; 8 fast ones: 0.081
        self.assertEqual((most_accurate(beds, "speed", 1000.0).candidate, most_accurate(beds, "speed", 1000.0).runs), (beds[0], 125))
        self.assertIsNone(most_accurate(beds, "speed", 0.5))

    def test_without_scatter_one_run_is_enough(self):
        fields = [candidate("exact=1", 3.0, 0.0), candidate("table=1", 1.0, 1e-6)]
        self.assertEqual(cheapest(fields, "speed", 0.0).candidate, fields[0])
        self.assertEqual((cheapest(fields, "speed", 1e-6).candidate, cheapest(fields, "speed", 1e-6).runs), (fields[1], 1))
        self.assertEqual(most_accurate(fields, "speed", 1e9).runs, 1)

    def test_the_front_is_what_no_other_one_beats(self):
        measured = [(4, 1e-8), (1, 1e-3), (2, 1e-5), (3, 1e-4), (0.5, math.inf), (2.5, 1e-5)]
        runs = [candidate(str(k), seconds, error) for k, (seconds, error) in enumerate(measured)]
        runs.append(candidate("late", 0.1, 1e-9, status="took too long"))
        self.assertEqual([choice.seconds for choice in pareto_front(runs, "speed")], [1, 2, 4])
        self.assertEqual(cheapest(runs, "speed", 1e-4).seconds, 2)
        self.assertIsNone(cheapest(runs, "speed", 1e-9))
        self.assertIsNone(cheapest(runs, "heat", 1.0))
        self.assertEqual(most_accurate(runs, "speed", 3.0).seconds, 2)

    def test_unknown_quantities_are_named(self):
        beds = two_beds()
        beds[1].status = "the step is too long"
        self.assertEqual(cheapest(beds, "speed", 0.05).candidate, beds[0])
        with self.assertRaisesRegex(InputError, '"heat" is not measured of this bed; there is speed'):
            reference_quantity("bed", beds, "heat")
        with self.assertRaisesRegex(InputError, "no candidate for the bed gave a result: failed"):
            reference_quantity("bed", [Candidate([], status="failed")], "speed")

    def test_what_for_says(self):
        for text, wanted in (("1e-6", ("", 1e-6, False)), ("2%", ("", 0.02, True)), ("rod_speed 5 %", ("rod_speed", 0.05, True)),
                             ("T_xy 1e-6", ("T_xy", 1e-6, False))):
            quantity, error, relative = tradeoff.wanted_error(text)
            self.assertEqual((quantity, round(error, 12), relative), wanted)
        for text, why in (("T_z much", "much is not a number"), ("1e400", "too large"), ("-1", "not from 0"), ("nan", "nan is not")):
            with self.assertRaisesRegex(InputError, f"--for: .*{why}"):
                tradeoff.wanted_error(text)


class ErrorsTest(unittest.TestCase):
    def test_the_largest_difference_of_the_states(self):
        errors = tradeoff_rods.rod_errors(solve(0, 4.25, 1.125, (0.0, 0.25)), solve(0, 4.0, 1.0, (0.0, 0.5)))
        self.assertEqual(errors, {"final_state": 0.125, "contact_time": 0.25, "outcome": 0.0, "path": 0.25})

    def test_another_outcome_is_infinitely_wrong(self):
        reference = solve(0, 4.0, 1.0, (0.0, 0.5))
        for other in (solve(2, math.nan, 1.0, (0.0,)), solve(0, 4.0, 1.0, (0.0, 0.5), solved=0.0)):
            wrong = {"final_state": math.inf, "contact_time": math.inf, "outcome": 1.0, "path": math.inf}
            self.assertEqual(tradeoff_rods.rod_errors(other, reference), wrong)
        nobody = solve(2, math.nan, 1.0)
        self.assertTrue(math.isnan(tradeoff_rods.rod_errors(nobody, nobody)["contact_time"]))
        self.assertTrue(math.isnan(tradeoff_rods.rod_errors(nobody, nobody)["path"]))

    def test_of_many_points_what_95_percent_keep_to(self):
        many = {"solved": np.ones(101), "contact_time": np.full(101, np.nan), "path": np.empty((0, 0))}
        reference = many | {"ending": np.full(101, 2), "final_state": np.zeros((101, 3))}
        run = many | {"ending": np.where(np.arange(101) < 3, 0, 2), "final_state": 1e-3 * np.arange(101)[:, None] * np.ones(3)}
        errors = tradeoff_rods.rod_errors(run, reference)
        self.assertAlmostEqual(errors["outcome"], 3 / 101)
        self.assertAlmostEqual(errors["final_state"], 98e-3)  # the 96th of 98 finite and 3 infinite ones

    def test_fits_maps_and_beds(self):
        best = {"estimates": np.array([[1.0, 0.1, 0.8, 1.2], [5.0, math.inf, 4.0, math.inf]]), "objective": 10.0}
        other = {"estimates": np.array([[1.05, 0.1, 0.9, 1.25], [9.0, 1.0, 4.0, 9.0]]), "objective": 10.5}
        errors = tradeoff_parts.fit_errors(other, best)
        for name, error in {"optimum": 0.5, "interval": 0.5, "objective": 0.5}.items():
            self.assertAlmostEqual(errors[name], error)
        exact = np.ones((3, 9))
        exact[2] = np.nan  # the rod itself
        table = exact * [1, 1, 1.5, 1, 1, 1, 1, 1, 1]
        self.assertEqual(tradeoff_parts.map_errors(table, exact), {"displacement": 2e-13, "strain": 0.5 / math.sqrt(3), "gradients": 2e-13})
        reference = [QuantityError("speed", "m/s", 2.0, 0.3, 1.0), QuantityError("psi6", "1", 0.5, 0.1, 0.2)]
        compared = tradeoff_parts.biases([QuantityError("speed", "m/s", 2.5, 0.4, 1.0), QuantityError("wake", "a", 1.0)], reference)
        self.assertEqual([(q.quantity, q.bias, q.bias_error, q.scale) for q in compared], [("speed", 0.5, 0.5, 2.0)])
        self.assertEqual([q.bias for q in tradeoff_parts.biases(reference, reference)], [0.0, 0.0])


class SettingsTest(unittest.TestCase):
    def test_settings_are_those_that_the_scene_allows(self):
        _, pair = tables(PAIR)
        settings = tradeoff_rods.allowed_settings(pair)
        self.assertEqual({s["field"] for s in settings}, {"exact", "table"})
        self.assertEqual({s["precision"] for s in settings}, {"full"})
        solvers = {(s["method"], s["form"]) for s in settings}
        self.assertEqual(solvers, {("erk", "angle"), ("adams", "angle"), ("erk", "director"), ("bdf", "angle"), ("bdf", "director"), ("bdf", "dae")})
        many = tradeoff_rods.allowed_settings(pair | {"rods": pair["rods"] * 150})
        self.assertNotIn("bdf", {s["method"] for s in many})
        self.assertEqual({s["precision"] for s in many}, {"full", "fine", "single"})
        oblong = tradeoff_rods.allowed_settings(tables(PAIR, "medium.periodic=[20,30]")[1])
        self.assertEqual({s["field"] for s in oblong}, {"exact"})

    def test_rods_without_a_choice_are_refused(self):
        _, pair = tables(PAIR)
        for scene, why in (({}, "no .rods_run. table"), (pair | {"medium": {"fitted": True}}, "give eta and xi"),
                           (pair | {"medium": {"dynamic": {}}}, "no settings to compare"), (pair | {"noise": {"rotational_diffusion": 0.1}}, "no noise"),
                           (pair | {"scan": {"axes": [{"key": "rods_run.rtol"}]}}, "varies rods_run.rtol")):
            with self.assertRaisesRegex(InputError, why):
                tradeoff_rods.require_rods(scene, "pair.toml")
        tradeoff_rods.require_rods(pair | {"scan": {"axes": [{"key": "rods_run.t_end"}]}}, "pair.toml")

    def test_the_keys_of_a_setting_make_the_scene_it_stands_for(self):
        text, scene = tables(PAIR, "rods_run.turning_tolerance=1e-4")
        for setting in tradeoff_rods.allowed_settings(scene):
            made = tables(text, *tradeoff_rods.setting_keys(scene, setting))[1]
            run, medium = made["rods_run"], made["medium"]
            self.assertEqual((run["method"], run["form"], run["rtol"], run["precision"], run["turning_tolerance"]),
                             (setting["method"], setting["form"], float(f"{setting['tolerance']:g}"), setting["precision"], 0.0))
            self.assertAlmostEqual(run.get("atol", run["rtol"] / 100) / setting["tolerance"], 0.01)
            self.assertEqual((medium["field"], medium.get("table", {}).get("tolerance", 0.0)), (setting["field"], setting["table_tolerance"]))

    def test_what_the_settings_choose_makes_no_other_work(self):
        work = [tradeoff_rods.work_text(tables(PAIR, *settings)[1], b"") for settings in
                ((), ("rods_run.method=bdf", "rods_run.rtol=1e-3", "medium.field=table", "medium.table.tolerance=1e-4"), ("coupling.kappa=0.7",))]
        self.assertEqual(work[0], work[1])
        self.assertNotEqual(work[0], work[2])


class StudyTest(unittest.TestCase):
    """Two points of a scan, solved in a moment: measured, stopped, taken up, read back."""

    def setUp(self):
        keeper = tempfile.TemporaryDirectory()
        self.addCleanup(keeper.cleanup)
        self.folder = Path(keeper.name)
        (self.folder / "points.csv").write_text("coupling.kappa,rods.1.position.0\n0.5,0\n30,-1\n")
        self.lines = []

    def study(self, limit=60.0, folder="out"):
        path = str(self.folder / "scan.toml")
        text = _core.parse_scene(PAIR + '[scan]\ndesign = "list"\nfile = "points.csv"\n', path, []).to_toml()
        target = tradeoff_rods.RodsTarget(tomllib.loads(text), text, path, self.folder / folder, limit, "final_state")
        target.candidates = target.candidates[:14]  # of rtol 1e-3 and 1e-4
        (self.folder / folder).mkdir(exist_ok=True)
        return Study(target, self.folder / folder, limit)

    def test_measured_against_a_reference_and_taken_up(self):
        first = self.study()

        def stop_at_five(done, _):
            if done == 5:
                raise KeyboardInterrupt
        with self.assertRaises(KeyboardInterrupt):
            first.measure(self.lines.append, stop_at_five)
        self.assertFalse(json.loads(first.json.read_text())["finished"])
        second = self.study()
        second.take_up(False)
        self.assertEqual([one.tried for one in second.candidates], [True] * 5 + [False] * 9)
        second.measure(self.lines.append, lambda *_: None)
        self.assertLessEqual(second.candidates[0].seconds, first.candidates[0].seconds)  # kept, and timed once more
        self.assertEqual(second.target.unit, "2 points of the scan")
        least = second.target.least["final_state"]
        for one in second.candidates:
            errors = {q.quantity: q.bias for q in one.found}
            self.assertEqual((one.status, errors["outcome"], "path" in errors), ("ok", 0.0, False), one.keys)
            self.assertTrue(least <= errors["final_state"] < 100 * one.setting["tolerance"], one.keys)
            self.assertGreater(one.rhs_evaluations, 0)
        third = self.study()
        third.take_up(False)
        self.assertTrue(third.finished)
        self.assertEqual(third.candidates, second.candidates)  # read as they were written

    def test_a_longer_limit_tries_again_what_took_too_long(self):
        study = self.study(limit=1.0)
        study.candidates = [Candidate(one.keys, 2.0, 1, status="took too long", setting=one.setting) for one in study.candidates]
        study.candidates[0].status, study.finished = "ok", True
        study.target.reference = {}
        study.save()
        for limit, finished in ((1.0, True), (60.0, False)):
            again = self.study(limit)
            again.take_up(False)
            self.assertEqual(again.finished, finished)

    def test_folders_that_hold_something_else(self):
        study = self.study()
        study.json.write_text('{"work": "another"}')
        with self.assertRaisesRegex(InputError, "cannot be read"):
            study.take_up(False)
        study.json.write_text(json.dumps({"work": "another", "limit": 60, "finished": True, "ways": []}))
        with self.assertRaisesRegex(InputError, "another scene"):
            study.take_up(False)
        study.json.unlink()
        (study.folder / "provenance.json").write_text("{}")
        (study.folder / "scene.toml").write_text(study.target.text)
        study.take_up(False)
        (study.folder / "scene.toml").write_text(study.target.text.replace("kappa = 0.5", "kappa = 0.7"))
        with self.assertRaisesRegex(InputError, "rods of another scene"):
            study.take_up(False)
        (study.folder / "provenance.json").unlink()
        (study.folder / "precious.txt").write_text("precious")
        with self.assertRaisesRegex(InputError, "not a rodwake run"):
            study.take_up(False)
        study.take_up(True)


if __name__ == "__main__":
    unittest.main()
