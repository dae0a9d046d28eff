"""Candidates to compute a bed, a fit or the map of a field, and how each is run, timed and compared."""

import csv
import hashlib
import json
import logging
import math
from dataclasses import asdict
from pathlib import Path

import numpy as np
import rodwake
from rodwake import InputError, RunError, _core
from rodwake_commands.tradeoff_study import Candidate, QuantityError

LEAST_RUNS, MOST_RUNS = 4, 200
REFERENCE_LIMITS = 4.0  # limits that the reference of a bed may take, whose error is in every bias
BEHIND = -8.0  # a; where `wake` is taken, behind the ends of the rod
STEPS = (0.125, 0.25, 0.5, 1.0)  # of the scene's time step; the first is the reference. Twice the default trips the guard of a bed
DURATIONS = (0.5, 0.25)
RARER = 4.0  # between the frames that are measured
BED_COLUMNS = {"T_xy": "m^2/s^2", "T_z": "m^2/s^2", "psi6": "1"}  # of runs.csv
LOCAL, GLOBAL = ("slsqp", "lbfgs", "mma", "bobyqa", "nelder-mead"), ("mlsl", "crs", "isres", "direct-l")
BOUNDED = {"eta", "xi", "alpha", "D_r", "D_t"}  # fitted within bounds even if the scene gives none
MANY_STARTS, REFERENCE_STARTS = 10, 50
LONG_FIT, REPEATS = 0.5, 3  # s; longer fits are not repeated
MAP_BUDGET = 0.1  # s, of repeats of a map
LEAST_MAP_ERROR = 2e-13  # what the exact field keeps to (studies/reports/elastic.md, "Field of one rod"); no smaller error is quoted
TABLE_TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10)


class Target:
    """What the parts have in common: the scene as TOML, candidates that are keys of it, and no second look."""

    def __init__(self, scene, text, path, folder, limit):
        self.scene, self.text, self.path, self.folder, self.limit = scene, text, path, folder, limit

    def prepare(self, log):
        self.log = log
        log(f"tradeoff: {len(self.candidates)} candidates to compute the {self.part}; the reference is {self.reference}")

    facts = {}

    def second_look(self, candidate):
        pass

    def refuse_run(self, file):
        pass

    def rows(self, k, candidate):
        """Rows of ways.csv, one a quantity."""
        nothing = dict.fromkeys(QuantityError.__dataclass_fields__, math.nan) | {"quantity": "", "unit": ""}
        head = {"way": k, "keys": " ".join(candidate.keys), "seconds": candidate.seconds, "runs": candidate.runs}
        return [{**head, **q, "status": candidate.status} for q in ([asdict(q) for q in candidate.found] or [nothing])]

    def with_keys(self, keys):
        return _core.parse_scene(self.text, self.path, keys)


