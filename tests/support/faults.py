"""A system on which one call fails (faulty_system.cpp), verbs at work on it, and what is to be true of them afterwards."""

import errno
import importlib.machinery
import importlib.util
import json
import os
import re
import shutil
import subprocess
from pathlib import Path

from beds import BED
from fits import FIT, TRUE, profile_text
from rodwake import PAIR, PROGRAM, SOURCE
from scans import CROSSING, axes

_loader = importlib.machinery.SourceFileLoader("result_hashes", str(SOURCE / "tools/result_hashes"))
result_hashes = importlib.util.module_from_spec(importlib.util.spec_from_loader("result_hashes", _loader))
_loader.exec_module(result_hashes)

CALLS = ("write", "fsync", "rename", "open", "unlink", "malloc")
HALF = -1  # a write that comes through by half
ERRORS = {"write": (errno.EIO, errno.ENOSPC, HALF), "fsync": (errno.EIO,), "rename": (errno.EACCES,), "open": (errno.EMFILE,),
          "unlink": (errno.EPERM,), "malloc": (errno.ENOMEM,)}
# A destructor, a signal and an uncaught exception are no way to end. (h5py prints a traceback of its own, and goes on, where its
# clean-up lacks memory.)
UNSEEMLY = re.compile(r"terminate called|(?<!_objects.ObjectID.__dealloc__'\n)Traceback \(most recent|core dumped|Segmentation|AddressSanitizer")
# Written as the run goes, or with the time it took (resume points). A ledger is compared by scan.csv, which is made of it.
PASSED_OVER = re.compile(r"log\.txt$|\.lock$|points\.log|provenance\.json$|\.rwc")

SHORT_PAIR = PAIR.replace("t_end = 60.0", "t_end = 8.0").replace("output_interval = 10.0", "output_interval = 1.0")
SHORT_BED = BED.replace('duration = "0.2 s"', 'duration = "0.05 s"').replace('"0.005 s"', '"0.01 s"')
MEASURE = '[measure]\norder = true\norder_interval = "0.01 s"\nblock = "0.02 s"\n'
FIELD = "schema = 1\n[medium]\neta = 1.0\nalpha = 1.0\n[field]\nx = [-5, 3]\ny = [-2, 2]\nnx = 9\nny = 5\n[[field.cuts]]\nfrom = -5\nto = 3\ncount = 9\n"


def profile():
    places = [k + 0.5 for k in range(-39, 20) if abs(k) > 3]
    return profile_text(places, [TRUE["f_over_mu"] / (1.0 + abs(x)) ** 0.5 * (1.0 if x < 0 else 0.2) for x in places], 0.01)


# Verb: the scene, files beside it, verbs that come before, and the program in which calls fail.
VERBS = {
    "rods": (SHORT_PAIR, {}, [], "rodwake"),
    "field": (FIELD, {}, [], "rodwake"),
    "scan": (CROSSING + '[scan]\ndesign = "adaptive"\nresolution = 8\naudit = 10\ntrajectories = 2\n' + axes(4), {}, [], "rodwake"),
    "dem": (SHORT_BED, {}, [], "rodwake"),
    "measure": (SHORT_BED + MEASURE, {}, ["dem"], "rodwake"),
    "fit": (FIT.replace("[[fit", "starts = 2\n[[fit"), {"ux.csv": profile()}, [], "rodwake"),
    "tradeoff": (SHORT_PAIR, {}, [], "python3"),
    "plot": (SHORT_PAIR, {}, ["rods"], "python3"),
}


STAGES = {"dem": "granular"}  # of verbs that are called otherwise


def arguments(verb):
    if verb == "plot":
        return [PROGRAM, "plot", "out"]
    return [PROGRAM, verb, "scene.toml", "-o", "out", "-j", "1"] + (["--limit", "0.2"] if verb == "tradeoff" else [])


