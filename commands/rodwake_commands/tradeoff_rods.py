"""The rods of a scene, solved once or at a sample of its scan: the settings it allows, the reference, and the error of each setting."""

import hashlib
import json
import math
import tomllib
from dataclasses import replace

import numpy as np
from rodwake import InputError, RunError, _core
from rodwake_commands.tradeoff_study import Candidate, QuantityError

ERRORS = ("final_state", "contact_time", "outcome", "path")
LARGEST_DENSE = 320  # side of Newton's dense matrix: beyond it an implicit step costs more than any number of explicit ones
LEAST_FOR_PRECISION = 8  # rods from which their wakes are added up in tiles
STIFF = 30.0  # rods::suitable_method: stiffer headings are for backward differentiation
TOLERANCES = [10.0**-k for k in range(3, 12)]
KEPT_BY = 0.95  # share of the points of a scan
TIMED_FOR, LEAST_REPEATS, MOST_REPEATS = 0.05, 3, 100  # seconds and numbers of repeats of a setting
LONG_RUN, QUICK_RUN = 1.0, 0.2  # s; longer runs are not repeated, quicker ones are timed again when all have had their turn
OVER_AGREEMENT = 10.0  # least error quoted over what the two methods of the reference agree to
TOO_LONG = "took too long"
CONTACT = 0  # of the endings that _core.RodsWork has as numbers


def rod_count(scene):
    return scene["rods_random"]["count"] if "rods_random" in scene else len(scene["rods"])


def require_rods(scene, path):
    """`scene`: the tables of its file. Raises InputError for a scene whose rods have no settings to choose."""
    medium = scene.get("medium", {})
    if "rods_run" not in scene:
        raise InputError(f"{path}: no [rods_run] table, so there are no rods whose cost and error could be measured; --of bed, fit or field trades "
                         "another part of the scene")
    if medium.get("fitted"):
        raise InputError(f"{path}: medium.fitted = true takes eta and xi from [fit]: give eta and xi in [medium]")
    if "dynamic" in medium:
        raise InputError(f"{path}: rods in a dynamic medium have one method, controlled by rods_run.rtol: there are no settings to compare")
    if "scan" in scene and "granular" in scene:
        raise InputError(f"{path}: the scan is one of beds, whose cost and error rodwake tradeoff does not measure yet")
    noise = scene.get("noise", {})
    if noise and ("scan" in scene or noise.get("rotational_diffusion") or noise.get("translational_diffusion")):
        raise InputError("tradeoff compares methods that take no noise: leave [noise] out (-s noise=)")
    for axis in scene.get("scan", {}).get("axes", []):
        for key in axis.get("keys") or [axis.get("key", "")]:
            if key.startswith("rods_run.") and key not in ("rods_run.t_end", "rods_run.contact_distance"):
                raise InputError(f"{path}: the scan varies {key}, which rodwake tradeoff chooses: leave this axis out")


def allowed_fields(scene):
    """(field, table_tolerance, precision, loosest rtol, tightest rtol): an approximate field goes with tolerances about its error."""
    medium, rods = scene.get("medium"), rod_count(scene)
    if medium and medium["field"] == "measured":
        return [("measured", 0.0, "full", 1.0, 0.0)]
    fields = [("exact", 0.0, "full", 1.0, 0.0)]
    if not medium:
        return fields
    periodic = medium.get("periodic")
    if periodic is None and rods >= LEAST_FOR_PRECISION:
        fields += [("exact", 0.0, "fine", 1e-5, 1e-9), ("exact", 0.0, "single", 1e-2, 1e-6)]
    square = not isinstance(periodic, list) or periodic[0] == periodic[1]
    if "scan" not in scene and square:  # a scan takes the exact field only, and tables know no other box
        fields += [("table", T, "full", 10 * T, 0.1 * T) for T in (1e-4, 1e-6, 1e-8)]
    return fields