class BedTarget(Target):
    """Time step, duration and how often a bed is measured. Each candidate is an ensemble of its own, with seeds of its own."""

    part = "bed"

    def __init__(self, scene, text, path, folder, limit, threads):
        super().__init__(scene, text, path, folder / "ways", limit)
        if "granular" not in scene or scene.get("measure", {}).get("trajectory"):
            raise InputError(f"{path}: no [granular] table, so there is no bed whose cost and error could be measured")
        logging.getLogger("rodwake").addHandler(logging.NullHandler())
        logging.getLogger("rodwake").propagate = False
        self.threads, bed, measure = threads, scene["granular"], scene.get("measure")

        # The bed and its measures alone, without files that nobody looks at. Measures follow the frames, whose interval must not follow
        # the duration, which will change.
        frames = bed["output"].get("frames", bed["duration"] / 100)
        others = [name for name in scene if name not in ("schema", "title", "units", "granular", "measure")]
        output = {"frames": repr(frames), "formats": "[]", "last_period": "false"}
        self.bare = [f"{name}=" for name in others] + [f"granular.output.{name}={value}" for name, value in output.items()]
        interval = measure.get("interval", frames) if measure else None
        self.step = _core.bed_time_step(self.with_keys(self.bare))
        work = {"granular": bed, "measure": measure, "frames": frames}
        self.work = json.dumps(work, sort_keys=True)
        self.reference = f"a time step of {STEPS[0] * self.step:.3g} s"

        start, block = ((measure or {}).get(key, 0.0) for key in ("from", "block"))
        self.candidates = [self.candidate(step, 1.0, interval) for step in STEPS]
        self.candidates += [self.candidate(1.0, part, interval) for part in DURATIONS if part * bed["duration"] >= start + 2 * block]
        if measure:
            self.candidates.append(self.candidate(1.0, 1.0, RARER * interval))

    def candidate(self, step, duration, interval):
        keys = [f'granular.time_step="{step * self.step:.6g} s"', f'granular.duration="{duration * self.scene["granular"]["duration"]:.6g} s"']
        return Candidate(keys + ([f'measure.interval="{interval:.6g} s"'] if interval is not None else []), seconds=0.0)

    def keeps(self, candidate, limit):
        return limit == self.limit  # which decides the number of runs

    def measure(self, k, candidates):
        """A few runs first, to know what one costs; then as many as the limit pays for. Those that an earlier command made count."""
        candidate, folder, failure = Candidate(candidates[k].keys), self.folder / str(k), ""
        seed = (self.scene["granular"]["seed"] + k + 1) % 2**63
        limit = self.limit * (REFERENCE_LIMITS if k == 0 else 1.0)
        runs = self.runs(folder)
        for _ in range(2):
            count = len(runs.get("run", ()))
            affordable = round(min(max(limit / np.mean(runs["cpu_seconds"]), LEAST_RUNS), MOST_RUNS)) if count else LEAST_RUNS
            if affordable <= count or failure:
                break
            core = self.with_keys([*self.bare, *candidate.keys, f"granular.seed={seed}", f"granular.runs={affordable}"])
            stages = ["granular", "measure"] if "measure" in self.scene else ["granular"]
            try:
                rodwake.Scene.parse(core.to_toml(), self.path).run(folder, stages=stages, threads=self.threads)
            except RunError as error:  # a measure that cannot be had is not among the quantities, and no more
                failure = "" if ": the run failed: measure" in str(error) else str(error)
            runs = self.runs(folder, finished=False)

        candidate.runs = len(runs.get("run", ()))
        if candidate.runs:
            candidate.seconds = float(np.mean(runs["cpu_seconds"]))
        if candidate.runs < LEAST_RUNS:
            candidate.status = failure or "fewer than 4 runs came to their end"
            return candidate
        candidate.found = bed_quantities(folder, runs, self.scene["granular"].get("rods", []))
        reference = candidate.found if k == 0 else candidates[0].found
        candidate.found = biases(candidate.found, reference)
        return candidate

    def runs(self, folder, finished=True):
        """The columns of runs.csv; none if the ensemble there is unfinished, or there is none."""
        try:
            record = json.loads((folder / "provenance.json").read_text(encoding="utf-8"))
            if finished and record["status"] != "finished":
                return {}
            with open(folder / "runs.csv", encoding="utf-8") as table:
                rows = list(csv.DictReader(table))
        except FileNotFoundError:
            return {}
        return {name: np.array([float(row[name] or "nan") for row in rows]) for name in rows[0]} if rows else {}


def bed_quantities(folder, runs, rods):
    """Means over the runs with their standard errors: from runs.csv, from the profile on the axis behind the rod (U_x), and whatever has
    an error in measure.json. The standard deviation of one run is s = e sqrt(runs)."""
    count, found = len(runs["run"]), []

    def add(name, unit, value, error):
        if math.isfinite(value) and math.isfinite(error):
            found.append(QuantityError(name, unit, float(value), float(error), scatter=float(error) * math.sqrt(count)))

    def add_mean(name, unit, sample):
        add(name, unit, np.mean(sample), np.std(sample, ddof=1) / math.sqrt(count))

    def add_estimates(node, name):
        if isinstance(node, dict) and {"value", "error"} <= node.keys():
            if all(isinstance(node[key], (int, float)) for key in ("value", "error")):
                add(name, "of measure.json", node["value"], node["error"])
        elif isinstance(node, dict):
            for key in sorted(node):
                add_estimates(node[key], f"{name}.{key}" if name else key)

    motile = [f"mean_speed{k}" for k, rod in enumerate(rods) if rod["kind"] == "motile" and "imposed_speed" not in rod]
    speeds = [runs[name] for name in motile if name in runs]
    if speeds:
        add_mean("rod_speed", "m/s", np.mean(speeds, axis=0))
    for name, unit in BED_COLUMNS.items():
        add_mean(name, unit, runs[name])
    if rods and "imposed_speed" in rods[0]:
        add_mean("force", "N", runs["force0"])
    if "separation_change" in runs:
        add_mean("separation_change", "m", runs["separation_change"])
    profile = folder / "profile_Ux_x.csv"
    if profile.exists():
        with open(profile, encoding="utf-8") as table:
            rows = list(csv.DictReader(table))
        nearest = min(rows, key=lambda row: abs(float(row["x"]) - BEHIND))
        if "sigma" in nearest and abs(float(nearest["x"]) - BEHIND) <= 1.0:
            add("wake", "a", float(nearest["value"]), float(nearest["sigma"] or "nan"))
    if (folder / "measure.json").exists():
        add_estimates(json.loads((folder / "measure.json").read_text(encoding="utf-8")), "")
    return found


