#!/usr/bin/python3
"""Validation of the measures on granular runs: every number of studies/reports/measure.md that comes from [measure] on a bed.

    studies/validate_measure.py [--program build/release/rodwake] [--only order,wake,large,flow,pairs,pairs_18,turned,pursuit,force,measured_pair,cost]
                              [-j 2] [--keep DIR] [--runs N]

Runs the scenes of scenes/ and prints Markdown: each line a number with its standard error. --keep DIR keeps the results and
takes up what is there; --runs N replaces the scenes' number of runs (fewer: larger errors).
"""

import time

import numpy as np

from lab import cases, columns, datasets, estimate, line_fit, parser, ratio, rows, run_parts, table, text, read_json, weighted

BINS_PER_VALUE = 4.2  # bins of 1 a closer than two lattice spacings share data: a fit has fewer values than bins
TERMS = 4000          # of the Fourier series of a periodic wake: a thousandth is enough beside measured profiles
CORE_ETAS = [(core, eta) for core in (8.0, 10.0) for eta in (0.5, 1.3, 5.0)]
A = 0.4               # mm, radius of a bead


def made(lab, scene, name, *settings):
    """The run directory of a scene, simulated and measured."""
    return lab.make(name, scene, *settings, *([f"granular.runs={lab.options.runs}"] if lab.options.runs else []))


def measured(folder):
    return read_json(folder, "measure")


def shown(entry, scale=1.0, digits=3):
    return text(estimate(entry), scale, digits)


def order(lab):
    found = []
    for _, folder in cases(made(lab, "order.toml", "order")):
        m = measured(folder)
        o, r = m["order"], m["microrheology"]
        found.append([f"{m['phi_b']:.2f}", shown(o["psi6"]), f"{o['g_minimum']:.2f}" if o["g_minimum"] else "-", o["class"], shown(o["exponent"]),
                      f"{r['stiffness']['value']:.4f} +- {r['scatter']:.4f} +- {r['bend']:.4f}", shown(r["spring"], 1e3)])
    table("Order and stiffness", ["phi_b", "psi6", "first minimum of g, a", "g_B", "exponent", "stiffness, 1/a^2, +- scatter +- bend",
                                   "k, mN/m"], found)


# The wake around a rod, and the steady field of a rod in a periodic box, zero mode removed (docs/numerics.md), by its Fourier series.


def profile(folder, name):
    return columns(folder / f"profile_{name}.csv", "x", "value", "sigma")


def shared(sigma):
    """Errors with which a fit may take the bins as independent."""
    return sigma * np.sqrt(BINS_PER_VALUE)


def potential(x, y, c, box):
    """G, dG/dx and dG/dy of lap G + 2 c dG/dx = -2 pi (delta - 1/L^2), for 0 < x < L."""
    x, y = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
    q = 2.0 * np.pi * np.arange(1, TERMS + 1) / box
    s = np.sqrt(c * c + q * q)
    down, up = -c - s, -c + s
    xs, ys = x.reshape(-1, 1), y.reshape(-1, 1)
    strength = 2.0 * np.pi / box / (2.0 * s)
    behind = strength * np.exp(down * xs) / -np.expm1(down * box)
    ahead = strength * np.exp(up * (xs - box)) / -np.expm1(-up * box)
    wave, slope = np.cos(q * ys), -q * np.sin(q * ys)
    A = -(2.0 * np.pi / box) / -np.expm1(-2.0 * c * box)
    x0 = x.reshape(-1)
    mean = np.pi * x0 / (c * box**2) - A * np.exp(-2.0 * c * x0) / (2.0 * c) - np.pi / (2.0 * c * box) - np.pi / (2.0 * c**2 * box**2)
    mean_slope = np.pi / (c * box**2) + A * np.exp(-2.0 * c * x0)
    G = mean + 2.0 * ((behind + ahead) * wave).sum(1)
    Gx = mean_slope + 2.0 * ((down * behind + up * ahead) * wave).sum(1)
    Gy = 2.0 * ((behind + ahead) * slope).sum(1)
    return G.reshape(x.shape), Gx.reshape(x.shape), Gy.reshape(x.shape)


