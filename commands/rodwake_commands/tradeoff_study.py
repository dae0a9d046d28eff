"""What `rodwake tradeoff` measured: candidates with their cost and errors, which of them to take, and the files that keep them."""

import csv
import io
import json
import math
import shutil
import sys
import time
from dataclasses import asdict, dataclass, field, replace

from rodwake import InputError, RunError, __version__, _core

MOST_RUNS = 10**9


@dataclass
class QuantityError:
    """A quantity as one candidate computes it, against the reference. Of rods, fits and field maps the value is an error already."""

    quantity: str
    unit: str
    value: float = math.inf
    error: float = 0.0  # standard error of the value
    scatter: float = 0.0  # standard deviation of one run; 0: each run gives the same
    bias: float = math.inf  # difference from the reference
    bias_error: float = 0.0  # standard error of the bias
    scale: float = 1.0  # 100 %: the size of the reference's value, or 1

    @classmethod
    def plain(cls, quantity, unit, error):
        """A quantity that is an error itself."""
        return cls(quantity, unit, value=float(error), bias=float(error))


@dataclass
class Candidate:
    """One choice of keys, and what it was measured to cost and to compute."""

    keys: list  # as for -s: 'granular.time_step="1e-05 s"'
    seconds: float = math.inf  # CPU time of one run on one thread; of rods the least of `runs`
    runs: int = 0
    found: list = field(default_factory=list)
    status: str = "ok"  # or why there is no result
    setting: dict = field(default_factory=dict)  # of rods: the columns of tradeoff.csv that the keys stand for
    rhs_evaluations: int = 0  # of rods

    @property
    def tried(self):
        return self.runs > 0 or self.status != "ok"

    def find(self, quantity):
        """The quantity, if the candidate has a result."""
        return next((q for q in self.found if q.quantity == quantity), None) if self.status == "ok" else None


# --- which candidate to take --------------------------------------------------------------------------------------------


@dataclass
class Choice:
    """A candidate and its number of runs."""

    candidate: Candidate
    found: QuantityError
    runs: int = 1

    @property
    def bias(self):
        """b of b^2 = max(0, (q - q_ref)^2 - e^2 - e_ref^2): in the mean, the square of a measured difference exceeds that of the bias
        by the squared standard errors of both values."""
        return math.sqrt(max(0.0, self.found.bias**2 - self.found.bias_error**2))

    @property
    def statistical(self):
        return self.found.scatter / math.sqrt(self.runs)

    @property
    def error(self):
        """error^2 = b^2 + s^2/n, s the standard deviation of one run: runs reduce the second part only."""
        return math.hypot(self.bias, self.statistical)

    @property
    def seconds(self):
        return self.runs * self.candidate.seconds


def choices(candidates, quantity):
    """One run of each candidate that has a finite error of the quantity."""
    found = [(candidate, candidate.find(quantity)) for candidate in candidates]
    return [Choice(candidate, q) for candidate, q in found if q is not None and math.isfinite(q.bias)]


def cheapest(candidates, quantity, error):
    """The choice that takes the least time to this error, with n = ceil(s^2/(error^2 - b^2)) runs; None if all are biased by more."""
    enough = []
    for choice in choices(candidates, quantity):
        if choice.found.scatter > 0:
            room = error**2 - choice.bias**2
            runs = math.ceil(choice.found.scatter**2 / room) if room > 0 else math.inf
            if runs <= MOST_RUNS:
                enough.append(Choice(choice.candidate, choice.found, max(runs, 1)))
        elif choice.bias <= error:  # compared without squares: errors as small as 1e-200 may be asked for
            enough.append(choice)
    return min(enough, key=lambda choice: choice.seconds, default=None)


def most_accurate(candidates, quantity, seconds):
    """The choice of the least error within this time, with as many runs as fit into it; None if no run does."""
    possible = []
    for choice in choices(candidates, quantity):
        if choice.candidate.seconds <= seconds:
            runs = min(seconds / choice.candidate.seconds, MOST_RUNS) if choice.found.scatter > 0 else 1
            possible.append(Choice(choice.candidate, choice.found, int(runs)))
    return min(possible, key=lambda choice: (choice.error, choice.seconds), default=None)


def pareto_front(candidates, quantity):
    """The choices of one run that no other one beats in both time and error, by time."""
    front = []
    for choice in sorted(choices(candidates, quantity), key=lambda choice: (choice.seconds, choice.error)):
        if not front or choice.error < front[-1].error:
            front.append(choice)
    return front


def quantities(candidates):
    return list(dict.fromkeys(q.quantity for candidate in candidates for q in candidate.found))


def reference_quantity(part, candidates, quantity):
    """The quantity as the first candidate has it, whose scale is that of the reference."""
    for candidate in candidates:
        if candidate.find(quantity):
            return candidate.find(quantity)
    if not quantities(candidates):
        raise InputError(f"no candidate for the {part} gave a result: {candidates[0].status if candidates else 'none was tried'}")
    raise InputError(f'"{quantity}" is not measured of this {part}; there is {", ".join(quantities(candidates))}')


# --- the study of one part of a scene, and its folder -------------------------------------------------------------------


