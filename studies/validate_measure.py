#!/usr/bin/python3
"""Validation of the measures on granular runs: every number of docs/validation_measure.md that comes from [measure] on a bed.

    studies/validate_measure.py [--program build/release/rodwake] [--only order,wake,large,flow,pairs,pairs_18,turned,pursuit,force,measured_pair,cost]
                              [-j 2] [--keep DIR] [--runs N]

Runs the scenes of scenes/ and prints Markdown: each line a number with its standard error. --keep DIR keeps the results and
takes up what is there; --runs N replaces the scenes' number of runs (fewer: larger errors).
"""

import argparse
import csv
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import h5py
import numpy as np
import periodic_wake

SOURCE = Path(__file__).resolve().parent.parent


class Lab:
    def __init__(self, options, folder):
        self.program, self.threads, self.runs, self.folder = options.program, options.j, options.runs, Path(folder)

    def run(self, scene, name, *settings):
        """The run directory of a scene, simulated and measured; taken as it is if it is there."""
        out = self.folder / name
        extra = [f"-sgranular.runs={self.runs}"] if self.runs else []
        done = json.loads((out / "provenance.json").read_text())["status"] if (out / "provenance.json").exists() else ""
        if done == "finished":
            return out
        command = [self.program, "run", SOURCE / "scenes" / scene, "-o", out, "-j", self.threads, "--quiet",
                   *[f"-s{s}" for s in settings], *extra]
        finished = subprocess.run([str(part) for part in command], capture_output=True, text=True)
        if finished.returncode != 0:
            sys.exit(f"{' '.join(map(str, command))}: exit code {finished.returncode}\n{finished.stderr}")
        return out


