"""Runs scenes and keeps what is done: the same command goes on where it was stopped."""

import json
import math
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

SOURCE = Path(__file__).resolve().parents[2]
A = 4e-4         # m, radius of a bead
PERIOD = 5e-3    # s, of the plates
COST = 1.1e-4    # CPU s a bead and simulated second, with some margin
SOUND_COST = 6   # times that where currents are measured
HEAD = "schema = 1\n[granular]\n"


class Lab:
    def __init__(self, options, folder):
        self.program, self.threads, self.quick, self.folder = str(Path(options.program).absolute()), options.j, options.quick, Path(folder).resolve()
        self.folder.mkdir(parents=True, exist_ok=True)

    def seconds(self, value):
        return max(3.0, value / 20) if self.quick else value

    def count(self, runs):
        return min(runs, 2) if self.quick else runs

    def make(self, name, scene, *settings, seed=None):
        """The run directory of a scene: its text, or a shipped one's name."""
        path = self.folder / f"{name}.toml"
        text = (SOURCE / "scenes" / scene).read_text() if scene.endswith(".toml") else scene
        asked = text + "".join(f"# -s {one}\n" for one in settings) + (f"# --seed {seed}\n" if seed is not None else "")
        same = path.is_file() and path.read_text() == asked
        out = self.folder / name
        stages = {"dem": "summary.json"} | ({"measure": "measure.json"} if "[measure]" in text else {})
        if same and is_finished(out, stages):
            return out
        path.write_text(asked)
        began = time.monotonic()
        for stage in stages:
            fresh = [] if same or stage != "dem" else ["--force"]
            self.call(stage, path, "-o", out, "-j", self.threads, "--quiet", *fresh, *(f"-s{one}" for one in settings),
                      *([] if seed is None else ["--seed", seed]))
        print(f"  ({name}: {time.monotonic() - began:.0f} s)", file=sys.stderr, flush=True)
        return out

    def call(self, *arguments):
        command = [self.program, *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, cwd=self.folder, check=False)
        if done.returncode != 0:
            sys.exit(f"{' '.join(command)}: exit code {done.returncode}\n{done.stderr}")

    def fit(self, name, text):
        """The result of a fit: fit.json."""
        path, out = self.folder / f"{name}.toml", self.folder / name
        if not (path.is_file() and path.read_text() == text and is_finished(out, {"fit": "fit.json"})):
            path.write_text(text)
            self.call("fit", path, "-o", out, "--quiet", "--force")
        return json.loads((out / "fit.json").read_text())


def is_finished(folder, stages):
    """Whether the last command in it ended well, and the result of each stage is there."""
    record = folder / "provenance.json"
    return (record.is_file() and json.loads(record.read_text())["status"] == "finished"
            and all((folder / result).is_file() for result in stages.values()))


def bed(duration, keys="", measure="", rods="", frames=0.1, runs=1, formats="[]", box="fit", equilibrate=2.0):
    """A bed of density 0.80 in the box of an unstrained crystal."""
    density = "" if "phi_b" in keys else "phi_b = 0.80\n"
    return (f'{HEAD}{density}box = "{box}"\nstart = "lattice"\nequilibrate = "{equilibrate} s"\nduration = "{duration:.6g} s"\nruns = {runs}\n{keys}'
            f'[granular.output]\nformats = {formats}\nlast_period = false\nframes = "{frames} s"\n{rods}'
            + (f"[measure]\n{measure}" if measure else ""))


def rod(speed=None, x=20, y=39):
    held = "" if speed is None else f'imposed_speed = "{speed} mm/s"\n'
    return f'[[granular.rods]]\nkind = "motile"\nposition = ["{x} a", "{y} a"]\n{held}'


def told(folder, name="measure"):
    return json.loads((folder / f"{name}.json").read_text())


def estimate(entry):
    return tuple(math.nan if entry[key] is None else entry[key] for key in ("value", "error"))


def mean(values):
    """Mean and standard error of independent values."""
    values = np.asarray(values, dtype=float)
    return values.mean(), values.std(ddof=1) / math.sqrt(len(values)) if len(values) > 1 else math.nan


def weighted(pairs):
    """Mean of (value, error) with weights 1/error^2."""
    values, errors = (np.array(column, dtype=float) for column in zip(*pairs))
    if len(values) == 1 or not np.isfinite(errors).all():
        return values.mean(), errors[0] if len(values) == 1 else math.nan
    weights = 1 / errors**2
    return (weights * values).sum() / weights.sum(), weights.sum() ** -0.5


def ratio(top, bottom):
    """Of two independent (value, error)."""
    value = top[0] / bottom[0]
    return value, abs(value) * math.hypot(top[1] / top[0], bottom[1] / bottom[0])


def combined(folders, kind, name):
    """Mean of runs alike; its error from their scatter, of fewer than four from their own errors."""
    found = [estimate(measured[name]) for measured in (told(folder).get(kind, {}) for folder in folders) if name in measured]
    if len(found) >= 4:
        return mean([value for value, _ in found])
    return weighted(found) if found else (math.nan, math.nan)


def text(pair, scale=1.0, digits=2):
    value, error = pair
    if not math.isfinite(value):
        return "-"
    return f"{scale * value:.{digits}f} +- {scale * error:.{digits}f}" if math.isfinite(error) else f"{scale * value:.{digits}f}"


def table(title, head, rows):
    print(f"\n### {title}\n\n| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(str(cell) for cell in row) + " |")
    print(flush=True)
