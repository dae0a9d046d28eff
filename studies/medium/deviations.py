"""Large deviations of a rod's speed (arXiv 1009.5925): how often does a rod that walks go backwards for a while?

With W = displacement along the heading over that at the mean speed, in the lag tau, and F = -ln P(W)/tau, a fluctuation relation makes
F(W) - F(-W) a straight line; a drifting Brownian motion does too, with the slope -2/(tau var W), and has no kink at W = 0.
"""

from lab import columns, estimate, table, text, told

from .bed import bed, rod

RUNS = {0.70: 8, 0.80: 20}
SECONDS, SETTLE, LAG = 20.0, 4.0, 0.32  # s
BEADS = 1450


def cost():
    return sum(RUNS.values()) * (SECONDS + SETTLE) * BEADS


def run(lab, phi):
    return lab.make(f"deviations_{phi:g}", bed(
        lab.seconds(SECONDS), f"phi_b = {phi}\n", f'speed_deviations = true\ndeviation_lag = "{LAG} s"\nblock = "5 s"\nfrom = "1 s"\n',
        rod(), frames=1.0, runs=lab.count(RUNS[phi]), equilibrate=SETTLE))


def number(value, scale=1.0):
    return "-" if value is None else f"{scale * value:.3g}"


def part(lab):
    lines, lags = [], []
    for phi in RUNS:
        folder = run(lab, phi)
        found = told(folder, "measure")["speed_deviations"]
        lines.append([f"{phi:.2f}", text(estimate(found["speed"]), digits=3), number(found["lag"]), number(found["backwards"], 100),
                      *(text(estimate(found[f"deviation_{name}"]), digits=1) for name in ("slope", "cubic", "kink")),
                      number(found["gaussian_slope"]), found["pairs"]])
        by_lag = columns(folder / "deviation_lags.csv")
        for k, lag in enumerate(by_lag["lag"]):
            lags.append([f"{phi:.2f}", f"{lag:.2f}", number(by_lag["backwards"][k], 100), f"{by_lag['variance_W'][k]:.4f}",
                         *(text((by_lag[name][k], by_lag[f"{name}_error"][k]), digits=1) for name in ("slope", "cubic", "kink")),
                         f"{by_lag['gaussian_slope'][k]:.1f}"])
    table("Large deviations of a free rod's speed, at the longest lag that tells them",
          ["phi_b", "speed, a/s", "lag, s", "backwards, %", "slope of F(W) - F(-W), 1/s", "cubic", "kink", "Gaussian slope", "pairs of bins"], lines)
    table("By lag", ["phi_b", "lag, s", "backwards, %", "var W", "slope, 1/s", "cubic", "kink", "Gaussian slope"], lags)