def read(file):
    lines = [line for line in file.read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


BINS_PER_VALUE = 4.2  # bins of 1 a closer than two lattice spacings share data: a fit has fewer values than bins


def profile(folder, name):
    rows = read(folder / f"profile_{name}.csv")
    return tuple(np.array([float(row[key]) for row in rows]) for key in ("x", "value", "sigma"))


def shared(sigma):
    """Errors with which a fit may take the bins as independent."""
    return sigma * np.sqrt(BINS_PER_VALUE)


def measured(folder):
    return json.loads((folder / "measure.json").read_text())


def table(title, head, rows):
    print(f"\n### {title}\n\n| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(str(cell) for cell in row) + " |", flush=True)
    print(flush=True)


def estimate(e, scale=1.0, digits=3):
    if e["error"] is None:
        return f"{scale * e['value']:.{digits}f} (one run)"
    return f"{scale * e['value']:.{digits}f} +- {scale * e['error']:.{digits}f}"


def cases(folder):
    """(name, folder) of the scene and its variants, in the order of series.csv."""
    return [(row, folder if row["name"] == "scene" else folder / "variants" / row["name"]) for row in read(folder / "series.csv")]


def order(lab):
    rows = []
    for row, folder in cases(lab.run("order.toml", "order")):
        m = measured(folder)
        o, r = m["order"], m["microrheology"]
        rows.append([f"{m['phi_b']:.2f}", estimate(o["psi6"]), f"{o['g_minimum']:.2f}" if o["g_minimum"] else "-", o["class"],
                     estimate(o["exponent"]),
                     f"{r['stiffness']['value']:.4f} +- {r['scatter']:.4f} +- {r['bend']:.4f}", estimate(r["spring"], 1e3)])
    table("Order and stiffness", ["phi_b", "psi6", "first minimum of g, a", "g_B", "exponent", "stiffness, 1/a^2, +- scatter +- bend",
                                   "k, mN/m"], rows)


def fit_wake(x, U, sigma, box, core, eta):
    """f/mu and xi of U_x(x, 0) at fixed eta by Gauss-Newton on their logarithms, errors scaled by chi."""
    use = np.abs(x) > core
    x, U, sigma = x[use], U[use], sigma[use]
    p = np.log([3.0, 12.0])

    def model(p):
        return periodic_wake.field(x, 0.0 * x, np.exp(p[0]), np.exp(p[1]), eta, box)[0]

    for _ in range(30):
        base = model(p)
        J = np.stack([(model(p + d) - base) / 1e-5 for d in 1e-5 * np.eye(2)], axis=1) / sigma[:, None]
        step = np.linalg.lstsq(J, (U - base) / sigma, rcond=None)[0]
        p = p + np.clip(step, -0.5, 0.5)
        if np.max(np.abs(step)) < 1e-8:
            break
    chi2 = float(np.sum(((U - model(p)) / sigma) ** 2))
    dof = len(x) - 2
    error = np.sqrt(np.diag(np.linalg.inv(J.T @ J)) * max(1.0, chi2 * BINS_PER_VALUE / dof))
    return np.exp(p), np.exp(p) * error, chi2, dof / BINS_PER_VALUE


def ratio(value, sigma, theory):
    """The factor k of value = k theory, with its error (scaled by chi)."""
    w = theory / sigma**2
    k = np.sum(w * value) / np.sum(w * theory)
    chi2 = np.sum(((value - k * theory) / sigma) ** 2) * BINS_PER_VALUE / max(1, len(value) - 1)
    return f"{k:.2f} +- {np.sqrt(max(1.0, chi2) / np.sum(w * theory)):.2f}"


def decays(folder):
    """U_x on the axis behind and ahead, from the value half a box away, which both sides share."""
    x, U, sigma = profile(folder, "Ux_x")
    edge = U[0]
    rows = []
    for distance in (9.0, 15.0, 21.0, 27.0):
        (behind, b), (ahead, a) = ((U[k] - edge, sigma[k]) for k in (np.argmin(np.abs(x + distance)), np.argmin(np.abs(x - distance))))
        ratio = behind / ahead
        rows.append([f"{distance:g}", f"{behind:.3f} +- {b:.3f}", f"{ahead:.3f} +- {a:.3f}",
                     f"{ratio:.1f} +- {abs(ratio) * np.hypot(b / behind, a / ahead):.1f}"])
    return rows


def wake(lab, scene="wake.toml", name="wake", title="Wake in the 78 a box"):
    folder = lab.run(scene, name)
    m = measured(folder)["displacement"]
    x, U, sigma = profile(folder, "Ux_x")
    box = 155.0 if name == "large" else 78.0
    table(title + ": U_x(x,0) - U_x(L/2,0)", ["distance, a", "behind, a", "ahead, a", "ratio"], decays(folder))
    rows = [["blocks, frames, rod speed", f"{m['blocks']}, {m['frames']}, {m['mean_speed']:.2f} a/s"]]
    for core in (8.0, 10.0):
        for eta in (0.5, 1.3, 5.0):
            p, e, chi2, dof = fit_wake(x, U, shared(sigma), box, core, eta)
            cells = []
            for which, component in (("Ux_y", 0), ("Uy_x", 1), ("Uy_y", 1)):
                s, v, d = profile(folder, which)
                d = shared(d)
                along_x = which.endswith("_x")
                px, py = (s, np.full_like(s, 4.0)) if along_x else (np.zeros_like(s), s)
                use = np.abs(s) > core
                cells.append(ratio(v[use], d[use], periodic_wake.field(px, py, *p, eta, box)[component][use]))
                if which == "Uy_x":
                    use = s > core
                    cells.append(ratio(v[use], d[use], periodic_wake.field(px, py, *p, eta, box)[component][use]))
            rows.append([f"|x| > {core:g} a, eta = {eta}: f/mu, xi; chi2/dof",
                         f"{p[0]:.2f} +- {e[0]:.2f} a, {p[1]:.1f} +- {e[1]:.1f} a; {chi2:.0f}/{dof:.0f}"])
            rows.append(["measured over theory: U_x(0,y); U_y(x,4a) all; ahead; U_y(0,y)", "; ".join(cells)])
    table(title, ["", ""], rows)
    return folder


def large(lab):
    folder = wake(lab, "wake_large.toml", "large", "Wake in the 155 a box")
    x, U, sigma = profile(folder, "Ux_x")
    rows = []
    for low, high in ((9.0, 15.0), (15.0, 21.0), (9.0, 21.0)):
        use = (-x >= low) & (-x <= high)
        wide = shared(sigma)
        s, v, d = -x[use], np.sqrt(-x[use]) * U[use], np.sqrt(-x[use]) * wide[use]
        w = 1.0 / d**2
        mean = np.sum(w * v) / np.sum(w)
        line = np.polyfit(s, v, 1, w=1.0 / d, cov="unscaled")
        power = np.polyfit(np.log(s), np.log(U[use]), 1, w=U[use] / wide[use], cov="unscaled")
        rows.append([f"{low:g} to {high:g} a behind", f"{mean:.3f} +- {np.sum(w)**-0.5:.3f}", f"{line[0][0]:.4f} +- {np.sqrt(line[1][0, 0]):.4f}",
                     f"{power[0][0]:.2f} +- {np.sqrt(power[1][0, 0]):.2f}"])
    table("|x|^(1/2) U_x behind the rod in the 155 a box", ["", "mean, a^(3/2)", "slope, a^(1/2)", "power of |x| of U_x"], rows)


def flow(lab):
    rows = []
    for row, folder in cases(lab.run("bead_drag.toml", "flow")):
        f = measured(folder)["flow"]
        with h5py.File(folder / "measure.h5") as h5:
            x, y, vx, sigma = (h5[f"flow/{name}"][...] for name in ("x", "y", "vx", "sigma_x"))
        far = []
        for low, high in ((-22, -10), (10, 22)):
            strip = np.ix_(np.abs(y) < 3.1, (x >= low) & (x <= high))
            w = 1.0 / np.maximum(sigma[strip], 1e-9)**2
            far.append(f"{np.sum(w * vx[strip]) / np.sum(w):+.2f} +- {np.sum(w)**-0.5:.2f}")
        rows.append([f"{float(row['phi_b']):.2f}", *far, f"{f['near_speed']:.2f}", estimate(f["drag"], 1, 2), estimate(f["drag_share"])])
    table("Flow around the rod", ["phi_b", "v_x 10 to 22 a behind, a/s", "ahead, a/s", "mean speed within 6 a, a/s",
                                  "drag of the beads within 6 a over 20 a of the rod's way, a", "share of it"], rows)


def pair_rows(lab, name, *settings):
    return [[f"{float(row['phi_b']):.2f}", f"{float(row['d0']):.1f}",
             f"{float(row['delta_y']):+.2f} +- {float(row['delta_y_error']):.2f}", measured(folder)["pairs"]["half_box_change"]["samples"],
             estimate(measured(folder)["pairs"]["non_reciprocity"], 1, 2)]
            for row, folder in cases(lab.run("pair_series.toml", name, *settings))]


PAIR_HEAD = ["phi_b", "d0, a", "Delta y over half the box, a", "runs", "non-reciprocity"]


def pairs(lab):
    table("Pairs 15 a apart, rows along the rods", PAIR_HEAD, pair_rows(lab, "pairs"))


def pairs_18(lab):
    table("Pairs 18 a apart, rows along the rods", PAIR_HEAD,
          pair_rows(lab, "pairs_18", "granular.rods.0.position=[20 a, 48 a]", "granular.rods.1.position=[20 a, 30 a]"))


def turned(lab):
    table("Pairs 15 a apart, rows turned by 90 degrees", PAIR_HEAD, pair_rows(lab, "turned", "granular.orientation=1.5707963267948966"))


def pursuit(lab):
    p = measured(lab.run("pursuit_bed.toml", "pursuit"))["pairs"]
    table("Perpendicular starts, phi_b = 0.78", ["contact, pursuit, escape", "turn of the rear, rad", "of the front, rad", "non-reciprocity"],
          [[f"{p['contact']}, {p['pursuit']}, {p['escape']}", estimate(p["turn_rear"]), estimate(p["turn_front"]),
            estimate(p["non_reciprocity"], 1, 2)]])


def force(lab):
    folder = lab.run("force.toml", "force")
    rows, v, f, e = [], [], [], []
    for row, _ in cases(folder):
        v.append(float(row["imposed_speed"]) * 0.4)
        f.append(float(row["force"]) * 1e6)
        e.append(float(row["force_error"]) * 1e6)
        rows.append([f"{v[-1]:.2f}", f"{f[-1]:.3f} +- {e[-1]:.3f}", row["runs"]])
    table("Force against imposed speed", ["speed, mm/s", "force, uN", "runs"], rows)
    v, f, e = map(np.array, (v, f, e))
    line, cov = np.polyfit(v, f, 1, w=1.0 / e, cov="unscaled")
    slope = np.sum(v * f / e**2) / np.sum(v**2 / e**2)
    chi = [float(np.sum(((f - model) / e) ** 2)) for model in (np.polyval(line, v), slope * v)]
    print(f"f = {line[1]:.2f} +- {cov[1, 1]**0.5:.2f} uN + ({line[0]:.2f} +- {cov[0, 0]**0.5:.2f}) uN s/mm v: chi2 {chi[0]:.1f} for "
          f"{len(v) - 2}; f = {slope:.2f} uN s/mm v: chi2 {chi[1]:.0f} for {len(v) - 1}\n")


LAGS = (1, 2, 4, 8, 12, 16, 20)  # a


def mirror_errors(file):
    """What a mirror along the rod should not leave, Ux odd and Uy even, over its sigma: rms, and correlation at LAGS along x."""
    with h5py.File(file) as h5:
        x, *layers = (h5["displacement"][name][:] for name in ("x", "Ux", "Uy", "sigma_x", "sigma_y"))
    far = np.hypot(*np.meshgrid(x, x[1:])) > 8.0
    rows = []
    for u, sigma, sign in ((layers[0], layers[2], -1.0), (layers[1], layers[3], 1.0)):
        odd, error = (u[1:] + sign * u[:0:-1]) / 2, np.hypot(sigma[1:], sigma[:0:-1]) / 2
        z = np.where(far, odd / error, np.nan)
        power = np.nanmean(z**2)
        rows.append((power**0.5, [np.nanmean(z[:, lag:] * z[:, :-lag]) / power for lag in LAGS]))
    return rows


def measured_pair(lab):
    """Two rods in the field measured around one, the lattice along the rods and turned."""
    def change(folder):
        last = read(folder / "rods.csv")[-1]
        return (float(last["y0"]) - float(last["y1"])) * 4.08 - 15.0  # f/mu of the scene, a
    rows = []
    for angle in (0, 90):
        out = lab.run("pair_measured.toml", f"measured_{angle}", f"granular.orientation={angle} deg")
        spread = json.loads((out / "outcome.json").read_text())["ensemble"]["final_separation"]["spread"] * 4.08
        errors = mirror_errors(out / "measure.h5")
        rows.append([f"{angle}", f"{change(out):+.2f} +- {spread:.2f}", f"{change(out / 'variants/theory'):+.2f}",
                     *(f"{rms:.2f}; {' '.join(f'{c:.2f}' for c in correlation)}" for rms, correlation in errors)])
    lags = ", ".join(map(str, LAGS))
    table("Pair 15 a apart in the measured field over half a box, kappa = 1.17",
          ["rows, deg", "Delta y, a", "theory", f"odd part of Ux over sigma: rms; correlation at {lags} a", "even part of Uy"], rows)


def cpu_seconds(lab, scene, name):
    out = lab.folder / name
    command = [lab.program, "dem", scene, "-o", out, "--quiet", "--force"]
    if subprocess.run([str(part) for part in command]).returncode != 0:
        sys.exit(f"{command}: failed")
    return json.loads((out / "summary.json").read_text())["cpu_seconds"]


def cost(lab):
    bed = ('schema = 1\n[granular]\nphi_b = 0.80\nbox = "78 a"\nduration = "10 s"\n[granular.output]\nframes = "0.05 s"\nformats = []\n'
           'last_period = false\n[[granular.rods]]\nposition = ["20 a", "39 a"]\n')
    every = '[measure]\norder = true\nmicrorheology = true\nflow = true\ndisplacement = "phase"\n'
    bare, full = lab.folder / "bare.toml", lab.folder / "full.toml"
    bare.write_text(bed)
    full.write_text(bed + every)
    seconds = {"bare": [], "full": []}
    for k in range(5):  # by turns: the machine is shared
        seconds["bare"].append(cpu_seconds(lab, bare, "bare"))
        seconds["full"].append(cpu_seconds(lab, full, "full"))
    base, more = (float(np.median(seconds[key])) for key in ("bare", "full"))
    rows = [["all observers, every 0.05 s (order every 0.5 s), CPU of a run", f"{more / base - 1:+.1%} of {base:.2f} s"]]
    scene = lab.folder / "frames.toml"
    scene.write_text(bed.replace('"10 s"', '"100 s"').replace("0.05 s", "0.01 s").replace("formats = []", 'formats = ["h5md"]'))
    cpu_seconds(lab, scene, "frames")
    for what in ("order = true\norder_interval = 0.01", "microrheology = true", "flow = true", 'displacement = "phase"',
                 'displacement = "lagrangian"', 'displacement = "density"'):
        scene.write_text(scene.read_text().split("[measure]")[0] + "[measure]\n" + what + "\n")
        start = time.monotonic()
        command = [lab.program, "measure", scene, "-o", lab.folder / "frames", "--quiet", "--force"]
        if subprocess.run([str(part) for part in command]).returncode != 0:
            sys.exit(f"{command}: failed")
        rows.append([f"10001 stored frames: {what.splitlines()[0]}", f"{time.monotonic() - start:.1f} s"])
    table("Cost, 1538 beads and a rod", ["", ""], rows)


PARTS = {"order": order, "wake": wake, "large": large, "flow": flow,
         "pairs": pairs, "pairs_18": pairs_18, "turned": turned, "pursuit": pursuit,
         "force": force, "measured_pair": measured_pair, "cost": cost}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(SOURCE / "build/release/rodwake"))
    parser.add_argument("--only", default=",".join(PARTS))
    parser.add_argument("-j", type=int, default=2)
    parser.add_argument("--keep")
    parser.add_argument("--runs", type=int)
    options = parser.parse_args()
    unknown = set(options.only.split(",")) - set(PARTS)
    if unknown:
        parser.error(f"no such part: {', '.join(sorted(unknown))}; there are {', '.join(PARTS)}")
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(options.keep or scratch)
        folder.mkdir(parents=True, exist_ok=True)
        lab = Lab(options, folder)
        for name in options.only.split(","):
            PARTS[name](lab)


if __name__ == "__main__":
    main()
