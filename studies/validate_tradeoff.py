#!/usr/bin/python3
"""Validation of `rodwake tradeoff`: the numbers of studies/reports/scan.md, "Speed against accuracy".

    studies/validate_tradeoff.py [--program build/release/rodwake] [--only scenes,promise,fits,beds] [--random 50] [--seed 1] [--keep DIR]

scenes: work-precision tables and figures of named scenes, and each setting whose error is outside [0.01, 100] of its tolerance.
promise: on random scenes `--for E` is asked twice, in measurements of their own. The setting of the first is run, and its error taken
against a solution that the command did not use; the table of the second says whether another one would have been much faster.
fits: each way to fit the problems of fitting/problems. beds: what the bed of a rod costs to some errors, and whether ensembles of the
settings that are printed keep to them: 12 of each, against 100 runs at the shortest step.
Prints Markdown. --keep DIR keeps the results and takes up what is there.
"""

import math
import random
import statistics
import sys

from lab import SOURCE, markdown, parser, rows, run_parts, read_json

MEDIUM = "schema = 1\n[medium]\neta = {eta}\nalpha = {alpha}\n[coupling]\nkappa = {kappa}\ngamma1 = {gamma1}\ngamma2 = {gamma2}\n"
PLAIN = {"eta": 1.0, "alpha": 1.0, "kappa": 0.5, "gamma1": 0.0, "gamma2": 0.0}
INDEPENDENT = "rods_run.method=bdf", "rods_run.form=director", "rods_run.rtol=1e-13"  # the reference is of erk and adams or bdf, by angle


def scene(poses, t_end, contact=None, **constants):
    text = MEDIUM.format(**(PLAIN | constants))
    text += f"[rods_run]\nt_end = {t_end}\noutput_interval = {t_end / 20}\n"
    text += f"contact_distance = {contact}\n" if contact else ""
    return text + "".join(f"[[rods]]\nposition = [{x!r}, {y!r}]\nheading = {heading!r}\n" for x, y, heading in poses)