class Bench:
    """One verb, ready to be run on a faulty system again and again, and its results on a sound one."""

    def __init__(self, verb, folder, shim):
        self.verb, self.folder, self.shim = verb, Path(os.path.realpath(folder)), Path(shim)
        scene, files, before, self.program = VERBS[verb]
        self.ready = self.folder / "ready"
        self.ready.mkdir(parents=True)
        for name, text in {"scene.toml": scene, **files}.items():
            (self.ready / name).write_text(text)
        for earlier in before:
            done = subprocess.run(arguments(earlier), cwd=self.ready, text=True, capture_output=True)
            if done.returncode != 0:
                raise RuntimeError(f"{earlier} before {verb}: {done.stderr}")
        place = self.fresh()
        counts = self.folder / "counts"
        done = self.run(place, FAULT_COUNTS=str(counts))
        if done.returncode != 0:
            raise RuntimeError(f"{verb} on a sound system: {done.stderr}")
        self.counts = {name: int(number) for name, number in (line.split() for line in counts.read_text().splitlines())}
        self.clean = self.results(place)

    def fresh(self):
        place = self.folder / "place"
        shutil.rmtree(place, ignore_errors=True)
        shutil.copytree(self.ready, place)
        return place

    def run(self, place, **faults):
        system = {"LD_PRELOAD": str(self.shim), "FAULT_IN": self.program, "FAULT_UNDER": str(place), **faults}
        return subprocess.run(arguments(self.verb), cwd=place, capture_output=True, text=True, timeout=120, errors="replace",
                              env={**os.environ, **system})

    def results(self, place):
        """Normal form of each result file, by name; a file that cannot be read stands for itself."""
        found = {}
        for file in sorted(path for path in (place / "out").rglob("*") if path.is_file()):
            name = file.relative_to(place / "out").as_posix()
            if PASSED_OVER.search(name) or ".tmp" in name:
                continue
            try:
                found[name] = file.read_bytes() if file.suffix == ".png" else "\n".join(self.form(file))
            except Exception as error:  # whatever it is, such a file is not like the clean one
                found[name] = f"unreadable: {error}"
        return found

    def form(self, file):
        lines = result_hashes.normal_form(file)
        return [line for line in lines if "seconds" not in line] if self.verb == "tradeoff" else lines

    def fault(self, call, number, error):
        """What is wrong when this call fails: a list of words, empty if nothing is; and the exit code."""
        place = self.fresh()
        done = self.run(place, FAULT_CALL=call, FAULT_AT=str(number), FAULT_ERRNO=str(error))
        wrong = self.judge(place, done, call)
        if done.returncode != 0:
            again = subprocess.run(arguments(self.verb), cwd=place, capture_output=True, text=True, timeout=120)
            if again.returncode != 0:
                wrong.append(f"not taken up: {again.stderr.strip()[-200:]}")
            elif self.differing(place, call):
                wrong.append(f"taken up with other results: {self.differing(place, call)}")
        return wrong, done

    def judge(self, place, done, call=None):
        wrong = []
        if done.returncode not in (0, 1):
            wrong.append(f"exit code {done.returncode}")
        if UNSEEMLY.search(done.stderr):
            wrong.append("unseemly end")
        if done.returncode == 0 and self.differing(place, call):
            wrong.append(f"silent: {self.differing(place, call)}")
        if done.returncode != 0 and not done.stderr.strip():
            wrong.append("no message")
        if done.returncode != 0 and self.status(place) == "finished" and "figures could not be made" not in done.stderr:
            wrong.append("failed, but recorded as finished")
        return wrong

    def differing(self, place, call=None):
        """Result files unlike those of a sound system; where a file could not be removed, the manifest rightly lists it."""
        if self.verb == "tradeoff":  # its results are times
            return []
        now = self.results(place)
        return sorted(name for name in self.clean
                      if now.get(name) != self.clean[name] and not (call == "unlink" and name == "manifest.json"))

    def status(self, place):
        """Of the verb's own stage."""
        try:
            if self.verb == "tradeoff":
                return "finished" if json.loads((place / "out/tradeoff.json").read_text())["finished"] else ""
            return json.loads((place / "out/provenance.json").read_text())["stages"].get(STAGES.get(self.verb, self.verb), "")
        except (OSError, ValueError):
            return ""


def spread(count, most):
    """Up to `most` numbers from 1 to `count`, the first and the last among them."""
    if count <= most:
        return list(range(1, count + 1))
    return sorted({1 + round(k * (count - 1) / (most - 1)) for k in range(most)})
