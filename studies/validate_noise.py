#!/usr/bin/python3
"""Rods that diffuse against closed forms, and how noise undoes capture; docs/noise.md has the numbers.

    studies/validate_noise.py [--program build/release/rodwake] [--runs 100000] [--map-runs 400] [--only free,passage,map] [--keep DIR]

free: mean-square displacement and heading correlation of free rods. passage: rods abreast whose separation is a Brownian motion
without drift, against the probability that it has touched the circle of contact (Carslaw and Jaeger, 13.5), at steps from long to
short. Both must agree within 3 standard errors (exit code 1 if not). map: capture probability against D_r for kappa = 1, 10, 100 at
alpha = 1 and 0.1, of two rods side by side; writes capture_noise.csv and capture_noise.png into --keep DIR. Some minutes on one core.
"""

import sys

import numpy as np
from scipy import special

from lab import drawing, open_lab, parser, read_json, write_csv

RATES = (1e-4, 1e-3, 1e-2, 1e-1, 1.0)


def noise(lab, name, text):
    """noise.json of a scene."""
    return read_json(lab.make(name, "schema = 1\n" + text, verbs=("rods",)), "noise")


def free(lab, runs):
    """The largest distance from theory in standard errors."""
    D, Dt = 0.5, 0.05
    found = noise(lab, "free", f"""[noise]\nrotational_diffusion = {D}\ntranslational_diffusion = {Dt}\nruns = {runs}
[[rods]]\nposition = [0, 0]\n[rods_run]\noutput_times = [0.1, 1, 4]\n""")
    worst = 0.0
    for k, t in enumerate(found["times"][1:], 1):
        theory = {"mean_square_displacement": 2 / D**2 * (D * t + np.expm1(-D * t)) + 4 * Dt * t, "heading_correlation": np.exp(-D * t)}
        for key, value in theory.items():
            ours, error = found[key][k][0], found[f"{key}_error"][k][0]
            worst = max(worst, abs(ours - value) / error)
            print(f"free: t = {t:g}: {key} {ours:.6g} +- {error:.2g}, theory {value:.6g} ({(ours - value) / error:+.1f})")
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
            ends = noise(lab, f"passage_{a}_{step}", f"""[noise]\ntranslational_diffusion = {Dt}\nruns = {runs}\ntime_step = {step}
[[rods]]\nposition = [0, 0]\n[[rods]]\nposition = [0, 1]\n[rods_run]\nt_end = {t}\noutput_times = [{t}]\ncontact_distance = {a}\n""")
            found, theory = ends["endings"]["contact"] / runs, touched(a, 1.0, 2 * Dt, t)
            error = np.sqrt(theory * (1 - theory) / runs)
            worst = max(worst, abs(found - theory) / error)
            print(f"passage: to {a} of 1 by t = {t:g}, steps of at most {step}: {found:.5f} +- {error:.5f}, closed form {theory:.5f} "
                  f"({(found - theory) / error:+.1f})")
    return worst


def capture_map(lab, runs):
    found = [captures(lab, runs, alpha, kappa, D) for alpha in (1, 0.1) for kappa in (1, 10, 100) for D in RATES]
    write_csv(lab.folder / "capture_noise.csv", found)
    draw_map(lab.folder / "capture_noise.png", found)


def captures(lab, runs, alpha, kappa, D):
    ends = noise(lab, f"map_{alpha}_{kappa}_{D:g}", f"""[medium]\neta = 1\nalpha = {alpha}\n[coupling]\nkappa = {kappa}
[noise]\nrotational_diffusion = {D}\nruns = {runs}\n[[rods]]\nposition = [0, 2.5]\n[[rods]]\nposition = [0, -2.5]
[rods_run]\nt_end = 30\noutput_times = [30]\ncontact_distance = 0.1\n""")
    row = {"alpha": alpha, "kappa": kappa, "D_r": D, "capture": ends["capture_probability"], "low": ends["capture_low"], "high": ends["capture_high"],
           "pursuits": ends["endings"]["pursuit"], "failed": ends["endings"]["failed"],
           "contact_time": ends["first_contact_time"]["mean"], "contact_time_error": ends["first_contact_time"]["error"]}
    print("map: alpha {} kappa {} D_r {:g}: {:.3f} ({:.3f} to {:.3f}), pursuits {}, failed {}".format(*row.values()), flush=True)
    return row


def draw_map(path, found):
    canvas, style = drawing()
    figure = canvas.figure(style.WIDE, 2.9)
    panels = figure.subplots(1, 2, sharey=True)
    for axes, alpha in zip(panels, (1, 0.1)):
        for colour, kappa in zip(style.ROD_COLOURS, (1, 10, 100)):
            here = [row for row in found if (row["alpha"], row["kappa"]) == (alpha, kappa)]
            D, p, low, high = np.array([[row[key] for key in ("D_r", "capture", "low", "high")] for row in here]).T
            axes.errorbar(D, p, [p - low, high - p], fmt="o-", markersize=3, linewidth=1, capsize=2, color=colour, label=rf"$\kappa = {kappa}$")
        axes.set(xscale="log", xlabel=r"$D_r\,f/(\mu v_0)$", title=rf"$\alpha = {alpha}$", ylim=(-0.02, 1.02))
    panels[0].set_ylabel("capture probability")
    panels[0].legend(frameon=False, fontsize=8)
    canvas.save(figure, path)
    print(path)


PARTS = {"free": free, "passage": passage, "map": capture_map}


def main():
    options = parser(__doc__, "keep", parts=PARTS)
    options.add_argument("--runs", type=int, default=100000)
    options.add_argument("--map-runs", type=int, default=400)
    options = options.parse_args()
    with open_lab(options) as lab:
        worst = max([PARTS[name](lab, options.runs) for name in options.only if name != "map"], default=0.0)
        if "map" in options.only:
            capture_map(lab, options.map_runs)
    print(f"largest distance from theory: {worst:.1f} standard errors")
    return int(worst > 3.0)


if __name__ == "__main__":
    sys.exit(main())
