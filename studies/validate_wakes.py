#!/usr/bin/python3
"""The bed without rows as a medium: wakes of rods that walk and that are pulled, sound and drag, in the beds of
studies/validate_verdict.py. Tables of docs/findings.md, section 15.

    studies/validate_wakes.py [--program build/release/rodwake] [--only rods,bed,wakes,medium] [--runs 8] [-j 1] [--keep DIR]

rods    runs with a rod: 45 (solid), 5 to 10 (liquid, crystal) CPU seconds. A run is a row of studies/wakes_runs.csv, and its displacement in bins
        of 3 a, the mean with its mirror image, rows of studies/wakes_maps.csv.
bed     runs without a rod, 10 (solid), 2 to 4 CPU seconds: a uniform push, and the bed at rest; rows of studies/wakes_medium.csv.
wakes   of what is kept: speed, force, displacement on the rod's line and beside it, strain where another rod would be, fits of the maps.
medium  of what is kept: sound, drag, f/mu.

Runs that have a row are not made again, so another --runs adds to them.
"""

import math
import shutil

import h5py
import numpy as np
from scipy.optimize import least_squares, minimize_scalar

from lab import NAN, SOURCE, datasets, keep_row, kept_rows, leave_one_out, mean, parser, ratio, read_json, run_parts, table, text
from medium.spread import Medium
from validate_verdict import BEDS, ROD, SCENE, STARTS, hold

A, BOX, BIN = 4e-4, 78.0, 3.0
RUNS, MAPS, BED = (SOURCE / f"studies/wakes_{name}.csv" for name in ("runs", "maps", "medium"))
CENTRES = np.arange(-BOX / 2 + BIN / 2, BOX / 2, BIN)
HALF = len(CENTRES) // 2
ZONE = (CENTRES > 0.3 * BOX) & (CENTRES < 0.45 * BOX)  # ahead of the rod: displacements are relative to it
# Bed and what is in it, a rod that walks, two of them 15 a apart, or a rod pulled at so many mm/s: seconds, runs, whether to make a map.
ROADS = {("held", "walks"): (60, 12, True), ("held", "1"): (40, 8, True), ("crystal", "walks"): (30, 8, True), ("liquid", "walks"): (15, 8, True),
         ("held", "pair"): (20, 4, False), ("solid", "walks"): (20, 4, False), ("solid", "pair"): (20, 4, False), ("crystal", "pair"): (10, 4, False),
         ("liquid", "pair"): (4, 4, False), ("held", "0.25"): (30, 3, False), ("held", "2"): (20, 6, True), ("liquid", "1"): (20, 4, False),
         ("liquid", "4"): (20, 4, True), ("solid", "1"): (20, 3, False)}
PUSH, INTERVAL, LAG = 22.0, 3.7e-3, 0.4                # a/s^2; s, an interval that meets every phase of the plates; s
MASKS = ((10, 16), (8, 15), (12, 14), (14, 14))        # strip, radius, a: those of scenes/quickstart.toml
ROD_LENGTH, ORDERS = 11.25, (2, 3, 4)
MEASURE = '[measure]\ndisplacement = "lagrangian"\nforce = true\nfrom_travel = "20 a"\ninterval = "0.1 s"\nblock = "4 s"\n'


def scene(name, seconds, seed, frames, more, equilibrate=None):
    bed = BEDS[name] | {"name": name, "seed": seed, "runs": 1, "walk": seconds}
    head = SCENE.format(**bed | ({"equilibrate": equilibrate} if equilibrate else {}))
    return head.replace("formats = []", f'formats = ["h5md"]\nframes = "{frames} s"') + bed["kinds"] + more


