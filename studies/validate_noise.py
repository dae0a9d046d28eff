#!/usr/bin/python3
"""Rods that diffuse against closed forms, and how noise undoes capture; docs/noise.md has the numbers.

    studies/validate_noise.py [--program build/release/rodwake] [--runs 100000] [--map-runs 400] [--only free,passage,map] [--keep DIR]

free: mean-square displacement and heading correlation of free rods. passage: rods abreast whose separation is a Brownian motion
without drift, against the probability that it has touched the circle of contact (Carslaw and Jaeger, 13.5), at steps from long to
short. Both must agree within 3 standard errors (exit code 1 if not). map: capture probability against D_r for kappa = 1, 10, 100 at
alpha = 1 and 0.1, of two rods side by side; writes capture_noise.csv and capture_noise.png into --keep DIR. Some minutes on one core.
"""

import argparse
import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib
import numpy as np
from scipy import special

SOURCE = Path(__file__).resolve().parent.parent
RATES = (1e-4, 1e-3, 1e-2, 1e-1, 1.0)


class Lab:
    def __init__(self, program, folder):
        self.program, self.folder = program, Path(folder)

    def noise(self, name, text, **keys):
        """noise.json of a scene."""
        scene, out = self.folder / f"{name}.toml", self.folder / name
        scene.write_text("schema = 1\n" + text)
        settings = [part for key, value in keys.items() for part in ("-s", f"noise.{key}={value}")]
        subprocess.run([self.program, "rods", scene, "-o", out, "--quiet", "--force", *settings], check=True)
        return json.loads((out / "noise.json").read_text())


def free(lab, runs):
    """The largest distance from theory in standard errors."""
    D, Dt = 0.5, 0.05
    told = lab.noise("free", f"""[noise]\nrotational_diffusion = {D}\ntranslational_diffusion = {Dt}\nruns = {runs}
[[rods]]\nposition = [0, 0]\n[rods_run]\noutput_times = [0.1, 1, 4]\n""")
    worst = 0.0
    for k, t in enumerate(told["times"][1:], 1):
        theory = {"mean_square_displacement": 2 / D**2 * (D * t + np.expm1(-D * t)) + 4 * Dt * t, "heading_correlation": np.exp(-D * t)}
        for key, value in theory.items():
            found, error = told[key][k][0], told[f"{key}_error"][k][0]
            worst = max(worst, abs(found - value) / error)
            print(f"free: t = {t:g}: {key} {found:.6g} +- {error:.2g}, theory {value:.6g} ({(found - value) / error:+.1f})")
    return worst


def touched(a, r, D, t):
    """Probability that Brownian motion in the plane has come from r to the circle a; below u = 1e-7/a by what the integrand becomes."""
    low, high = np.log(1e-7 / a), np.log(np.sqrt(40 / (D * t)))
    edges = np.linspace(low, high, 200001)
    u = np.exp(0.5 * (edges[1:] + edges[:-1]))
    ja, ya, jr, yr = special.j0(u * a), special.y0(u * a), special.j0(u * r), special.y0(u * r)
    inner = np.sum(np.exp(-D * u * u * t) * (jr * ya - yr * ja) / (ja**2 + ya**2)) * (edges[1] - edges[0])
    tail = -np.log(r / a) * (np.arctan(2 / np.pi * (low + np.log(a / 2) + np.euler_gamma)) + np.pi / 2)
    return 1 + 2 / np.pi * (inner + tail)


def passage(lab, runs):
    Dt, worst = 0.2, 0.0
    for a, t in ((0.5, 0.6), (0.1, 2.0)):
        for step in (0.1, 0.002):
            told = lab.noise("passage", f"""[noise]\ntranslational_diffusion = {Dt}\nruns = {runs}\ntime_step = {step}
[[rods]]\nposition = [0, 0]\n[[rods]]\nposition = [0, 1]\n[rods_run]\nt_end = {t}\noutput_times = [{t}]\ncontact_distance = {a}\n""")
            found, theory = told["endings"]["contact"] / runs, touched(a, 1.0, 2 * Dt, t)
            error = np.sqrt(theory * (1 - theory) / runs)
            worst = max(worst, abs(found - theory) / error)
            print(f"passage: to {a} of 1 by t = {t:g}, steps of at most {step}: {found:.5f} +- {error:.5f}, closed form {theory:.5f} "
                  f"({(found - theory) / error:+.1f})")
    return worst


def capture_map(lab, runs):
    rows = []
    for alpha in (1, 0.1):
        for kappa in (1, 10, 100):
            for D in RATES:
                told = lab.noise("map", f"""[medium]\neta = 1\nalpha = {alpha}\n[coupling]\nkappa = {kappa}
[noise]\nrotational_diffusion = {D}\nruns = {runs}\n[[rods]]\nposition = [0, 2.5]\n[[rods]]\nposition = [0, -2.5]
[rods_run]\nt_end = 30\noutput_times = [30]\ncontact_distance = 0.1\n""")
                rows.append([alpha, kappa, D, *(told[f"capture_{key}"] for key in ("probability", "low", "high")), told["endings"]["pursuit"],
                             told["endings"]["failed"], told["first_contact_time"]["mean"], told["first_contact_time"]["error"]])
                print("map: alpha {} kappa {} D_r {:g}: {:.3f} ({:.3f} to {:.3f}), pursuits {}, failed {}".format(*rows[-1][:8]), flush=True)
    write_map(lab.folder, rows)


def write_map(folder, rows):
    with open(folder / "capture_noise.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["alpha", "kappa", "D_r", "capture", "low", "high", "pursuits", "failed", "contact_time", "contact_time_error"])
        writer.writerows(rows)
    sys.path.insert(0, str(SOURCE / "plots"))
    from rodwake_plots import canvas, style  # pylint: disable=import-outside-toplevel
    matplotlib.rcParams.update(style.SETTINGS)
    figure = canvas.figure(style.WIDE, 2.9)
    panels = figure.subplots(1, 2, sharey=True)
    for axes, alpha in zip(panels, (1, 0.1)):
        for colour, kappa in zip(style.ROD_COLOURS, (1, 10, 100)):
            D, p, low, high = np.array([row[2:6] for row in rows if row[:2] == [alpha, kappa]]).T
            axes.errorbar(D, p, [p - low, high - p], fmt="o-", markersize=3, linewidth=1, capsize=2, color=colour, label=rf"$\kappa = {kappa}$")
        axes.set(xscale="log", xlabel=r"$D_r\,f/(\mu v_0)$", title=rf"$\alpha = {alpha}$", ylim=(-0.02, 1.02))
    panels[0].set_ylabel("capture probability")
    panels[0].legend(frameon=False, fontsize=8)
    canvas.save(figure, folder / "capture_noise.png")
    print(folder / "capture_noise.png")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default=str(SOURCE / "build/release/rodwake"))
    parser.add_argument("--runs", type=int, default=100000)
    parser.add_argument("--map-runs", type=int, default=400)
    parser.add_argument("--only", default="free,passage,map")
    parser.add_argument("--keep", default="")
    options = parser.parse_args()
    only = options.only.split(",")
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(options.keep or scratch)
        folder.mkdir(parents=True, exist_ok=True)
        lab = Lab(options.program, folder)
        worst = max([part(lab, options.runs) for name, part in (("free", free), ("passage", passage)) if name in only], default=0.0)
        if "map" in only:
            capture_map(lab, options.map_runs)
    print(f"largest distance from theory: {worst:.1f} standard errors")
    return int(worst > 3.0)


if __name__ == "__main__":
    sys.exit(main())