class Study:
    """The candidates of a target (tradeoff_rods.py, tradeoff_parts.py), measured one by one into a folder.

    A target has: part, work (a text that differs where results would), reference (a text), candidates (untried), facts (more for the JSON
    file), prepare(log), which makes the reference, measure(k, candidates), which returns candidate k with its results,
    second_look(candidate), keeps(candidate, limit): whether a result of an earlier command with that --limit counts, rows(k, candidate)
    of the CSV file, and refuse_run(file), which raises InputError if the folder holds a run of another scene.
    """

    def __init__(self, target, folder, limit):
        self.target, self.folder, self.limit, self.candidates, self.finished = target, folder, limit, list(target.candidates), False
        self.json, self.csv = (folder / f"{'tradeoff' if target.part == 'rods' else 'ways'}.{ending}" for ending in ("json", "csv"))

    def take_up(self, force):
        """Takes over what an earlier command left here of the same work. Raises InputError for a folder that holds something else."""
        for path in (self.folder, self.json, self.csv, self.folder / "log.txt", self.folder / "figures"):
            _core.refuse_link(path)
        if self.folder.exists() and not self.folder.is_dir():
            raise InputError(f"{self.folder}: is a file; -o names the folder for the results")
        if force or not self.folder.is_dir():
            return
        if not self.json.exists():
            ours = ("tradeoff", "ways", "part-", "rodwake.lock", "log.txt")
            if not (self.folder / "provenance.json").exists() and not all(path.name.startswith(ours) for path in self.folder.iterdir()):
                raise InputError(f"{self.folder}: holds files that are not a rodwake run; choose another folder with -o, or --force to write "
                                 "among them")
            self.target.refuse_run(self.folder / "scene.toml")
            return
        try:
            earlier = json.loads(self.json.read_text(encoding="utf-8"))
            work, limit, finished = earlier["work"], earlier["limit"], earlier["finished"]
            known = [_read(Candidate, {**way, "found": [_read(QuantityError, found) for found in way["found"]]}) for way in earlier["ways"]]
        except (ValueError, LookupError, TypeError) as error:
            raise InputError(f"{self.json}: cannot be read ({type(error).__name__}: {error}); --force measures anew") from error
        if work != self.target.work:
            raise InputError(f"{self.folder}: holds the measurement of another scene; choose another folder with -o, or --force to replace it")
        kept = {tuple(way.keys): way for way in known if way.tried and self.target.keeps(way, limit)}
        self.candidates = [kept.get(tuple(candidate.keys), candidate) for candidate in self.candidates]
        self.finished = finished and all(candidate.tried for candidate in self.candidates)
        self.limit = limit if self.finished else self.limit

    def clear(self):
        """Removes what an earlier command measured here, runs of beds too."""
        for path in (self.json, self.csv):
            path.unlink(missing_ok=True)
        if self.target.part != "rods":
            shutil.rmtree(self.folder / "ways", ignore_errors=True)

    def measure(self, log, progress):
        """Measures the candidates that are not known yet. Files are written once a second and when this ends, in whatever way."""
        self.target.prepare(log)
        written = 0.0
        try:
            for k, candidate in enumerate(self.candidates):
                if not candidate.tried:
                    try:
                        self.candidates[k] = self.target.measure(k, self.candidates)
                    except (InputError, RunError) as error:
                        self.candidates[k] = replace(candidate, status=str(error))
                progress(k + 1, len(self.candidates))
                if time.monotonic() - written > 1.0:
                    self.save()
                    written = time.monotonic()
            for candidate in self.candidates:
                self.target.second_look(candidate)
            self.finished = True
        finally:
            if any(candidate.tried for candidate in self.candidates):
                self.save()

    def save(self):
        document = {"of": self.target.part, "work": self.target.work, "reference": self.target.reference, "limit": self.limit,
                    "finished": self.finished, **self.target.facts, "version": __version__, "cpu": _core.cpu,
                    "ways": [asdict(candidate) for candidate in self.candidates]}
        _core.write_atomically(self.json, json.dumps(_finite(document), indent=1, ensure_ascii=False) + "\n")
        _core.write_atomically(self.csv, _csv([row for k, candidate in enumerate(self.candidates) for row in self.target.rows(k, candidate)]))
        _core.write_manifest(self.folder)


def _finite(value):
    """JSON has neither NaN nor infinity: both are null."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _read(kind, entry):
    return kind(**{name: math.inf if value is None else value for name, value in entry.items()})


def _csv(rows):
    """Words have no line ends and no double quotes in them, NaN is an empty cell."""
    def cell(name, value):
        if isinstance(value, float):
            return "" if math.isnan(value) else f"{value:.9g}" if name in ("value", "scale") else f"{value:.6g}"
        return value.replace("\n", " ").replace('"', "'") if isinstance(value, str) else value
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(rows[0])
    table.writerows([cell(name, value) for name, value in row.items()] for row in rows)
    return text.getvalue()


class Messages:
    """Messages on the terminal and in the log.txt of a folder; below them, how far the work is."""

    def __init__(self, request, folder):
        self.quiet, self.file, self.json, self.begin = request.flag("quiet"), folder / "log.txt", request.text("log_json"), None
        self.shown, self.wipe = time.monotonic(), "\r\033[K" if sys.stderr.isatty() else ""

    def log(self, text):
        with open(self.file, "a", encoding="utf-8") as file:
            file.write(f"{time.strftime('%Y-%m-%d %H:%M:%S')} info: {text}\n")
        if self.json:
            with open(self.json, "a", encoding="utf-8") as file:
                file.write(json.dumps({"time": time.strftime("%Y-%m-%dT%H:%M:%S%z"), "level": "info", "message": text}) + "\n")
        if not self.quiet:
            print(f"{self.wipe}{text}", file=sys.stderr)

    def progress(self, done, count):
        """A line that redraws itself on a terminal, one every ten seconds elsewhere."""
        now = time.monotonic()
        self.begin = self.begin or (now, done)
        if not self.quiet and done > self.begin[1] and now - self.shown > (0.2 if self.wipe else 10.0):
            self.shown = now
            each = (now - self.begin[0]) / (done - self.begin[1])
            left = f"tradeoff: {done} of {count} candidates, {each * (count - done):.0f} s left"
            print(f"{self.wipe}{left}", end="" if self.wipe else "\n", file=sys.stderr, flush=True)