class Film:
    """Places and velocities of the beads without those of the centre of mass, a and a/s, masses over their mean, its places, kg/m^2."""

    def __init__(self, folder):
        with h5py.File(folder / "trajectory.h5md") as file:
            group = file["particles/trajectory"]
            beads = group["species"][()] == 0
            mass, self.time = group["mass"][()][beads], group["position/time"][()]
            place = group["position/value"][:, beads, :2] / A + group["image/value"][:, beads, :2] * BOX
            velocity = group["velocity/value"][:, beads, :2] / A
        self.density, self.mass = mass.sum() / (BOX * A) ** 2, mass / mass.mean()
        self.centre, moving = (np.average(one, axis=1, weights=mass) for one in (place, velocity))
        self.place, self.velocity = place - self.centre[:, None], velocity - moving[:, None]

    def drift(self, after):
        """a/s, along x."""
        first = np.argmax(self.time >= after)
        return (self.centre[-1, 0] - self.centre[first, 0]) / (self.time[-1] - self.time[first])


def coarse(folder):
    """[component][y][x]: means over bins weighted by samples, y from 0 on, U_x even and U_y odd; NaN where no bead came."""
    x, y, *u, count = datasets(folder / "measure.h5", "displacement", "x", "y", "Ux", "Uy", "count")
    offset = read_json(folder, "measure")["displacement"]["offset"]
    X, Y = np.meshgrid(x, y)
    to = np.minimum(np.floor(np.abs(Y) / BIN).astype(int), HALF - 1), np.floor((X + BOX / 2) / BIN).astype(int) % len(CENTRES)
    sums = np.zeros((3, HALF, len(CENTRES)))
    for total, values in zip(sums, (count * (u[0] + offset[0]), count * (u[1] + offset[1]) * np.sign(Y), count)):
        np.add.at(total, to, values)
    with np.errstate(invalid="ignore"):
        return sums[:2] / sums[2]


def rods(lab):
    there = {(row["bed"], row["rod"], int(row["seed"])) for row in kept_rows(RUNS)}
    for seed in range(1, 1 + (lab.options.runs or max(most for _, most, _ in ROADS.values()))):
        for (name, how), (seconds, most, far) in ROADS.items():
            if (name, how, seed) in there or seed > most:
                continue
            places = STARTS["15"][0] if how == "pair" else ((20, 39, 0),)
            more = "".join(ROD.format(x=x, y=y, heading=heading, thick=BEDS[name]["thick"]) for x, y, heading in places)
            more += ("" if how in ("walks", "pair") else f'imposed_speed = "{how} mm/s"\n') + hold(BEDS[name], [0] * len(places)) + (MEASURE if far else "")
            folder = lab.make(f"{name}_{how}_{seed}", scene(name, seconds, seed, 0.5, more), verbs=("dem", "measure") if far else ("dem",),
                              good=(0, 1, 2))
            if not (folder / "summary.json").is_file():  # beads overlapped by too much, and the run was stopped
                print(f"{folder.name} failed")
                continue
            summary, film, case = read_json(folder, "summary"), Film(folder), {"bed": name, "rod": how, "seed": seed}
            for axis, values in zip("xy", coarse(folder)) if far else ():
                for y, row in enumerate(values):
                    keep_row(MAPS, {**case, "U": axis, "y": BIN * (y + 0.5)} | {f"{x:g}": f"{value:.3f}" for x, value in zip(CENTRES, row)})
            force, speed = (np.mean([one[key] for one in summary["rods"]]) for key in ("force", "mean_speed"))
            keep_row(RUNS, {**case, "force_uN": f"{1e6 * force:.4f}", "speed": f"{speed / A:.4f}", "drift": f"{film.drift(2.0):.4f}",
                            "density": f"{film.density:.4f}", "cpu_seconds": round(summary["cpu_seconds"])})
            shutil.rmtree(folder)


def kept_of(name, how):
    """[run][component][y][x] and the rows of the same runs."""
    found, runs = {}, [row for row in kept_rows(RUNS) if (row["bed"], row["rod"]) == (name, how)]
    for row in kept_rows(MAPS):
        if (row["bed"], row["rod"]) == (name, how):
            found.setdefault(row["seed"], {}).setdefault(row["U"], []).append([float(row[f"{x:g}"]) for x in CENTRES])
    return np.array([[found[row["seed"]][axis] for axis in "xy"] for row in runs if row["seed"] in found]), runs


