#!/usr/bin/python3
"""The error of the quasi-static closure, which gives each rod its steady wake, turned to its heading at once.

    studies/validate_closure.py [--quick] [--dry-run] [--only circle,map,rest,width] [-o results/closure]

circle: the strain around a rod that has always walked a circle, exact against steady wakes and against wakes to first order in the
turning rate. map: encounters with the paper's starts over kappa, gamma and alpha, in steady wakes, to first order
and with memory, in one box with one force. rest: the same in steady wakes and in a medium that is undeformed at t = 0. width: what the
force's width, the modes and the box change. Writes closure_*.csv, closure.md (the tables of studies/reports/medium.md) and closure_*.png into
-o. Encounters are made by build/release/bench/bench_closure (tools/bench builds it) and kept, so that
the same command goes on where it was stopped. --dry-run says what is left and what it costs; --quick is a reduced variant of a minute.
"""

import json
import subprocess
from pathlib import Path

import numpy as np

from lab import PROGRAM, SOURCE, Lab, drawing, keep_line, kept_lines, markdown, parser, report_page, stamp, write_csv, write_report
from validate_field import Modes, bessel_orders, circle_errors

CLOSURES = ("steady", "first_order")
ETA, BOX, WIDTH, MODES, CONTACT = 1.0, 40.0, 0.5, 96, 1.0
NEAR = 2.0  # f/mu: headings are not compared below; closer than 4 widths the force's shape matters
COST = {"plane": 0.01, "box": 0.05, "steady": 0.1, "first_order": 1.0, "memory": 0.7, "rest": 0.7}  # CPU s at 96 modes to t = 16
RIGHT = np.pi / 2
STARTS = {"abreast": ((0, 2.5, 0), (0, -2.5, 0), 30.0)} | {
    f"crossing, dx = {dx}": ((0, 0, 0), (dx, -5, RIGHT), 16.0) for dx in (-3, 0, 1, 3)}
POLAR_STARTS = ("abreast", "crossing, dx = 1", "crossing, dx = 3")
REST_STARTS = ("abreast", "crossing, dx = 1")
KAPPAS, ALPHAS = (1, 3, 10, 30, 100), (0.1, 0.3, 1, 3, 10)
POLAR, OTHER_ALPHAS = tuple((0, one, two) for one in (10, -10) for two in (10, -10)), (0.1, 1, 10)