def periodic_field(x, y, f_over_mu, xi, eta, box):
    """U_x, U_y at places in the rod's frame; x = 0 itself is taken a little ahead of it."""
    inside = np.mod(x, box)
    inside = np.clip(inside, 1e-6 * box, (1.0 - 1e-6) * box)
    c_shear, c_long = 1.0 / (2.0 * xi), 1.0 / ((1.0 + eta) * 2.0 * xi)
    GT, GTx, GTy = potential(inside, y, c_shear, box)
    _, GLx, GLy = potential(inside, y, c_long, box)
    scale = f_over_mu / (2.0 * np.pi)
    return scale * (GT + xi * (GTx - GLx)), scale * xi * (GTy - GLy)


def fit_wake(x, U, sigma, box, core, eta):
    """f/mu and xi of U_x(x, 0) at fixed eta by Gauss-Newton on their logarithms, errors scaled by chi."""
    use = np.abs(x) > core
    x, U, sigma = x[use], U[use], sigma[use]
    p = np.log([3.0, 12.0])

    def model(p):
        return periodic_field(x, 0.0 * x, np.exp(p[0]), np.exp(p[1]), eta, box)[0]

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


def scale_of(value, sigma, theory):
    """The factor k of value = k theory, with its error (scaled by chi)."""
    w = theory / sigma**2
    k = np.sum(w * value) / np.sum(w * theory)
    chi2 = np.sum(((value - k * theory) / sigma) ** 2) * BINS_PER_VALUE / max(1, len(value) - 1)
    return text((k, np.sqrt(max(1.0, chi2) / np.sum(w * theory))))


def decays(folder):
    """U_x on the axis behind and ahead, from the value half a box away, which both sides share."""
    x, U, sigma = profile(folder, "Ux_x")
    for distance in (9.0, 15.0, 21.0, 27.0):
        behind, ahead = ((U[k] - U[0], sigma[k]) for k in (np.argmin(np.abs(x + distance)), np.argmin(np.abs(x - distance))))
        yield [f"{distance:g}", text(behind, digits=3), text(ahead, digits=3), text(ratio(behind, ahead), digits=1)]


def beside_wake(folder, values, eta, box, core):
    """Measured over theory with the values fitted: U_x(0, y), U_y(x, 4a), it ahead of the rod, U_y(0, y)."""
    for which, component in (("Ux_y", 0), ("Uy_x", 1), ("Uy_y", 1)):
        s, v, d = profile(folder, which)
        x, y = (s, np.full_like(s, 4.0)) if which.endswith("_x") else (np.zeros_like(s), s)
        theory = periodic_field(x, y, *values, eta, box)[component]
        for use in (np.abs(s) > core, s > core)[:2 if which == "Uy_x" else 1]:
            yield scale_of(v[use], shared(d[use]), theory[use])


def wake(lab, scene="wake.toml", name="wake", title="Wake in the 78 a box", box=78.0):
    folder = made(lab, scene, name)
    m = measured(folder)["displacement"]
    x, U, sigma = profile(folder, "Ux_x")
    table(title + ": U_x(x,0) - U_x(L/2,0)", ["distance, a", "behind, a", "ahead, a", "ratio"], decays(folder))
    found = [["blocks, frames, rod speed", f"{m['blocks']}, {m['frames']}, {m['mean_speed']:.2f} a/s"]]
    for core, eta in CORE_ETAS:
        p, e, chi2, dof = fit_wake(x, U, shared(sigma), box, core, eta)
        found += [[f"|x| > {core:g} a, eta = {eta}: f/mu, xi; chi2/dof",
                   f"{p[0]:.2f} +- {e[0]:.2f} a, {p[1]:.1f} +- {e[1]:.1f} a; {chi2:.0f}/{dof:.0f}"],
                  ["measured over theory: U_x(0,y); U_y(x,4a) all; ahead; U_y(0,y)", "; ".join(beside_wake(folder, p, eta, box, core))]]
    table(title, ["", ""], found)
    return folder


def power_behind(x, U, sigma, low, high):
    """The power of |x| with which U_x falls behind the rod, and its error."""
    here = (-x >= low) & (-x <= high) & (U > 0)
    return line_fit(np.log(-x[here]), np.log(U[here]), shared(sigma[here]) / U[here])[0]


