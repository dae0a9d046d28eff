#!/usr/bin/python3
"""A bed that is rewound: any instant of 200 s, made again from the states that it kept, beside the frames that the run itself stored.

    studies/validate_replay.py [--program build/release/rodwake] [--quick] [--keep DIR] [-j 1]

Some five CPU minutes. Prints the table of studies/reports/granular.md.
"""

import random
import resource
import time

import h5py
import numpy as np

from lab import parser, run_parts, table

BED = """schema = 1
title = "A bed to rewind"
[granular]
phi_b = 0.80
box = "78 a"
duration = "{seconds} s"
[granular.output]
frames = "0.25 s"
formats = ["h5md"]
last_period = false
archive = "10 s"
[measure]
order = true
microrheology = true
block = "5 s"
"""
PARTS_OF_FRAMES = ("position", "image", "velocity")


def frame(path, when):
    with h5py.File(path) as file:
        group = file["particles/trajectory"]
        row = int(np.argmin(np.abs(group["position/time"][()] - when)))
        return group["position/time"][row], [group[f"{name}/value"][row] for name in PARTS_OF_FRAMES]


def cpu_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def instants(lab):
    seconds, count = (30, 5) if lab.quick else (200, 100)
    bed = lab.make("bed", BED.format(seconds=seconds), verbs=("dem",))
    draw, took, same = random.Random(1), [], 0
    for _ in range(count):
        when = 0.25 * draw.randrange(4 * seconds + 1)
        began = cpu_seconds()
        lab.call("replay", bed, "--from", when, "--to", when, "-o", "frame", "-j", lab.threads, "--force", "--quiet")
        took.append(cpu_seconds() - began)
        (replayed_at, made), (stored_at, stored) = frame(lab.folder / "frame/trajectory.h5md", when), frame(bed / "trajectory.h5md", when)
        same += replayed_at == stored_at and all(np.array_equal(one, other) for one, other in zip(made, stored))
    sizes = [bed / name for name in ("archive.rwc", "trajectory.h5md")]
    began = time.monotonic()
    verified = lab.call("replay", bed, "--verify", "-j", lab.threads).stdout.strip().rsplit(": ", 1)[1]
    table(f"{count} random instants of {seconds} s, 1549 beads, a state kept every 10 s",
          ["to the bit", "CPU seconds, median and longest", "archive", f"{4 * seconds + 1} frames", "--verify"],
          [[f"{same} of {count}", f"{np.median(took):.2f}, {max(took):.2f}", *(f"{size.stat().st_size / 1e6:.1f} MB" for size in sizes),
            f"{verified}, {time.monotonic() - began:.0f} s"]])


def measures(lab):
    """Of an archive, beside those made on the way."""
    text = BED.format(seconds=10 if lab.quick else 40).replace('formats = ["h5md"]', "formats = []")
    way = lab.make("on_the_way", text, "measure.interval=0.02")
    lab.write("later.toml", text)
    lab.write("bare.toml", text.split("[measure]", maxsplit=1)[0])
    lab.call("dem", "bare.toml", "-o", "later", "--quiet", "--force")
    began = time.monotonic()
    lab.call("measure", "later.toml", "-o", "later", "-s", "measure.interval=0.02", "--quiet", "--force")
    names = ("gr.csv", "gB.csv", "msd.csv", "stiffness.csv")
    same = sum((way / name).read_bytes() == (lab.folder / "later" / name).read_bytes() for name in names)
    table("Measures of an archive beside those made on the way", ["files equal to the byte", "seconds"], [[f"{same} of {len(names)}", f"{time.monotonic() - began:.0f}"]])


PARTS = {"instants": instants, "measures": measures}

if __name__ == "__main__":
    run_parts(parser(__doc__, "report", "quick", "keep", "threads", parts=PARTS).parse_args(), PARTS)