def biases(found, reference):
    """The quantities that the reference has too: bias q - q_ref, its error sqrt(e^2 + e_ref^2), scale |q_ref|. The reference itself has
    no bias, and that is known to its own error."""
    compared = []
    for q in found:
        same = next((other for other in reference if other.quantity == q.quantity), None)
        if same is not None:
            q.bias = 0.0 if same is q else q.value - same.value
            q.bias_error = q.error if same is q else math.hypot(q.error, same.error)
            q.scale = abs(same.value)
            compared.append(q)
    return compared


class FitTarget(Target):
    """The search, with and without polish, from one and from many starts, and intervals from the curvature or the likelihood."""

    part = "fit"
    reference = "the better one of slsqp and nelder-mead, 50 starts each, polished, intervals by likelihood"

    def __init__(self, scene, text, path, folder, limit, threads):
        super().__init__(scene, text, path, folder, limit)
        if "fit" not in scene:
            raise InputError(f"{path}: no [fit] table, so there is no fit whose cost and error could be measured")
        self.threads, self.best, fit = threads, None, scene["fit"]
        tables = [table for kind in ("profiles", "trajectories", "maps") for table in fit.get(kind, [])]
        digest = hashlib.sha256()
        for name in [name for table in tables for name in table.get("files", [table.get("file")])]:
            found = next((place / name for place in (folder, Path(path).parent, Path()) if (place / name).is_file()), None)
            if found is None:
                raise InputError(f"{path}: {name}: no such file in {folder}, in the folder of the scene or in the working folder")
            digest.update(found.read_bytes())
        self.work = json.dumps({"fit": fit, "data": digest.hexdigest()}, sort_keys=True)
        self.names = ", ".join(f'"{name}"' for name in fit["parameters"])
        tracks = fit.get("trajectories", [])
        free_start = any(track["start_poses"] == "fitted" or (track["start_poses"] == "auto" and "sigma_position" in track) for track in tracks)
        bounded = set(fit["parameters"]) <= BOUNDED | fit.get("bounds", {}).keys() and not free_start
        searches = [(method, polish, starts, False) for method in LOCAL for polish in (True, False) for starts in (1, MANY_STARTS)]
        searches += [(method, polish, 1, False) for method in GLOBAL for polish in (True, False) if bounded]  # they search the whole box
        searches += [("slsqp", True, starts, True) for starts in (1, MANY_STARTS)]
        self.candidates = [Candidate(self.keys(*search), seconds=0.0) for search in searches]

    def keys(self, method, polish, starts, likelihood):
        names = self.names if likelihood else ""
        return [f'fit.method="{method}"', f"fit.polish={str(polish).lower()}", f"fit.starts={starts}", f"fit.likelihood=[{names}]"]

    def keeps(self, candidate, limit):
        return not candidate.status.startswith("took more than") or limit >= self.limit

    def solve(self, keys, threads, limit):
        """The fit with these keys: seconds, failure, objective, and as estimates a row (value, standard error, ends of the 95 % interval) for
        each parameter."""
        fit = _core.fit_scene(self.with_keys(keys), self.folder, threads, limit)
        reasons = {"failed": f"failed: {fit.reason}", "interrupted": f"took more than {limit:g} s"}
        failure = reasons.get(fit.termination, "")
        answer = {"seconds": fit.seconds, "failure": failure, "objective": fit.objective}
        if not failure:
            ends = fit.likelihood(lambda value, chi2, low, high: (-math.inf if low is None else low, math.inf if high is None else high))
            rows = fit.estimates(lambda name, value, error, low, high, free, bound: (value, error, *ends.get(name, (low, high))) if free else None)
            answer["estimates"] = np.array([row for row in rows if row])
        return answer

    def make_reference(self):
        """The better one of two searches that have nothing in common but the polish."""
        answers = []
        for method in ("slsqp", "nelder-mead"):
            keys = [*self.keys(method, True, REFERENCE_STARTS, True), "fit.tolerance=1e-13"]
            answers.append(self.solve(keys, self.threads, math.inf))
            if answers[-1]["failure"]:
                raise RunError(f"no reference: {answers[-1]['failure']}")
        self.best, other = sorted(answers, key=lambda answer: answer["objective"])
        self.log(f"tradeoff: two searches of {REFERENCE_STARTS} starts agree to {fit_errors(other, self.best)['optimum']:.2g} standard errors")

    def measure(self, k, candidates):
        if self.best is None:
            self.make_reference()
        keys = candidates[k].keys
        answer = self.solve(keys, 1, self.limit)
        candidate = Candidate(keys, answer["seconds"], runs=1, status=answer["failure"] or "ok")
        for _ in range(REPEATS - 1):
            if candidate.seconds < LONG_FIT and candidate.status == "ok":
                candidate.seconds = min(candidate.seconds, self.solve(keys, 1, self.limit)["seconds"])
        if candidate.status == "ok":
            units = {"optimum": "standard errors", "interval": "half widths", "objective": "of chi2"}
            errors = fit_errors(answer, self.best)
            candidate.found = [QuantityError.plain(name, units[name], error) for name, error in errors.items() if not math.isnan(error)]
        return candidate