def large(lab):
    x, U, sigma = profile(wake(lab, "wake_large.toml", "large", "Wake in the 155 a box", 155.0), "Ux_x")
    found = []
    for low, high in ((9.0, 15.0), (15.0, 21.0), (9.0, 21.0)):
        use = (-x >= low) & (-x <= high)
        s, v, d = -x[use], np.sqrt(-x[use]) * U[use], np.sqrt(-x[use]) * shared(sigma[use])
        found.append([f"{low:g} to {high:g} a behind", text(weighted(zip(v, d)), digits=3), text(line_fit(s, v, d)[0], digits=4),
                      text(power_behind(x, U, sigma, low, high))])
    table("|x|^(1/2) U_x behind the rod in the 155 a box", ["", "mean, a^(3/2)", "slope, a^(1/2)", "power of |x| of U_x"], found)


def flow_far(folder):
    """Velocity of the beads 10 to 22 a behind and ahead of the rod, along its heading, a/s."""
    x, y, v, sigma = datasets(folder / "measure.h5", "flow", "x", "y", "vx", "sigma_x")
    strips = (np.ix_(np.abs(y) < 3.1, (x >= low) & (x <= high)) for low, high in ((-22, -10), (10, 22)))
    return [weighted(zip(v[strip].ravel(), np.maximum(sigma[strip], 1e-9).ravel())) for strip in strips]


def flow(lab):
    found = []
    for row, folder in cases(made(lab, "bead_drag.toml", "flow")):
        f = measured(folder)["flow"]
        far = (f"{value:+.2f} +- {error:.2f}" for value, error in flow_far(folder))
        found.append([f"{float(row['phi_b']):.2f}", *far, f"{f['near_speed']:.2f}", shown(f["drag"], 1, 2), shown(f["drag_share"])])
    table("Flow around the rod", ["phi_b", "v_x 10 to 22 a behind, a/s", "ahead, a/s", "mean speed within 6 a, a/s",
                                  "drag of the beads within 6 a over 20 a of the rod's way, a", "share of it"], found)


def pair_table(lab, title, name, *settings):
    found = []
    for row, folder in cases(made(lab, "pair_series.toml", name, *settings)):
        p = measured(folder)["pairs"]
        found.append([f"{float(row['phi_b']):.2f}", f"{float(row['d0']):.1f}", f"{float(row['delta_y']):+.2f} +- {float(row['delta_y_error']):.2f}",
                      p["half_box_change"]["samples"], shown(p["non_reciprocity"], 1, 2)])
    table(title, ["phi_b", "d0, a", "Delta y over half the box, a", "runs", "non-reciprocity"], found)


def pairs(lab):
    pair_table(lab, "Pairs 15 a apart, rows along the rods", "pairs")


def pairs_18(lab):
    pair_table(lab, "Pairs 18 a apart, rows along the rods", "pairs_18", "granular.rods.0.position=[20 a, 48 a]", "granular.rods.1.position=[20 a, 30 a]")


def turned(lab):
    pair_table(lab, "Pairs 15 a apart, rows turned by 90 degrees", "turned", "granular.orientation=1.5707963267948966")


def pursuit(lab):
    p = measured(made(lab, "pursuit_bed.toml", "pursuit"))["pairs"]
    table("Perpendicular starts, phi_b = 0.78", ["contact, pursuit, escape", "turn of the rear, rad", "of the front, rad", "non-reciprocity"],
          [[f"{p['contact']}, {p['pursuit']}, {p['escape']}", shown(p["turn_rear"]), shown(p["turn_front"]), shown(p["non_reciprocity"], 1, 2)]])


def force_points(folder):
    """Speeds, mm/s, forces and their errors, uN."""
    scaled = [(float(row["imposed_speed"]) * A, 1e6 * float(row["force"]), 1e6 * float(row["force_error"])) for row, _ in cases(folder)]
    return map(np.array, zip(*scaled))


def force(lab):
    folder = made(lab, "force.toml", "force")
    v, f, e = force_points(folder)
    table("Force against imposed speed", ["speed, mm/s", "force, uN", "runs"],
          [[f"{speed:.2f}", text(pair, digits=3), row["runs"]] for speed, pair, (row, _) in zip(v, zip(f, e), cases(folder))])
    line, rest, _ = line_fit(v, f, e)
    slope = np.sum(v * f / e**2) / np.sum(v**2 / e**2)
    chi = [float(np.sum(((f - model) / e) ** 2)) for model in (line[0] * v + rest[0], slope * v)]
    print(f"f = {text(rest)} uN + ({text(line)}) uN s/mm v: chi2 {chi[0]:.1f} for {len(v) - 2}; "
          f"f = {slope:.2f} uN s/mm v: chi2 {chi[1]:.0f} for {len(v) - 1}\n")