def over(U, axis, y, x):
    """Mean of a component between these distances from the rod's line and from the rod."""
    found = U[axis][(CENTRES[HALF:] > y[0]) & (CENTRES[HALF:] < y[1])][:, (CENTRES > x[0]) & (CENTRES < x[1])]
    return found[np.isfinite(found)].mean() if np.isfinite(found).any() else NAN


def strain(U):
    """e_xy where a rod 15 to 18 a to the left would be, |x| < 12 a: where it is negative, kappa > 0 turns that rod inward."""
    inner, outer = (over(U, 0, y, (-12, 12)) for y in ((9, 15), (18, 24)))
    behind, ahead = (over(U, 1, (12, 21), x) for x in ((-12, -6), (6, 12)))
    return 0.5 * ((outer - inner) / 9.0 + (ahead - behind) / 18.0)


def basis(eta, screening):
    """Fields of a unit force of the rod's length and of its dipoles and moments, relative to the zone ahead; mu is 1."""
    medium = Medium(CENTRES, CENTRES, (1 + eta, 1 + eta, eta - 1, 1.0), screening, 0.0, 0.0, 1.0)
    fields = [medium.line(-ROD_LENGTH / 2, ROD_LENGTH / 2), *medium.dipoles(), *(one for order in ORDERS for one in medium.moments(order))]
    return [(one - one[:, :, ZONE].mean(axis=2, keepdims=True))[:, HALF:] for one in fields]


class Fit:
    """Of f/mu and eta to maps beside the rod's row: the force, its dipoles and moments up to the fourth in the periodic box, all relative to the
    zone ahead, and how far beads have come against the centre of mass since then, as some are dragged along."""

    def __init__(self, maps, mask, drag_area):
        X, Y = np.meshgrid(CENTRES, CENTRES[HALF:])
        self.drag_area, sigma = drag_area, maps.std(axis=0, ddof=1) / math.sqrt(len(maps))
        self.kept = (Y > mask[0]) & (np.hypot(X, Y) > mask[1]) & np.isfinite(maps).all(axis=(0, 1))
        self.sigma = np.concatenate([np.maximum(one[self.kept], 0.7 * np.median(one[self.kept])) for one in sigma])
        self.dragged = [(CENTRES[ZONE].mean() - X) / BOX, 0 * X]

    def solve(self, U, eta, f_over_mu):
        fields = basis(eta, f_over_mu / self.drag_area)
        *columns, data = (np.concatenate([part[self.kept] for part in one]) / self.sigma for one in (*fields, self.dragged, U))
        found, left = np.linalg.lstsq(np.stack(columns, axis=1), data, rcond=None)[:2]
        return found[0], left[0] / (len(data) - len(found) - 1)

    def best(self, maps):
        """f/mu, log eta and chi2 over degrees of freedom."""
        U, scale = maps.mean(axis=0), 1.0
        for _ in range(2):  # the drag hardly matters, so that its f/mu may be of the round before
            log = minimize_scalar(lambda one: self.solve(U, math.exp(one), scale)[1], bounds=(math.log(0.05), math.log(50)), method="bounded").x
            value, chi2 = self.solve(U, math.exp(log), scale)
            scale = max(value, 0.01)
        return np.array([value, log, chi2])


def fitted(maps, drag_area):
    """f/mu, log eta and chi2 over degrees of freedom; errors by leaving out runs; half the range over masks."""
    others = np.array([Fit(maps, mask, drag_area).best(maps) for mask in MASKS])
    return others[0], leave_one_out(lambda kept: Fit(maps, MASKS[0], drag_area).best(maps[kept]), len(maps)), np.ptp(others, axis=0) / 2


SHOWN = {"U_x on the line, 30 to 39 a behind": ((0, 3), (-39, -30)), "10 to 20 a behind": ((0, 3), (-20, -10)), "ahead": ((0, 3), (10, 20)),
         "12 to 21 a beside it, behind": ((12, 21), (-20, -10)), "abreast, |x| < 5 a": ((12, 21), (-5, 5)), "ahead ": ((12, 21), (10, 20))}


