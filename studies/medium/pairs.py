"""Pairs in unstrained boxes: both orientations, and perpendicular starts; these in a polycrystal as well."""

import math

import numpy as np

from lab import columns, estimate, mean, table, text, read_json, tracks


RUNS = 50
TURN = 0.2   # rad: a rod has begun to turn


def cost():
    return 2 * RUNS * 16 * 1450 + 20 * 20 * 1450


def part(lab):
    rows = []
    for angle in (0, 90):
        folder = lab.make(f"pair_{angle}", f"pair_unstrained_{angle}.toml", f"granular.runs={lab.count(RUNS)}",
                          *(["granular.duration=1 s"] if lab.quick else []))
        found = read_json(folder, "measure")["pairs"]
        change = found.get("half_box_change") or {"value": math.nan, "error": None}
        value, error = estimate(change)
        rows.append([f"{angle} degrees", f"{value:+.2f} +- {error:.2f}", str(found["not_there"]), *(str(found[k]) for k in
                    ("contact", "pursuit", "escape", "undecided")), turns(folder)])
    table("Two rods side by side, 15 a apart, phi_b = 0.78, over half the box; crystal without strain",
          ["rows against the rods", "change of separation, a", "short of half the box", "contact", "pursuit", "escape", "undecided",
           "one goes straight"], rows)
    near = lab.make("pursuit_near", "pursuit_near.toml", *(["granular.runs=2", "granular.duration=1 s"] if lab.quick else []))
    show_near(near)


def turns(folder):
    """Runs in which one rod turns by less than a third of what the other does."""
    pairs = [sorted(abs(t[f"theta{k}"][-1] - t[f"theta{k}"][0]) for k in (0, 1)) for t in tracks(folder)]
    return f"{sum(small < large / 3 for small, large in pairs)} of {len(pairs)}"


def latency(track, k):
    """When rod k has turned by TURN for good; nan: never."""
    turned = np.abs(track[f"theta{k}"] - track[f"theta{k}"][0]) > TURN
    if not turned[-1]:
        return math.nan
    still = np.flatnonzero(~turned)
    return track["t"][still[-1] + 1] if still.size else track["t"][0]


def show_near(folder):
    found, all_tracks = read_json(folder, "measure")["pairs"], list(tracks(folder))
    times = np.array([[latency(t, k) for k in (0, 1)] for t in all_tracks])
    rows = []
    for k, label in ((0, "along the rows"), (1, "across the rows")):
        other = 1 - k
        first = sum(math.isfinite(a[k]) and not a[other] < a[k] for a in times)
        turn = mean([abs(t[f"theta{k}"][-1] - t[f"theta{k}"][0]) for t in all_tracks])
        own = times[np.isfinite(times[:, k]), k]
        rows.append([label, f"{first} of {len(times)}", f"{turn[0]:.2f} +- {turn[1]:.2f}", f"{mean(own)[0]:.1f} +- {mean(own)[1]:.1f}" if own.size else "-"])
    table(f"Perpendicular starts 26 a apart, phi_b = 0.78: {found['contact']} contacts, {found['pursuit']} pursuits, {found['escape']} escapes, "
          f"{found['undecided']} undecided; {turns(folder)} with one rod straight",
          ["rod", "turns first (by 0.2 rad)", "turn, rad", "its latency, s"], rows)


CAPTURES = (0, 1)  # outcomes of pairs.csv: contact, pursuit
BEDS = {"perfect crystal": ("lattice", "fit"), "random": ("random", "78 a")}  # start of the bed, box


def wilson(many, runs):
    """Share, and its interval of 68 % (Wilson's, which holds for shares of 0 and 1 as well)."""
    middle, half = (many + 0.5) / (runs + 1), math.sqrt(many * (runs - many) / runs + 0.25) / (runs + 1)
    return f"{many} of {runs} ({middle - half:.2f} to {middle + half:.2f})"


def polycrystal(lab):
    """Perpendicular starts 26 a apart where the crystal's rows decide, and where their directions differ from place to place."""
    lines = []
    for name, (start, box) in BEDS.items():
        folder = lab.make(f"pursuit_{start}", "pursuit_near.toml", f"granular.runs={lab.count(RUNS)}", f"granular.start={start}",
                          f"granular.box={box}", "measure.order=true", "granular.output.frames=1 s",
                          *(["granular.duration=1 s", "granular.equilibrate=0.1 s"] if lab.quick else []))
        pair = columns(folder / "pairs.csv")
        captured, rear = np.isin(pair["outcome"], CAPTURES), pair["non_reciprocity"] > 0
        order = read_json(folder, "measure")["order"]
        runs = len(captured)
        turned = [mean([abs(track[f"theta{k}"][-1] - track[f"theta{k}"][0]) for track in tracks(folder)]) for k in (0, 1)]
        lines.append([name, text(estimate(order["psi6"])), wilson(captured.sum(), runs), wilson((captured & rear).sum(), runs),
                      text(mean(pair["non_reciprocity"])), *map(text, turned)])
    table("Perpendicular starts 26 a apart, phi_b = 0.78: who captures", ["start of the bed", "psi6", "captured (68 %)", "by the rear rod", "non-reciprocity",
          "turn of the rod along x, rad", "of the other"], lines)


def cost_polycrystal():
    return RUNS * (30.5 + 47) * 1500