def fit_errors(answer, reference):
    """Of the parameters p_i with standard errors e_i and intervals [low_i, high_i]; the reference is starred.

        optimum   = max_i |p_i - p_i*|/e_i*              in standard errors
        interval  = max_i max(|low - low*|, |high - high*|)/((high* - low*)/2)    NaN if the reference has none
        objective = max(0, chi2 - chi2*)
    """
    (value, _, low, high), (best, error, least, most) = np.transpose(answer["estimates"]), np.transpose(reference["estimates"])
    known = np.isfinite(error) & (error > 0)
    optimum = float(np.fmax.reduce(np.abs(value - best)[known] / error[known], initial=0.0))
    bounded = np.isfinite(least) & np.isfinite(most)
    shift = np.fmax(np.abs(low - least), np.abs(high - most))[bounded] * 2 / (most - least)[bounded]
    return {"optimum": optimum, "interval": float(shift.max()) if shift.size else math.nan,
            "objective": max(0.0, answer["objective"] - reference["objective"])}


class FieldTarget(Target):
    """The exact field of a rod and tables of it, at the points of [field]."""

    part, reference = "field", "the exact field (docs/validation.md)"

    def __init__(self, scene, text, path, folder, limit):
        super().__init__(scene, text, path, folder, limit)
        medium = scene.get("medium", {})
        if "field" not in scene or not medium:
            raise InputError(f"{path}: no [field] table, so there is no map whose cost and error could be measured")
        if medium.get("fitted") or medium["field"] == "measured":
            raise InputError(f"{path}: the field of this scene is measured or fitted, so there are no settings to compare; give eta and xi in "
                             "[medium]")
        fixed = {key: value for key, value in medium.items() if key not in ("field", "table")}
        self.work = json.dumps({"medium": fixed, **{name: scene[name] for name in ("units", "scales", "field") if name in scene}}, sort_keys=True)
        box = medium.get("periodic")
        tables = TABLE_TOLERANCES if not isinstance(box, list) or box[0] == box[1] else ()  # tables know square boxes only
        self.candidates = [Candidate(['medium.field="exact"'], seconds=0.0)]
        self.candidates += [Candidate(['medium.field="table"', f"medium.table.tolerance={tolerance:g}"], seconds=0.0) for tolerance in tables]
        self.points, self.exact = map_points(scene["field"]), None

    def keeps(self, candidate, limit):
        return True

    def measure(self, k, candidates):
        if self.exact is None:
            _, self.exact = self.map(['medium.field="exact"'], 0.0)
        seconds, values = self.map(candidates[k].keys, MAP_BUDGET)
        found = [QuantityError.plain(name, "1", error) for name, error in map_errors(values, self.exact).items()]
        return Candidate(candidates[k].keys, seconds, 1, found)

    def map(self, keys, budget):
        core = self.with_keys(keys)
        return _core.timed_map(_core.WakeField(core, self.folder), core, *self.points, budget)


def map_points(field):
    """x and y of the grid and the cuts of [field]."""
    x, y = [], []
    if field.get("y"):
        grid = np.meshgrid(np.linspace(*field["x"], field["nx"]), np.linspace(*field["y"], field["ny"]))
        x, y = [grid[0].ravel()], [grid[1].ravel()]
    for cut in field.get("cuts", []):
        along, across = np.linspace(cut["from"], cut["to"], cut["count"]), np.full(cut["count"], float(cut["at"]))
        x.append(along if cut["along"] == "x" else across)
        y.append(across if cut["along"] == "x" else along)
    return np.concatenate(x), np.concatenate(y)


def map_errors(values, exact):
    """The largest |a - b|/|b| over the points, of displacement, strain and the polar vectors: near the rod the field is large, far away
    small, and both are read from a map. Rows of the exact field are NaN at the rod itself."""
    errors, regular = {}, ~np.isnan(exact[:, 0])
    for name, columns in (("displacement", slice(0, 2)), ("strain", slice(2, 5)), ("gradients", slice(5, 9))):
        a, b = values[regular, columns], exact[regular, columns]
        size = np.linalg.norm(b, axis=1)
        relative = np.linalg.norm(a - b, axis=1)[size > 0] / size[size > 0]
        errors[name] = math.inf if np.isnan(relative).any() else max(LEAST_MAP_ERROR, float(relative.max(initial=0.0)))
    return errors