class Runs:
    """Encounters by their specification; those that are not there are made by one process and appended as they come."""

    def __init__(self, program, folder):
        self.program, self.file = program, folder / "runs.jsonl"
        self.known = {record.pop("case"): record for record in kept_lines(self.file)}

    def make(self, cases):
        left = [case for case in dict.fromkeys(cases) if case not in self.known]
        if not left:
            return
        with subprocess.Popen([self.program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
            for number, case in enumerate(left, 1):
                print(case, file=process.stdin, flush=True)
                record = json.loads(process.stdout.readline() or "null")
                if record is None:
                    raise SystemExit(f"{self.program} gave up at: {case}")
                self.known[case] = record
                keep_line(self.file, {"case": case, **record})
                print(f"{number} of {len(left)}: {case}: {record['ending']} at {record['time']:.4g}, {record['cpu_seconds']:.2f} s", flush=True)
            process.stdin.close()


def case(how, start, couplings, alpha, box=BOX, width=WIDTH, modes=MODES):
    one, two, end = STARTS[start]
    return " ".join([how] + [f"{value:.10g}" for value in (ETA, alpha, *couplings, box, width, modes, end, CONTACT, *one, *two)])


def cost(spec):
    how, modes, end = spec.split()[0], float(spec.split()[8]), float(spec.split()[9])
    return COST[how] * end / 16.0 * ((modes / 96) ** 2 if how in CLOSURES + ("memory", "rest") else 1.0)


def encounters(quick):
    """(start, couplings, alpha) of the map."""
    if quick:
        return over(("abreast",), quick)
    away = [(start, (-100, 0, 0), alpha) for start in STARTS if start != "abreast" for alpha in OTHER_ALPHAS]
    return over(STARTS, quick) + away + [(start, polar, alpha) for start in POLAR_STARTS for alpha in OTHER_ALPHAS for polar in POLAR]


def rests(quick):
    """Those from rest."""
    return over(REST_STARTS[:1] if quick else REST_STARTS, quick)


def over(starts, quick):
    kappas, alphas = ((1, 10, 100), (0.1, 1)) if quick else (KAPPAS, ALPHAS)
    return [(start, (kappa, 0, 0), alpha) for start in starts for alpha in alphas for kappa in kappas]


SETTINGS = {"box 40, w = 0.5, 96 modes": (40.0, 0.5, 96), "128 modes": (40.0, 0.5, 128),
            "w = 0.25, 192 modes": (40.0, 0.25, 192), "box 56, 136 modes": (56.0, 0.5, 136)}
WIDTH_CASES = (("abreast", (10, 0, 0), 0.1), ("abreast", (10, 0, 0), 1), ("crossing, dx = 1", (10, 0, 0), 1),
               ("crossing, dx = 1", (100, 0, 0), 1))


def heading_difference(one, other):
    """The largest of any rod, rad, at the times of output that both have, while the rods are farther than NEAR apart in both. None of a run that
    failed: it stopped before it could go astray."""
    if "failed" in (one["ending"], other["ending"]):
        return float("nan")
    a, b = (np.array(run["poses"][:-1]).reshape(-1, 6) for run in (one, other))
    both = min(len(a), len(b))
    a, b = a[:both], b[:both]
    close = [np.hypot(poses[:, 0] - poses[:, 3], poses[:, 1] - poses[:, 4]) < NEAR for poses in (a, b)]
    until = np.flatnonzero(close[0] | close[1])
    until = until[0] if len(until) else both
    return max(np.abs(a[:until, k] - b[:until, k]).max() for k in (2, 5))


def memory_number(run, alpha):
    """The largest |theta'| alpha r^2/4 of a run while the rods are farther than NEAR apart: headings' change over the time that a field takes
    from rod to rod."""
    poses = np.array(run["poses"][:-1]).reshape(-1, 6)
    apart = np.hypot(poses[:, 0] - poses[:, 3], poses[:, 1] - poses[:, 4])
    near = np.flatnonzero(apart < NEAR)
    until = near[0] if len(near) else len(poses)
    if until < 2:
        return float("nan")
    rates = np.abs(np.diff(poses[:until, (2, 5)], axis=0)).max(axis=1) / 0.25
    return float((rates * alpha * apart[1:until] ** 2 / 4).max())


def spreading_time(start, alpha):
    """What a field takes from rod to rod at the start, alpha r^2/4."""
    one, two, _ = STARTS[start]
    return alpha * ((one[0] - two[0])**2 + (one[1] - two[1])**2) / 4


def compared(runs, start, couplings, alpha, medium="memory", closures=CLOSURES):
    """Closures against the medium, from the wakes of straight rods (memory) or from rest."""
    memory = runs.known[case(medium, start, couplings, alpha)]
    row = {"start": start, "kappa": couplings[0], "gamma1": couplings[1], "gamma2": couplings[2], "alpha": alpha,
           "spreading_time": spreading_time(start, alpha), "memory": memory["ending"], "memory_time": memory["time"]}
    for how in closures:
        run = runs.known[case(how, start, couplings, alpha)]
        both = run["ending"] == memory["ending"] == "contact"
        row |= {how: run["ending"], f"{how}_time": run["time"], f"{how}_heading": heading_difference(run, memory),
                f"{how}_time_error": run["time"] / memory["time"] - 1 if both else float("nan")}
    row["memory_number"] = memory_number(runs.known[case("steady", start, couplings, alpha)], alpha)
    return row


def on_points(runs, row):
    """How the encounter of a row ends in steady wakes of point forces."""
    couplings = row["kappa"], row["gamma1"], row["gamma2"]
    for how in ("box", "plane"):
        run = runs.known[case(how, row["start"], couplings, row["alpha"])]
        row |= {how: run["ending"], f"{how}_time": run["time"]}
    return row


def circles(quick):
    """Rows of the circle: alpha, distance, turning rate, errors, time of memory."""
    alphas, rates = ((0.1, 1, 10), (0.1, 1.0)) if quick else (ALPHAS, (0.01, 0.03, 0.1, 0.3, 1.0))
    modes, distances, rows = Modes(BOX, WIDTH, 64 if quick else MODES), (2.0, 4.0, 8.0), []
    for rate in rates:
        table = bessel_orders(modes, rate)
        for alpha in alphas:
            found = circle_errors(modes, alpha, ETA, rate, 0.4, distances, table)
            rows += [{"alpha": alpha, "distance": r, "turning_rate": rate, "steady": steady, "first_order": first, "memory_time": time}
                     for r, (steady, first, time) in zip(distances, found)]
    return rows


# Tables of studies/reports/medium.md.


def same_ending(row, how):
    """Escaped, and undecided at the end, are both: not captured."""
    one, other = ("apart" if row[way] in ("escape", "undecided") else row[way] for way in (how, "memory"))
    return one == other != "failed"


def cell(row, how):
    """Of a table: how far off contact and headings are, or the two endings."""
    if not same_ending(row, how):
        return f"**{row[how]}, not {row['memory']}**"
    time = f"{100 * row[f'{how}_time_error']:+.1f} %, " if row["memory"] == "contact" else ""
    return f"{time}{row[f'{how}_heading']:.2g}"


def grid(rows, down, across):
    """A table of the steady closure: alpha and what else `down` tells, over what `across` tells; both make headed cells of a row."""
    columns = list(dict.fromkeys(across(row) for row in rows))
    lines = {}
    for row in rows:
        lines.setdefault(down(row), {})[across(row)] = cell(row, "steady")
    titles = [name for name, _ in next(iter(lines))] + columns
    return of(titles, [[text for _, text in left] + [cells.get(column, "") for column in columns] for left, cells in lines.items()])


def of(head, body):
    """The lines of a table, after an empty one."""
    return ["", *markdown(head, body).split("\n")]


def by_alpha(row):
    return (("alpha", f"{row['alpha']:g}"),)


def by_start_and_alpha(row):
    return (("start", row["start"]), *by_alpha(row))


def by_spreading_time(row):
    return (*by_alpha(row), ("alpha r^2/4", f"{row['spreading_time']:.2g}"))


def by_kappa(row):
    return f"kappa = {row['kappa']:g}"


def by_gamma(row):
    return f"gamma1 = {row['gamma1']:g}, gamma2 = {row['gamma2']:g}"


def tables_by_start(rows, title, down):
    lines = []
    for start in dict.fromkeys(row["start"] for row in rows):
        lines += ["", f"{title}{start}:"] + grid([row for row in rows if row["start"] == start], down, by_kappa)
    return lines


def map_tables(rows):
    lines = tables_by_start([row for row in rows if row["kappa"] > 0], "Steady wakes, ", by_alpha)
    away, polar = ([row for row in rows if row["kappa"] < 0], [row for row in rows if row["kappa"] == 0])
    if away:
        lines += ["", "Steady wakes, kappa = -100:"] + grid(away, by_alpha, lambda row: row["start"])
    if polar:
        lines += ["", "Steady wakes, polar couplings alone:"] + grid(polar, by_start_and_alpha, by_gamma)
    return lines + summary(rows)


def rest_tables(rows):
    return tables_by_start(rows, "Steady wakes against a medium at rest at t = 0, ", by_spreading_time)


BINS = (0.0, 0.03, 0.1, 0.3, 1.0, 3.0, np.inf)


def summary(rows):
    """How good closures are, by the largest |theta'| alpha r^2/4 of the steady run."""
    body = []
    for low, high in zip(BINS, BINS[1:]):
        here = [row for row in rows if low <= row["memory_number"] < high]
        times = np.array([100 * abs(row["steady_time_error"]) for row in here if np.isfinite(row["steady_time_error"])])
        off = [np.array([row[f"{how}_heading"] for row in here]) for how in CLOSURES]
        if here:
            body.append([f"{low:g} to {high:g}", len(here), *(sum(same_ending(row, how) for row in here) for how in CLOSURES),
                         f"{np.median(times):.3g} % ({times.max():.3g} %)" if len(times) else "no contacts", *map(heading_words, off),
                         (off[1] < off[0]).sum()])
    return of(["largest theta' alpha r^2/4", "encounters", "same ending: steady", "first order", "time of contact off, median (largest): steady",
               "heading off: steady", "first order", "first order nearer"], body)


def heading_words(off):
    off = off[np.isfinite(off)]
    return f"{np.median(off):.2g} ({off.max():.2g})" if len(off) else "none"


def circle_table(rows):
    rates, body = sorted({row["turning_rate"] for row in rows}), []
    for alpha, r in sorted({(row["alpha"], row["distance"]) for row in rows}):
        here = sorted((row for row in rows if (row["alpha"], row["distance"]) == (alpha, r)), key=lambda row: row["turning_rate"])
        body.append([f"{alpha:g}", f"{r:g}", f"{here[0]['memory_time']:.2g}", *(f"{row['steady']:.2g}, {row['first_order']:.2g}" for row in here)])
    return of(["alpha", "distance", "time of memory", *(f"theta' = {rate:g}" for rate in rates)], body)


def width_table(runs):
    body = []
    for start, couplings, alpha in WIDTH_CASES:
        cells = []
        for setting in SETTINGS.values():
            memory, steady = (runs.known[case(how, start, couplings, alpha, *setting)] for how in ("memory", "steady"))
            cells.append(f"{ending(memory)}; {ending(steady)}; {heading_difference(steady, memory):.3g}")
        body.append([f"{start}, {couplings}, alpha = {alpha:g}", *cells, ending(runs.known[case("box", start, couplings, alpha)])])
    return of(["encounter", *SETTINGS, "steady, box of 40, point forces"], body)


def ending(run):
    return f"{run['time']:.4g}" if run["ending"] == "contact" else run["ending"]


# Figures.


def draw_circle(rows, path):
    canvas, style = drawing()
    figure = canvas.figure(style.WIDE, 2.9)
    panels = figure.subplots(1, 2, sharey=True)
    for axes, how, title in zip(panels, CLOSURES, ("steady wake", "to first order")):
        for colour, alpha in zip(style.ROD_COLOURS, sorted({row["alpha"] for row in rows})):
            here = [row for row in rows if row["alpha"] == alpha]
            axes.plot([row["turning_rate"] * row["memory_time"] for row in here], [row[how] for row in here], "o", markersize=3, color=colour,
                      label=rf"$\alpha = {alpha:g}$")
        scale = np.array([3e-4, 30.0])
        axes.plot(scale, scale if how == "steady" else scale**2, "k:", linewidth=0.8)
        axes.set(xscale="log", yscale="log", xlim=scale, ylim=(1e-6, 30), xlabel=r"$\theta'\,\tau$", title=title)
    panels[0].set_ylabel("relative error of the strain")
    panels[0].legend(frameon=False, fontsize=8)
    canvas.save(figure, path)


def panels_of(rows, title):
    """Apolar rods of each start, by the title of their panel."""
    starts = dict.fromkeys(row["start"] for row in rows)
    return {title + start: [row for row in rows if row["start"] == start and row["kappa"] > 0] for start in starts}


def draw_maps(maps, path):
    """The steady closure's error over kappa and alpha: a panel a start, four in a row, crossing ones first; the bar of colours follows the last."""
    canvas, style = drawing()
    lines = len(maps) // 4 + 1
    figure = canvas.figure(style.WIDE, 0.3 + 2.0 * lines)
    panels = figure.subplots(lines, 4, sharex=True, sharey=True, squeeze=False)
    for axes, (title, rows) in zip(panels.flat, sorted(maps.items(), key=lambda item: not item[0].startswith("crossing"))):
        image = draw_panel(axes, rows)
        axes.set_title(title, fontsize=9)
    for axes in panels[:, 0]:
        axes.set_ylabel(r"$\alpha$")
    for axes in panels.flat[len(maps):]:
        axes.set_axis_off()
    for axes in panels.flat[max(len(maps) - 4, 0):len(maps)]:
        axes.set_xlabel(r"$\kappa f/(\mu v_0)$")
        axes.tick_params(labelbottom=True)
    bar = figure.colorbar(image, cax=panels.flat[len(maps)].inset_axes((0.1, 0.0, 0.1, 1.0)), ticks=[-3, -2, -1, 0])
    bar.set_ticklabels(["0.001", "0.01", "0.1", "1"])
    bar.set_label("largest difference\nin heading (rad)")
    canvas.save(figure, path)


def draw_panel(axes, rows):
    kappas, alphas = (sorted({row[key] for row in rows}) for key in ("kappa", "alpha"))
    off = np.full((len(alphas), len(kappas)), np.nan)
    for row in rows:
        i, j = alphas.index(row["alpha"]), kappas.index(row["kappa"])
        off[i, j] = row["steady_heading"]
        if not same_ending(row, "steady"):
            axes.plot(j, i, "kx", markersize=6)
    axes.set_xticks(range(len(kappas)), [f"{kappa:g}" for kappa in kappas])
    axes.set_yticks(range(len(alphas)), [f"{alpha:g}" for alpha in alphas])
    axes.tick_params(length=0)
    return axes.imshow(np.log10(np.maximum(off, 1e-12)), origin="lower", aspect="auto", vmin=-3, vmax=0.5, cmap="YlOrRd")


PARTS = ("circle", "map", "rest", "width")


def read_options():
    found = parser(__doc__, "report", "quick", parts=PARTS, program=SOURCE / "build/release/bench/bench_closure")
    found.add_argument("--dry-run", action="store_true", help="say what is left and what it costs")
    found.add_argument("-o", "--output", type=Path, default=SOURCE / "results/closure")
    return found.parse_args()


def wanted(options):
    cases = []
    if "map" in options.only:
        cases += [case(how, *one) for one in encounters(options.quick) for how in ("memory", *CLOSURES, "box", "plane")]
    if "rest" in options.only:
        cases += [case(how, *one) for one in rests(options.quick) for how in ("rest", "steady")]
    if "width" in options.only and not options.quick:
        cases += [case(how, *one, *setting) for one in WIDTH_CASES for setting in SETTINGS.values() for how in ("memory", "steady")]
        cases += [case("box", *one) for one in WIDTH_CASES]
    return cases


def shown(value):
    return f"{value:.6g}" if isinstance(value, float) else value


def report(options, runs):
    """Writes rows and figures; the lines of the tables of each part."""
    lines, maps = {}, {}
    if "circle" in options.only:
        rows = circles(options.quick)
        write_csv(options.output / "closure_circle.csv", rows, shown)
        lines["circle"] = circle_table(rows)
        draw_circle(rows, options.output / "closure_circle.png")
    if "map" in options.only:
        rows = [on_points(runs, compared(runs, *one)) for one in encounters(options.quick)]
        write_csv(options.output / "closure_map.csv", rows, shown)
        lines["map"] = map_tables(rows)
        maps |= panels_of(rows, "")
    if "rest" in options.only:
        rows = [compared(runs, *one, medium="rest", closures=("steady",)) for one in rests(options.quick)]
        write_csv(options.output / "closure_rest.csv", rows, shown)
        lines["rest"] = rest_tables(rows)
        maps |= panels_of(rows, "from rest: ")
    if maps:
        draw_maps(maps, options.output / "closure_map.png")
    return lines | ({"width": width_table(runs)} if "width" in options.only and not options.quick else {})


def main():
    options = read_options()
    options.output.mkdir(parents=True, exist_ok=True)
    runs, cases = Runs(options.program, options.output), wanted(options)
    left = [one for one in dict.fromkeys(cases) if one not in runs.known]
    print(f"{len(left)} of {len(set(cases))} encounters to make, about {sum(map(cost, left)) / 60:.1f} CPU minutes", flush=True)
    if options.dry_run:
        return
    runs.make(cases)
    tables = {part: "\n".join(lines).strip() for part, lines in report(options, runs).items()}
    (options.output / "closure.md").write_text("\n\n".join(tables.values()) + "\n", encoding="utf-8")
    print("\n\n".join(tables.values()))
    if options.report:
        for part, text in tables.items():
            write_report(report_page(part), part, f"{stamp(Lab(PROGRAM, options.output), part)}\n\n{text}")
    print(f"CPU time of these encounters: {sum(runs.known[one]['cpu_seconds'] for one in set(cases)) / 60:.1f} minutes")


if __name__ == "__main__":
    main()