LAGS = (1, 2, 4, 8, 12, 16, 20)  # a


def mirror_errors(file):
    """What a mirror along the rod should not leave, Ux odd and Uy even, over its sigma: rms, and correlation at LAGS along x."""
    x, *layers = datasets(file, "displacement", "x", "Ux", "Uy", "sigma_x", "sigma_y")
    far = np.hypot(*np.meshgrid(x, x[1:])) > 8.0
    for u, sigma, sign in ((layers[0], layers[2], -1.0), (layers[1], layers[3], 1.0)):
        odd, error = (u[1:] + sign * u[:0:-1]) / 2, np.hypot(sigma[1:], sigma[:0:-1]) / 2
        z = np.where(far, odd / error, np.nan)
        power = np.nanmean(z**2)
        yield f"{power**0.5:.2f}; " + " ".join(f"{np.nanmean(z[:, lag:] * z[:, :-lag]) / power:.2f}" for lag in LAGS)


def change(folder):
    """Of the separation of a pair that starts 15 a apart, a."""
    last = rows(folder / "rods.csv")[-1]
    return (float(last["y0"]) - float(last["y1"])) * 4.08 - 15.0  # f/mu of the scene (of a line, not of the medium), a


def measured_pair(lab):
    """Two rods in the field measured around one, the lattice along the rods and turned."""
    found = []
    for angle in (0, 90):
        out = made(lab, "pair_measured.toml", f"measured_{angle}", f"granular.orientation={angle} deg")
        spread = read_json(out, "outcome")["ensemble"]["final_separation"]["spread"] * 4.08
        found.append([angle, f"{change(out):+.2f} +- {spread:.2f}", f"{change(out / 'variants/theory'):+.2f}", *mirror_errors(out / "measure.h5")])
    lags = ", ".join(map(str, LAGS))
    table("Pair 15 a apart in the measured field over half a box, kappa = 1.17",
          ["rows, deg", "Delta y, a", "theory", f"odd part of Ux over sigma: rms; correlation at {lags} a", "even part of Uy"], found)


BED = """schema = 1
[granular]
phi_b = 0.80
box = "78 a"
duration = "10 s"
[granular.output]
frames = "0.05 s"
formats = []
last_period = false
[[granular.rods]]
position = ["20 a", "39 a"]
"""
OBSERVERS = ("order = true\norder_interval = 0.01", "microrheology = true", "flow = true", 'displacement = "phase"',
             'displacement = "lagrangian"', 'displacement = "density"')


def cpu_seconds(lab, name, scene):
    file, out = lab.write(f"{name}.toml", scene), lab.folder / name
    lab.call("dem", file, "-o", out, "--quiet", "--force")
    return read_json(out, "summary")["cpu_seconds"]


def cost(lab):
    every = '[measure]\norder = true\nmicrorheology = true\nflow = true\ndisplacement = "phase"\n'
    turns = [(cpu_seconds(lab, "bare", BED), cpu_seconds(lab, "full", BED + every)) for _ in range(5)]  # by turns: the machine is shared
    base, more = np.median(turns, axis=0)
    found = [["all observers, every 0.05 s (order every 0.5 s), CPU of a run", f"{more / base - 1:+.1%} of {base:.2f} s"]]
    many = BED.replace('"10 s"', '"100 s"').replace("0.05 s", "0.01 s").replace("formats = []", 'formats = ["h5md"]')
    cpu_seconds(lab, "frames", many)
    for what in OBSERVERS:
        file, start = lab.write("frames.toml", f"{many}[measure]\n{what}\n"), time.monotonic()
        lab.call("measure", file, "-o", lab.folder / "frames", "--quiet", "--force")
        found.append([f"10001 stored frames: {what.splitlines()[0]}", f"{time.monotonic() - start:.1f} s"])
    table("Cost, 1538 beads and a rod", ["", ""], found)


PARTS = {"order": order, "wake": wake, "large": large, "flow": flow, "pairs": pairs, "pairs_18": pairs_18, "turned": turned, "pursuit": pursuit,
         "force": force, "measured_pair": measured_pair, "cost": cost}

if __name__ == "__main__":
    run_parts(parser(__doc__, "report", "threads", "keep", "runs", parts=PARTS).parse_args(), PARTS)