def allowed_solvers(scene):
    """(method, form). In scans `auto` takes pairs many at a time."""
    numbers_a_rod = {"angle": 3, "director": 4, "dae": 5}
    solvers = [("auto", "angle")] if "scan" in scene else []
    solvers += [("erk", "angle"), ("adams", "angle"), ("erk", "director"), ("bdf", "angle"), ("bdf", "director"), ("bdf", "dae")]
    return [(method, form) for method, form in solvers if method != "bdf" or numbers_a_rod[form] * rod_count(scene) <= LARGEST_DENSE]


def allowed_settings(scene):
    """From loose to tight. Decades that differ from a bound by rounding count."""
    return [{"method": method, "form": form, "field": field, "table_tolerance": table, "precision": precision, "tolerance": tolerance}
            for tolerance in TOLERANCES for field, table, precision, loosest, tightest in allowed_fields(scene)
            for method, form in allowed_solvers(scene) if tightest / 1.5 <= tolerance <= loosest * 1.5]


def setting_keys(scene, setting):
    """Keys of the scene that make a setting, as for -s; those that make no difference are left out."""
    run, tolerance = scene["rods_run"], setting["tolerance"]
    keys = [f'rods_run.method="{setting["method"]}"', f'rods_run.form="{setting["form"]}"']
    keys += [f"rods_run.rtol={tolerance:g}", f"rods_run.atol={tolerance / 100:g}"]
    if rod_count(scene) >= LEAST_FOR_PRECISION or run["precision"] != setting["precision"]:
        keys.append(f'rods_run.precision="{setting["precision"]}"')
    if run["turning_tolerance"] > 0:
        keys.append("rods_run.turning_tolerance=0")
    if "medium" in scene:
        keys.append(f'medium.field="{setting["field"]}"')
    if setting["table_tolerance"] > 0:
        keys.append(f"medium.table.tolerance={setting['table_tolerance']:g}")
    return keys


def setting_text(setting):
    table = f" {setting['table_tolerance']:g}" if setting["table_tolerance"] > 0 else ""
    precision = f", {setting['precision']}" if setting["precision"] != "full" else ""
    return f"{setting['method']}, {setting['form']}, {setting['field']}{table}{precision}"


def work_text(scene, sample):
    """All that results depend on but for the settings. `sample`: the points of a scan, as bytes."""
    work = {name: scene[name] for name in ("units", "scales", "medium", "coupling", "rods", "rods_random", "rods_run") if name in scene}
    chosen = ("method", "form", "rtol", "atol", "precision", "turning_tolerance", "max_steps")
    work["rods_run"] = {key: value for key, value in work["rods_run"].items() if key not in chosen}
    if "medium" in work and work["medium"]["field"] != "measured":
        work["medium"] = {key: value for key, value in work["medium"].items() if key not in ("field", "table")}
    if "scan" in scene:
        work["scan"] = {"axes": scene["scan"].get("axes", []), "points": hashlib.sha256(sample).hexdigest()}
    return json.dumps(work, sort_keys=True)


def rod_errors(run, reference):
    """How far two solves are apart. A solve holds, a row for the run or for each point of a scan, `solved`, `ending`, `contact_time` (NaN: none)
    and `final_state`, and of a run `path`, states at the output times.

        final_state = max_i |x_i - y_i|,   contact_time = |t - t'|,   path = max over the times up to the earlier end

    A solve of another outcome than the reference is infinitely wrong in all three; `outcome` is the share of those. Of the points of a
    scan the number that 95 % of them keep to; NaN where the reference has nothing to compare.
    """
    same = (run["solved"] > 0) & (reference["solved"] > 0) & (run["ending"] == reference["ending"])
    state = np.full(len(same), np.inf)
    if run["final_state"].shape == reference["final_state"].shape:
        state = np.fmax.reduce(np.abs(run["final_state"] - reference["final_state"]), axis=1, initial=0.0)
    contact = np.abs(run["contact_time"] - reference["contact_time"])
    path = np.full(len(same), np.nan)
    if reference["path"].size:  # of two runs into contact one may have an output time more
        times = min(len(run["path"]), len(reference["path"]))
        path[0] = np.fmax(state[0], np.fmax.reduce(np.abs(run["path"][:times] - reference["path"][:times]), axis=None, initial=0.0))
    numbers = {"final_state": np.where(same, state, np.inf),
               "contact_time": np.where(np.isnan(reference["contact_time"]), np.nan, np.where(same, contact, np.inf)),
               "path": np.where(np.isnan(path), np.nan, np.where(same, path, np.inf))}
    errors = {}
    for name, values in numbers.items():
        known = np.sort(values[~np.isnan(values)])
        errors[name] = float(known[math.ceil(KEPT_BY * (len(known) - 1))]) if len(known) else math.nan
    errors["outcome"] = float(np.mean(~same))
    return {name: errors[name] for name in ERRORS}