def lattice(count, spacing, seed):
    """Rods on a square lattice, headings within 0.5 of +x."""
    draw, side = random.Random(seed), math.ceil(math.sqrt(count))
    return [(spacing * (k % side) + draw.uniform(-0.3, 0.3), spacing * (k // side) + draw.uniform(-0.3, 0.3), draw.uniform(-0.5, 0.5))
            for k in range(count)]


NAMED = {
    "pair attraction": (scene([(0, 2.5, 0), (0, -2.5, 0)], 60.0, contact=0.1), "contact_time"),
    "grazing encounter": (scene([(0, 0, 0), (-1.0, -3.0, 1.35)], 12.0, kappa=0.3), "final_state"),
    "stiff pursuit": (scene([(0, 0, 0), (-3.0, 0.4, 0.1)], 20.0, contact=0.1, kappa=1e4), "final_state"),
    "5 rods": (scene(lattice(5, 2.0, 3), 10.0, kappa=0.5, gamma1=0.3), "final_state"),
    "100 rods": (scene(lattice(100, 3.0, 4), 4.0, kappa=0.3), "final_state"),
}


def tradeoff(lab, file, name, *options, good=(0,)):
    return lab.call("tradeoff", file, "-o", lab.folder / name, "--quiet", *options, good=good)


def measurements(lab, name):
    return rows(lab.folder / name / "tradeoff.csv")


def last_state(lab, file, name, settings):
    """Of a run with these settings, and its outcome."""
    out = lab.folder / name
    lab.call("rods", file, "-o", out, "--quiet", "--force", *[f"-s{setting}" for setting in settings])
    row = (out / "rods.csv").read_text().splitlines()[-1]
    return [float(cell) for cell in row.split(",")[1:]], read_json(out, "outcome")["outcome"]


def way(row):
    """A setting in words."""
    field = f"table {float(row['table_tolerance']):g}" if row["table_tolerance"] else row["field"]
    precision = "" if row["precision"] == "full" else f", {row['precision']}"
    return f"{row['method']}, {row['form']}, {field}{precision}"


def cheapest(rows, error):
    good = [row for row in rows if float(row["error"]) <= error]
    return min(good, key=lambda row: float(row["seconds"]), default=None)


def time_text(row):
    return "none" if row is None else f"{1e3 * float(row['seconds']):.3g} ms ({way(row)}, rtol {row['tolerance']})"


def named_scenes(lab):
    strays, lines = [], []
    for name, (text, kind) in NAMED.items():
        slug = name.replace(" ", "_")
        tradeoff(lab, lab.write(f"{slug}.toml", text), slug, "--error", kind)
        reference, found = read_json(lab.folder / slug, "tradeoff")["reference"], measurements(lab, slug)
        lines.append([name, kind, f"{reference['agreement'][kind]:.1e}", *(time_text(cheapest(found, error)) for error in (1e-3, 1e-6, 1e-9))])
        strays += stray_settings(name, found, reference["least_error_quoted"][kind])
    print(markdown(["scene", "error", "agreement of the reference", "cheapest for 1e-3", "for 1e-6", "for 1e-9"], lines))
    print("\nError over tolerance outside [0.01, 100]:\n")
    print("\n".join(f"* {line}" for line in strays) or "* none")


def stray_settings(name, rows, least):
    """A line for each way to solve, with the ratios of its settings that are outside."""
    outside = {}
    for row in rows:
        ratio = float(row["error"]) / float(row["tolerance"])
        if not 0.01 <= ratio <= 100 and float(row["error"]) > 1.001 * least:
            outside.setdefault(way(row), []).append(f"{ratio:.2g} at {row['tolerance']}")
    return [f"{name}: {one}: {', '.join(ratios)}" for one, ratios in outside.items()]


def random_scene(draw):
    """Two to five rods that walk for some encounter lengths; eta from three values, as tables take seconds to make."""
    constants = {"eta": draw.choice([0.3, 1.0, 4.0]), "alpha": 10 ** draw.uniform(-1, 1), "kappa": draw.choice([-1, 1]) * 10 ** draw.uniform(-1.5, 1.5),
                 "gamma1": draw.choice([0.0, draw.uniform(-1, 1)]), "gamma2": draw.choice([0.0, draw.uniform(-1, 1)])}
    count = draw.choice([2, 2, 2, 3, 5])
    poses = [(x, y, draw.uniform(-math.pi, math.pi)) for x, y, _ in lattice(count, draw.uniform(1.5, 4.0), draw.random())]
    return scene(poses, draw.choice([3.0, 8.0, 20.0]), **constants)


def promise(lab):
    """Scenes are drawn until --random of them have an answer."""
    count, seed = lab.options.random, lab.options.seed
    draw = random.Random(seed)
    errors, slower, beyond, without, k = [], [], 0, 0, 0
    while len(errors) < count:
        text, wanted, k = random_scene(draw), 10 ** draw.uniform(-8, -2), k + 1
        file = lab.write(f"random_{k}.toml", text)
        answer = tradeoff(lab, file, f"random_{k}_a", "--for", wanted, good=())
        beyond += "most accurate one" in answer.stderr
        without += "no reference" in answer.stderr
        if answer.returncode == 1:
            continue
        if answer.returncode:
            sys.exit(f"{file}: {answer.stderr}")
        keys = answer.stdout.split("\n")[:-1]
        tradeoff(lab, file, f"random_{k}_b")
        state, outcome = last_state(lab, file, f"random_{k}_run", keys)
        exact, expected = last_state(lab, file, f"random_{k}_exact", INDEPENDENT)
        errors.append((max(abs(a - b) for a, b in zip(state, exact)) if outcome == expected else math.inf) / wanted)
        slower.append(slowness(measurements(lab, f"random_{k}_a"), measurements(lab, f"random_{k}_b"), wanted))
    print(f"{count} random scenes (seed {seed}; {beyond} more had E out of reach, {without} no reference). Error of the setting over E: median "
          f"{statistics.median_high(errors):.2g}, largest {max(errors):.2g}; above 2: {sum(e > 2 for e in errors)}. Time of the setting over that of the fastest "
          f"good one when all are measured again: median {statistics.median_high(slower):.3g}, largest {max(slower):.3g}; above 1.5: {sum(s > 1.5 for s in slower)}.")


def slowness(first, second, wanted):
    """How much longer what the first table recommends takes in the second than the best one there."""
    def name(row):
        return way(row), row["tolerance"]
    chosen, times = name(cheapest(first, wanted)), {name(row): float(row["seconds"]) for row in second}
    return times[chosen] / float(cheapest(second, wanted)["seconds"])


def fits(lab):
    lines = []
    for name in ("monopole", "dipole", "joint", "pair"):
        file, out = SOURCE / f"fitting/problems/{name}.toml", lab.folder / name
        log = lab.call("tradeoff", file, "--of", "fit", "-o", out).stderr + (out / "tradeoff_fit/log.txt").read_text()
        agreement = next((line.split("agree to")[1].split()[0] for line in log.splitlines() if "agree to" in line), "")
        lines.append([name, agreement, *(cost(lab, file, out, "fit", wanted) for wanted in ("optimum 1e-2", "optimum 1e-6", "interval 0.5", "interval 0.01"))])
    print(markdown(["problem", "searches agree to", "optimum to 1e-2", "to 1e-6", "interval to 0.5", "to 0.01"], lines))


def cost(lab, file, out, part, wanted):
    """What the answer costs, and its settings."""
    done = lab.call("tradeoff", file, "--of", part, "-o", out, "--for", wanted, good=())
    if done.returncode:
        return "none"
    settings = ", ".join(line.split(" = ")[1].strip('"') for line in done.stdout.splitlines()[:3])
    return f"{done.stderr.splitlines()[-1].rsplit(' in ', 1)[-1]} ({settings})"


BED = """schema = 1
[granular]
phi_b = 0.5
box = "20 a"
duration = "1 s"
equilibrate = "0.3 s"
runs = 2
[granular.output]
formats = []
last_period = false
[[granular.rods]]
kind = "motile"
position = ["10 a", "10 a"]
heading = 0.0
"""
REPEATS, REFERENCE_RUNS, STEP = 12, 100, 5e-6


def beds(lab):
    file, out = lab.write("bed.toml", BED), lab.folder / "bed"
    lab.call("tradeoff", file, "-o", out, "--quiet", "--limit", "20s")
    true = ensemble(lab, file, "bed_reference", (f'granular.time_step="{STEP:g} s"', f"granular.runs={REFERENCE_RUNS}"), 900001)
    wanted = (("rod_speed", 20), ("rod_speed", 10), ("T_xy", 2), ("T_z", 0.5), ("psi6", 5))
    print(markdown(["asked", "step", "runs", "CPU", "rms error of the ensembles over what was asked"], [bed_row(lab, file, out, true, *one) for one in wanted]))


def bed_row(lab, file, out, true, quantity, percent):
    done = lab.call("tradeoff", file, "-o", out, "--limit", "20s", "--for", f"{quantity} {percent}%", good=())
    if done.returncode:
        return [f"{quantity} {percent} %", f"none: {done.stderr.splitlines()[-1]}", "", "", ""]
    keys = [line.replace(" = ", "=") for line in done.stdout.splitlines()]
    value = dict(key.split("=") for key in keys)
    means = [ensemble(lab, file, f"bed_{quantity}_{percent}_{k}", keys, 1000 * (k + 1))[quantity] for k in range(REPEATS)]
    over = 100 / percent * math.sqrt(sum((mean / true[quantity] - 1) ** 2 for mean in means) / REPEATS)
    took = done.stderr.splitlines()[-1].rsplit("; ", 1)[-1].removesuffix(" of CPU")
    return [f"{quantity} {percent} %", value["granular.time_step"], value["granular.runs"], took, f"{over:.2f} +- {over / math.sqrt(2 * REPEATS):.2f}"]


def ensemble(lab, file, name, keys, seed):
    """Means of an ensemble; of one run its values."""
    out = lab.folder / name
    lab.call("dem", file, "-o", out, "--quiet", "--force", *[f"-s{key}" for key in keys], "--seed", seed)
    found = read_json(out, "summary")
    return {"rod_speed": found["rods"][0]["mean_speed"], **{key: found[key] for key in ("T_xy", "T_z", "psi6")}}


PARTS = {"scenes": named_scenes, "promise": promise, "fits": fits, "beds": beds}

if __name__ == "__main__":
    options = parser(__doc__, "report", "seed", "keep", parts=PARTS, chosen=("scenes", "promise"))
    options.add_argument("--random", type=int, default=50, help="number of random scenes [50]")
    run_parts(options.parse_args(), PARTS)