def of(name, key):
    """Of the bed without a rod; held by a force or not it is the same."""
    return mean([float(row["value"]) for row in kept_rows(BED) if (row["bed"], row["key"]) == ("solid" if name == "held" else name, key)] or [NAN])


def speeds(name):
    """c_T and c_L, a/s."""
    return [[BOX / (2 * math.pi) * one for one in of(name, f"omega_{branch}_1")] for branch in "TL"]


def elastic(name, force):
    """mu in mN/m, eta and f/mu in a of a force in uN, by sound; None in a liquid."""
    shear, compression = speeds(name)
    if not shear[0] > compression[0] / 10:
        return None
    faster, mu = ratio(compression, shear), [of(name, "density")[0] * (shear[0] * A) ** 2 * 1e3 * one for one in (1, 2 * shear[1] / shear[0])]
    return mu, (faster[0] ** 2 - 1, 2 * faster[0] * faster[1]), ratio([1e-3 * one / A for one in force], mu)


def wakes(_):
    lines, found = [], []
    for name, how in ROADS:
        U, runs = kept_of(name, how)
        if not runs:
            continue
        label = [name, how if how in ("walks", "pair") else f"pulled at {how} mm/s"]
        force, way, drift = (mean([float(row[key]) for row in runs]) for key in ("force_uN", "speed", "drift"))
        through = mean([float(row["speed"]) - float(row["drift"]) for row in runs])
        lines.append([*label, len(runs), text(way), text(drift), text(through), text(force), f"{sum(float(row['cpu_seconds']) for row in runs) / 3600:.2f}"])
        if len(U) < 3:
            continue
        drag_area, sound = force[0] * 1e-6 / (float(runs[0]["density"]) * of(name, "drag_rate")[0] * through[0] * A**3), elastic(name, force)
        whole = sound and len(U) > 3 and np.isfinite(U[..., :HALF]).all()  # the rod has come far enough to fit what is behind it
        found.append([*label, len(U), *(text(mean([over(run, 0, *where) for run in U])) for where in SHOWN.values()),
                      text(mean([1e3 * strain(run) for run in U]), digits=1), *([] if whole else "---")])
        if whole:
            best, errors, masks = fitted(U, drag_area)
            found[-1] += [f"{text((best[k], errors[k]))} +- {masks[k]:.2f}" for k in (0, 1)] + [f"{best[2]:.1f}"]
        if sound:
            theory = sound[2][0] * basis(sound[1][0], sound[2][0] / drag_area)[0]
            found.append([*label, "by sound", *(f"{over(theory, 0, *where):.2f}" for where in SHOWN.values()), f"{1e3 * strain(theory):.1f}", text(sound[2]),
                          f"{math.log(sound[1][0]):.2f} +- {sound[1][1] / sound[1][0]:.2f}", ""])
    table("Rods", ["bed", "rod", "runs", "speed, a/s", "drift of the bed, a/s", "speed through the bed, a/s", "force on the beads, uN", "CPU hours"], lines)
    table("Displacement relative to the zone ahead, a, and fits of the maps (errors of runs, of masks)",
          ["bed", "rod", "runs", *SHOWN, "e_xy 15 to 18 a to the left, 1e-3", "f/mu, a", "ln eta", "chi2/dof"], found)