class RodsTarget:
    """Settings of rods against a reference on which two independent methods agree."""

    part = "rods"

    def __init__(self, scene, text, path, folder, limit, kind):
        """`scene`: the tables of the scene; `text`: the same as TOML."""
        require_rods(scene, path)
        self.scene, self.text, self.path, self.folder, self.limit, self.kind = scene, text, path, folder, limit, kind
        self.scans, self.fields = "scan" in scene, {}
        self.candidates = [Candidate(setting_keys(scene, setting), setting=setting) for setting in allowed_settings(scene)]
        plain = {**self.candidates[0].setting, "method": "erk", "form": "angle"}
        work = self.solver(plain)
        self.work = work_text(scene, work.sample)
        self.unit = f"{len(work.sample) // _core.point_size} points of the scan" if self.scans else "a run"
        second = "bdf" if self.scans or work.stiffness > STIFF else "adams"
        self.methods = [{**plain, "method": method} for method in ("erk", second)]
        self.answer, self.reference, self.facts = None, {}, {"unit": self.unit, "error": kind}

    def solver(self, setting):
        """The rods made ready to be solved by this setting. Raises InputError for one that the scene does not take."""
        keys = setting_keys(self.scene, setting)
        core = _core.parse_scene(self.text, self.path, keys)
        name, table = setting["field"], setting["table_tolerance"]
        if self.scans or name == "exact" or "medium" not in self.scene:
            return _core.RodsWork(core, self.folder, None)
        if (name, table) not in self.fields:  # a table is made or read once
            self.fields[name, table] = _core.WakeField(core, self.folder)
        return _core.RodsWork(core, self.folder, self.fields[name, table])

    def solve(self, work, limit):
        """One solve as rod_errors wants it, with its CPU time, number of right-hand sides and, if there is no result, the reason."""
        run = work.solve(limit)
        run["failure"] = TOO_LONG if run.pop("stopped") else run["failure"]
        if self.scans:  # the state of a point is its last separation and how far each rod turned
            names, length, time = work.columns()
            column = dict(zip(names, run["values"].T))
            run["time"], run["path"] = column["time"] / time, np.empty((0, 0))
            run["rhs_evaluations"] = int(column["rhs_evaluations"][run["solved"][:, 0] > 0].sum())
            turns = [column[name] for name in names if name.startswith("turn")]
            run["final_state"] = np.column_stack([column["final_separation"] / length, *turns])
        run["solved"] = np.atleast_1d(np.ravel(run.get("solved", not run["failure"])))
        run["ending"] = np.ravel(run["ending"])
        run["contact_time"] = np.where(run["ending"] == CONTACT, run["time"], np.nan)
        return run

    def prepare(self, log):
        """The reference: both methods at rtol 1e-11, 1e-12 and 1e-13, of which the tolerance counts that brings them closest together in
        the kind of error asked for, then in the last state. Errors below ten times their distance are quoted as that."""
        log(f"tradeoff: {len(self.candidates)} settings, each timed on one thread; the work is {self.unit}")
        closest, failure = (math.inf, math.inf), ""
        names = [setting["method"] for setting in self.methods]
        for tolerance in (1e-11, 1e-12, 1e-13):
            runs = []
            for setting in self.methods:
                try:
                    runs.append(self.solve(self.solver({**setting, "tolerance": tolerance}), 10 * self.limit))
                except (InputError, RunError) as error:
                    runs.append({"failure": str(error)})
                failure = f"{setting['method']}: {runs[-1]['failure']}" if runs[-1]["failure"] else failure
            if runs[0]["failure"] or runs[1]["failure"]:
                continue
            apart = rod_errors(*runs)
            asked = apart[self.kind]
            log(f"tradeoff: reference at rtol {tolerance:g}: {names[0]} and {names[1]} agree to {asked:.2g}")
            if self.kind == "outcome" and not asked < 0.5:
                continue  # which of the two is right?
            distance = (0.0 if math.isnan(asked) else asked, apart["final_state"])
            if distance < closest:
                closest, self.answer = distance, runs[0]
                self.least = {name: OVER_AGREEMENT * error for name, error in apart.items()}
                self.reference = {"methods": names, "tolerance": tolerance, "agreement": apart, "least_error_quoted": self.least}
        if self.answer is None:
            why = f"have no answers to compare ({failure})" if failure else "do not agree on the outcome"
            raise RunError(f"tradeoff: no reference: methods {names[0]} and {names[1]} {why}; a shorter run, or a longer --limit, may have one")
        log(f"tradeoff: the reference is {names[0]} at rtol {self.reference['tolerance']:g}; errors below {self.least[self.kind]:.2g} ({self.kind}), "
            "ten times what the two methods agree to, are quoted as that")

    def measure(self, k, candidates):
        candidate = replace(candidates[k])
        run = self.time(candidate)
        candidate.rhs_evaluations = run["rhs_evaluations"]
        candidate.status = run["failure"] or "ok"
        if not run["failure"]:
            errors = {name: np.fmax(error, self.least[name]) for name, error in rod_errors(run, self.answer).items() if not math.isnan(error)}
            candidate.found = [QuantityError.plain(name, "1", error) for name, error in errors.items()]
        return candidate

    def time(self, candidate):
        """Solves again and again: `seconds` becomes the least CPU time of these and earlier repeats, `runs` their number. Returns the last
        solve that came to its end."""
        work, total, turn, answer = self.solver(candidate.setting), 0.0, 0, None
        while turn == 0 or (turn < MOST_REPEATS and candidate.seconds < LONG_RUN and (turn < LEAST_REPEATS or total < TIMED_FOR)):
            run = self.solve(work, self.limit)
            if run["failure"] and candidate.runs > 0:
                break
            answer = run
            candidate.seconds = min(candidate.seconds, run["seconds"])
            candidate.runs += 1
            total += run["seconds"]
            turn += 1
        return answer

    def second_look(self, candidate):
        """What else the machine does comes and goes: a setting that met it has a second chance."""
        if candidate.status == "ok" and candidate.seconds < QUICK_RUN:
            self.time(candidate)

    def refuse_run(self, file):
        other = tomllib.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
        if "rods_run" in other and work_text({**other, "scan": {}}, b"") != work_text({**self.scene, "scan": {}}, b""):
            raise InputError(f"{file.parent}: holds rods of another scene; choose another folder with -o, or --force to write among them")

    def keeps(self, candidate, limit):
        return candidate.status != TOO_LONG or limit >= self.limit

    def rows(self, _, candidate):
        """The row of tradeoff.csv. A kind of error that there is not is an empty cell; without a result all are infinite."""
        if not candidate.tried:
            return []
        errors = {name: math.nan if candidate.status == "ok" else math.inf for name in ERRORS} | {q.quantity: q.bias for q in candidate.found}
        s = candidate.setting
        return [{"method": s["method"], "form": s["form"], "field": s["field"], "tolerance": s["tolerance"], "error": errors[self.kind],
                 "seconds": candidate.seconds, "rhs_evaluations": candidate.rhs_evaluations, "table_tolerance": s["table_tolerance"] or math.nan,
                 "precision": s["precision"], **errors, "repeats": candidate.runs, "status": candidate.status}]