def currents(film):
    """omega, gamma and T_q/T of the mass currents of |m|^2 = 1, 2 and 4, fitted by the correlation of a damped oscillator."""
    lags, found = np.arange(1, round(LAG / INTERVAL)), {"density": film.density}
    for square, waves in {1: [(1, 0), (0, 1)], 2: [(1, 1), (1, -1)], 4: [(2, 0), (0, 2)]}.items():
        total = {"T": 0.0, "L": 0.0}
        for q in 2 * math.pi / BOX * np.array(waves):
            j = np.einsum("tn,tnc->tc", np.exp(-1j * film.place @ q) * film.mass, film.velocity) / np.hypot(*q)
            for name, unit in (("T", q[::-1] * (-1, 1)), ("L", q)):
                power = np.abs(np.fft.fft(j @ unit, 2 * len(j))) ** 2
                total[name] = total[name] + (np.fft.ifft(power)[:lags[-1] + 1].real / (len(j) - np.arange(lags[-1] + 1))) / 2 / len(film.mass)
        for name, one in total.items():
            def off(p, one=one, t=lags * INTERVAL):
                root = np.sqrt(complex(p[0] ** 2 - p[1] ** 2 / 4) + 1e-12)
                return (p[2] * np.exp(-p[1] / 2 * t) * (np.cos(root * t) - p[1] / 2 / root * np.sin(root * t))).real - one[lags] / one[0]
            best = min((least_squares(off, [start, 12.0, 1.0], bounds=([0, 0, 0], [200, 500, 3])) for start in (3.0, 10.0, 30.0)), key=lambda fit: fit.cost)
            found |= {f"omega_{name}_{square}": best.x[0], f"gamma_{name}_{square}": best.x[1],
                      f"T_{name}_{square}": one[0] / (film.mass[:, None] * film.velocity**2).mean()}
    return found


def bed(lab):
    there = {(row["bed"], row["what"], int(row["seed"])) for row in kept_rows(BED)}
    push = f'[granular.body_force]\nkind = "uniform"\nacceleration = {PUSH * A:.8g}\n'
    for seed in range(1, 1 + (lab.options.runs or 6)):
        for name, what in ((name, what) for name in BEDS if "hold" not in BEDS[name] for what in ("drag", "sound")):
            if (name, what, seed) in there:
                continue
            keys = (10, seed, 0.25, push, 5) if what == "drag" else (15, seed, INTERVAL, "")
            folder = lab.make(f"{name}_{what}_{seed}", scene(name, *keys), verbs=("dem",))
            film, spent = Film(folder), read_json(folder, "summary")["cpu_seconds"]
            for key, value in (currents(film) if what == "sound" else {"drag_rate": PUSH / film.drift(1.0)}).items():
                keep_row(BED, {"bed": name, "what": what, "seed": seed, "key": key, "value": f"{value:.6g}", "cpu_seconds": round(spent)})
            shutil.rmtree(folder)


def medium(_):
    kept, lines, media = kept_rows(BED), [], []
    for name in {row["bed"]: None for row in kept}:
        runs = {(row["what"], row["seed"]): float(row["cpu_seconds"]) for row in kept if row["bed"] == name}
        count = {what: sum(one == what for one, _ in runs) for what in ("sound", "drag")}
        lines.append([name, count["sound"], *(text(of(name, f"{key}_{branch}_{square}"), digits=1) for branch in "TL" for key in ("omega", "gamma")
                                              for square in (1, 2, 4)), *(text(of(name, f"T_{branch}_1")) for branch in "TL")])
        walks = kept_of("held" if name == "solid" else name, "walks")[1]
        force, through = (mean([float(row[key]) - less * float(row["drift"]) for row in walks] or [NAN]) for key, less in (("force_uN", 0), ("speed", 1)))
        sound, drag, (shear, compression) = elastic(name, force), of(name, "drag_rate"), speeds(name)
        media.append([name, count["drag"], text(drag), *(text(one, digits=0) for one in (shear, compression)), *(map(text, sound) if sound else "---"),
                      f"{shear[0] ** 2 / drag[0] / through[0]:.0f}" if sound else "-", f"{sum(runs.values()) / 3600:.2f}"])
    table("Currents, 1/s", ["bed", "runs", *(f"{key}_{branch}, m^2 = {square}" for branch in "TL" for key in ("omega", "gamma") for square in (1, 2, 4)),
                            "T_T/T", "T_L/T"], lines)
    table("The medium by sound, mass of the beads alone", ["bed", "runs of drag", "drag rate, 1/s", "c_T, a/s", "c_L, a/s", "mu, mN/m", "eta",
                                                           "f/mu of a walking rod, a", "its xi, a", "CPU hours"], media)


PARTS = {"rods": rods, "bed": bed, "wakes": wakes, "medium": medium}

if __name__ == "__main__":
    run_parts(parser(__doc__, "report", "threads", "keep", "runs", parts=PARTS).parse_args(), PARTS)
