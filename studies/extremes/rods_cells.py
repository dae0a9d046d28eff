"""Cells of rods, by every method and form: single runs whose starts and durations have something special, and random extremes of every key.

The random ones are pairs, through `rodwake scan` and the batch too. A sheet is one medium, tolerance, duration, contact distance and
offset of the origin, with POINTS pairs in it. Each setting runs the sheet; two tight runs by different methods are the reference where
they agree.
"""

import csv
import io
import json
import math
import random

from lab import SOURCE, rows_of

from .cells import Cell, coupling, log_uniform, not_finite, random_eta

SETTINGS = {"auto": ("auto", "angle"), "bdf": ("bdf", "angle"), "adams": ("adams", "angle"), "erk": ("erk", "angle"),
            "director, bdf": ("bdf", "director"), "director, erk": ("erk", "director"), "dae": ("bdf", "dae")}
OUTCOMES = ("contact", "pursuit", "escape", "undecided")
FEW = ("auto", "bdf", "dae")
LIMIT = 180.0       # s a run, for 10^4 rods; what takes longer is bad
BOUND = 1e3         # tolerances: local errors add up over a run; studies/reports/rods.md has at most 83 for its trajectories
EPSILON = 2.0**-52


def scene(rods, t_end, *, coupling="kappa = 0.5", medium="eta = 1.0\nalpha = 1.0", outputs=4, **keys):
    """`rods`: (x, y, heading) each, or the text of [rods_random]."""
    body = rods if isinstance(rods, str) else "".join(
        f"[[rods]]\nposition = [{x!r}, {y!r}]\nheading = {heading!r}\n" for x, y, heading in rods)
    times = f"output_interval = {t_end / outputs!r}\n"
    run = "".join(f"{key} = {value}\n" for key, value in {"max_steps": 200000, **keys}.items())
    return f"schema = 1\n[medium]\n{medium}\n[coupling]\n{coupling}\n{body}[rods_run]\nt_end = {t_end!r}\n{times}{run}"


def simulated(lab, text, method, form, limit=LIMIT):
    """The process, outcome.json and the rows of rods.csv as numbers."""
    lab.write("rods.toml", text)
    done = lab.run("rods", "rods.toml", "-o", "rods", "--force", "--quiet", "-j", "1", f"-srods_run.method={method}",
                   f"-srods_run.form={form}", limit=limit)
    if done.code != 0:
        return done, None, None
    table = lab.text("rods", "rods.csv")
    outcome = lab.text("rods", "outcome.json")
    if (text := not_finite(table) or not_finite(outcome)):
        return done, {"outcome": f"not finite: {text}"}, None
    rows = [[float(value) for value in row] for row in list(csv.reader(io.StringIO(table)))[1:]]
    return done, json.loads(outcome), rows


def cell(lab, group, name, text, method, form, judge=None):
    """`judge(outcome, rows)`: error over its bound, and a note; for runs that finished."""
    done, outcome, rows = simulated(lab, text, method, form)
    if outcome is None:
        return Cell(group, name, *done.refused(), done.seconds, note=done.stderr.strip()[-200:])
    if outcome["outcome"] not in OUTCOMES:
        return Cell(group, name, outcome["outcome"], "bad", done.seconds)
    error, note = judge(outcome, rows) if judge else (None, "")
    return Cell(group, name, outcome["outcome"], "differs" if error is not None and not error <= 1.0 else "good", done.seconds, error, note)


def by_setting(lab, group, cases, only=None):
    """`cases`: (name, text, judge)."""
    for name, text, judge in cases:
        for label, (method, form) in SETTINGS.items():
            if only is None or label in only:
                yield cell(lab, f"rods: {group}", f"{name}; {label}", text, method, form, judge)


# What is known of a run.

def straight(rods):
    """Rods that turn by nothing: places and headings to the rounding of some tens of steps."""
    def judge(_, rows):
        worst = 0.0
        for t, *state in rows:
            for (x, y, heading), (gx, gy, gh) in zip(rods, zip(*[iter(state)] * 3)):
                scale = 64.0 * EPSILON * (abs(x) + abs(y) + t + 1e-300)
                worst = max(worst, math.hypot(gx - x - t * math.cos(heading), gy - y - t * math.sin(heading)) / scale,
                            abs(gh - heading) / (64.0 * EPSILON * (1.0 + abs(heading))))
        return worst, ""
    return judge


def mirrored(bits):
    """Rods 0 and 1 stay images in the x axis: to the bit, or within `bits`."""
    def judge(_, rows):
        worst = max(max(abs(x0 - x1), abs(y0 + y1), abs(h0 + h1)) for _, x0, y0, h0, x1, y1, h1 in rows)
        return (0.0 if worst == 0.0 else math.inf) if bits == 0.0 else worst / bits, f"asymmetry {worst:.1e}"
    return judge


def on_axis(_, rows):
    """Rods on the x axis stay there, heading along it, to the bit."""
    worst = max(max(map(abs, state[1::3] + state[2::3])) for _, *state in rows)
    return (0.0 if worst == 0.0 else math.inf), f"off the axis by {worst:.1e}"


def contact_at(time, bound):
    def judge(outcome, _):
        if outcome["outcome"] != ("escape" if time is None else "contact"):
            return math.inf, f"expected {'no contact' if time is None else 'contact'}"
        return (0.0 if time is None else abs(outcome["time"] - time) / bound), ""
    return judge


# Groups of cells.

def one_rod(lab):
    places = [(0.0, 0.0, 0.7), (1e9, -1e9, 2.0), (1e-8, 1e3, -3.0), (1e6, 0.0, 1e4)]
    times = [1e9] if lab.quick else [1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9]
    return by_setting(lab, "one rod", ((f"start {rod}, t_end {t!r}", scene([rod], t), straight([rod]))
                                       for rod in places[:1 if lab.quick else 4] for t in times))


def without_coupling(lab):
    """No interaction: straight lines whatever the separation."""
    pairs = [[(0.0, 0.0, 0.3), (d, 0.0, 2.0)] for d in (1e-8, 1e-4, 1.0, 1e3, 1e6)]
    return by_setting(lab, "no coupling", ((f"{pair[1][0]!r} apart, t_end {t!r}", scene(pair, t, coupling="kappa = 0.0"), straight(pair))
                                           for pair in pairs for t in (1e-9, 1.0, 1e9)))


def mirror_images(lab):
    """Side by side. ERK works on each rod alike; multistep methods solve linear systems, whose elimination has an order."""
    for kappa in (1e-6, 0.5, 10.0, 1e3, -1e-6, -0.5, -10.0, -1e3):
        for d in (0.05, 0.5, 2.5, 50.0):
            for contact in (None, 0.01):
                keys = {"contact_distance": contact} if contact else {}
                text = scene([(0.0, d, 0.0), (0.0, -d, 0.0)], 10.0, coupling=f"kappa = {kappa!r}", **keys)
                name = f"kappa {kappa!r}, {2 * d!r} apart, contact {contact}"
                yield from by_setting(lab, "mirror images", [(name, text, mirrored(0.0))], ("erk", "director, erk"))
                yield from by_setting(lab, "mirror images", [(name, text, mirrored(1e-5))], ("auto", "bdf", "adams", "director, bdf", "dae"))


def collinear(lab):
    """Rods in line, all heading along it: nothing may turn them. Then two of them head-on."""
    for count in (2,) if lab.quick else (2, 3, 10, 100):
        for gap in (1.0,) if lab.quick else (1e-6, 1.0, 1e3):
            rods, steps = [(k * gap, 0.0, 0.0) for k in range(count)], max(500, 400000 // count**2)
            text = scene(rods, 20.0, coupling="kappa = 5.0\ngamma1 = 2.0", max_steps=steps)
            only = None if count < 100 else ("auto", "erk", "director, erk") # dense matrices of 300 rows and more
            yield from by_setting(lab, "collinear", [(f"{count} rods {gap!r} apart", text, on_axis)], only)
    for contact in (0.1,) if lab.quick else (0.5, 0.1, 1e-3, 1e-6):
        rods = [(0.0, 0.0, 0.0), (3.0, 0.0, math.pi)]
        case = (f"contact {contact!r}", scene(rods, 20.0, contact_distance=contact), contact_at(1.5 - contact / 2, 1e-8))
        yield from by_setting(lab, "head-on", [case])
    yield from by_setting(lab, "head-on", [("no contact distance", scene([(0.0, 0.0, 0.0), (3.0, 0.0, math.pi)], 20.0), contact_at(-1.0, 1e-8))])


def coincident(lab):
    cases = [("to the bit", 0.0, 0.0, {}), ("with a contact distance", 0.0, 0.0, {"contact_distance": 0.1}), ("1e-300 apart", 0.0, 1e-300, {}),
             ("1e-12 apart at 1e9", 1e9, 1e-12, {})]
    for name, x, apart, keys in cases[:1 if lab.quick else None]:
        rods = [(x, 1.0, 0.3), (x + apart, 1.0, 2.0)]
        for label, (method, form) in SETTINGS.items():
            found = cell(lab, "rods: coincident", f"{name}; {label}", scene(rods, 1.0, **keys), method, form)
            if found.status != "refused":
                found.verdict, found.note = "differs", "coincident rods must be refused"
            yield found


def grazing(lab):
    """Straight lines that pass at contact_distance (1 +- 10^-k): contact from inside only, at its time."""
    cases = []
    for k in (6,) if lab.quick else range(1, 16):
        for sign in (1.0, -1.0):
            miss = 0.1 * (1.0 + sign * 10.0**-k)
            time = None if sign > 0 else 5.0 - 0.5 * math.sqrt((0.1 - miss) * (0.1 + miss))
            # the time's own sensitivity to rounding of the miss
            bound = 1e-8 if time is None else 1e-8 + 1e-15 / max(5.0 - time, 1e-12)
            cases.append((f"miss {miss!r}", scene([(0.0, 0.0, 0.0), (10.0, miss, math.pi)], 10.0, coupling="kappa = 0.0", contact_distance=0.1),
                          contact_at(time, bound)))
    return by_setting(lab, "grazing", cases)


def several_contacts(lab):
    """Pairs that meet head-on at one instant, far from each other: contact at that instant, of the first pair by number."""
    def judge(outcome, _):
        error, note = contact_at(0.95, 1e-9)(outcome, _)
        return (error, note) if outcome.get("pair") == [0, 1] else (math.inf, f"pair {outcome.get('pair')}")
    for pairs in (2, 3, 5, 50, 200):
        rods = [rod for k in range(pairs) for rod in ((0.0, 64.0 * k, 0.0), (2.0, 64.0 * k, math.pi))]
        text = scene(rods, 2.0, coupling="kappa = 0.0", contact_distance=0.1)
        yield from by_setting(lab, "several contacts", [(f"{pairs} pairs", text, judge)], None if pairs < 50 else ("auto", "erk"))


def many_turns(lab):
    """A heading of k whole turns is the heading without them, to the rounding of its argument."""
    for turns in (1, 1000, -1000, 10**4, 10**6, -10**9):
        def judge(outcome, rows, whole=2.0 * math.pi * turns):
            want = -0.26565655766 if outcome["outcome"] == "contact" else None # of turns = 0, studies/reports/rods.md
            if want is None:
                return math.inf, "expected contact"
            scale = BOUND * 1e-8 + 64.0 * abs(whole) * EPSILON * 50.0
            return abs(rows[-1][3] - whole - want) / scale, ""
        rods = [(0.0, 2.5, 2.0 * math.pi * turns), (0.0, -2.5, -2.0 * math.pi * turns)]
        yield from by_setting(lab, "many turns", [(f"{turns} turns", scene(rods, 60.0, contact_distance=0.1), judge)])


def durations(lab):
    for decade in range(-9, 10):
        rods = [(0.0, 2.5, 0.0), (0.0, -2.5, 0.0)]
        yield from by_setting(lab, "durations", [(f"t_end 1e{decade}", scene(rods, 10.0**decade, coupling="kappa = -0.5"), mirrored(1e-5))])


def references(lab):
    """tests/data/rod_trajectories.json, 20 digits, at every tolerance."""
    cases = json.loads((SOURCE / "tests" / "data" / "rod_trajectories.json").read_text())["cases"]
    for number, case in enumerate(cases[2:3] if lab.quick else cases):
        for exponent in (3, 11) if lab.quick else (2, 4, 6, 8, 10, 12, 13):
            yield from reference_cells(lab, case, 10.0**-exponent)


def reference_cells(lab, case, rtol):
    initial = [float(value) for value in case["initial"]]
    contact = case.get("contact_distance")
    last = float(case["output"][-1]["time"]) # of contact, if there is one
    t_end = 1.1 * last if contact else last
    keys = {"rtol": rtol} | ({"contact_distance": float(contact)} if contact else {})
    text = scene(list(zip(*[iter(initial)] * 3)), t_end, outputs=1, medium=f"eta = {float(case['eta'])!r}\nalpha = {float(case['alpha'])!r}",
                 coupling="".join(f"{key} = {float(case[key])!r}\n" for key in ("kappa", "gamma1", "gamma2")), **keys)

    def judge(outcome, rows):
        if contact:
            error = abs(outcome["time"] - last) if outcome["outcome"] == "contact" else math.inf
        else:
            error = max(abs(a - float(b)) for a, b in zip(rows[-1][1:], case["output"][-1]["state"]))
        floor = 64.0 * EPSILON * (1.0 + t_end)
        return error / (BOUND * max(rtol, floor)), f"error {error:.1e}"
    yield from by_setting(lab, "references", [(f"{case['name']}, rtol {rtol:.0e}", text, judge)])


def crowds(lab):
    """1 to 10^4 rods, forms and precisions."""
    for count, t_end, only in ((1, 1.0, None), (10, 1.0, None), (100, 1.0, ("auto", "erk", "director, erk")), (1000, 0.01, ("auto", "director, erk")),
                               (10000, 1e-4, ("auto",))):
        rods = f"[rods_random]\ncount = {count}\nextent = {4.0 * math.sqrt(count)!r}\nmin_separation = 0.2\n"
        for precision in ("full", "fine", "single"):
            text = scene(rods, t_end, precision=f'"{precision}"', rtol=1e-4)
            yield from by_setting(lab, f"{count} rods", [(precision, text, None)], only)


def fields(lab):
    """A pair in a box and in a table of the field, in ordinary and extreme media."""
    rods = [(0.0, 2.5, 0.0), (0.3, -2.5, 0.5)]
    for eta in (1e-6, 1e-3, 1.0, 1e3, 1e6, -0.5, -0.999999):
        for alpha in (1e-4, 1.0, 1e4):
            medium = f"eta = {eta!r}\nalpha = {alpha!r}"
            for box in (6.0, 20.0, 1e4):
                text = scene(rods, 1.0, medium=medium + f"\nperiodic = {box!r}", rtol=1e-6)
                yield from by_setting(lab, "in a box", [(f"eta {eta!r}, alpha {alpha!r}, box {box!r}", text, None)], FEW)
            text = scene(rods, 1.0, medium=medium + '\nfield = "table"\ntable.tolerance = 1e-4', rtol=1e-6)
            yield from by_setting(lab, "table", [(f"eta {eta!r}, alpha {alpha!r}", text, None)], FEW)


GROUPS = {"one rod": one_rod, "no coupling": without_coupling, "mirror images": mirror_images, "collinear": collinear,
          "coincident": coincident, "grazing": grazing, "several contacts": several_contacts, "many turns": many_turns,
          "durations": durations, "references": references, "crowds": crowds, "fields": fields}
QUICK = ("one rod", "collinear", "coincident", "grazing", "references")


def run_starts(lab):
    for name, make in GROUPS.items():
        if lab.quick and name not in QUICK:
            continue
        lab.batch(f"rods: {name}", lambda: make(lab))


# Random pairs, in sheets.

POINTS = 20
POINT_LIMIT = 0.12    # s a point: scan.time_limit; above what a pair of a batch may take, or there would be no batch
KEYS = ("coupling.kappa", "coupling.gamma1", "coupling.gamma2", "rods.1.position.0", "rods.1.position.1", "rods.1.heading")
SHEET_SETTINGS = {"batch" if name == "auto" else name: how for name, how in SETTINGS.items()}
REFERENCES = (("erk", "angle"), ("bdf", "angle"))
STATUSES = ("failed", "time_limit", "exception")
# Tolerances within which times and separations of a good cell agree with the reference: local errors add up along a run.
# studies/reports/rods.md, "Trajectories": at most 83 on the reference trajectories.
PAIR_BOUND = 100.0

SCENE = """schema = 1
[medium]
eta = 1.0
alpha = 1.0
[coupling]
kappa = 1.0
gamma1 = 1.0
gamma2 = 1.0
[[rods]]
position = [0.0, 0.0]
heading = 0.5
[[rods]]
position = [0.0, -4.0]
[rods_run]
t_end = 1.0
max_steps = 100000
[scan]
design = "list"
file = "points.csv"
trajectories = 0
"""


class Sheet:
    def __init__(self, random_, moderate):
        """`moderate`: rates and times for which a solver has a chance to follow every turn."""
        self.origin = random_.choice((0.0, 0.0, 1.0, 1e3, 1e6, 1e9))
        self.eta, self.alpha = random_eta(random_), log_uniform(random_, 1e-4, 1e4)
        self.rtol = log_uniform(random_, 1e-12, 1e-3) if moderate else log_uniform(random_, 1e-13, 1e-2)
        self.t_end = log_uniform(random_, 0.1, 100.0) if moderate else log_uniform(random_, 1e-9, 1e9)
        self.contact = random_.choice((None, 1e-9, 1e-3, 0.1))
        self.rows = [self.pair(random_, moderate) for _ in range(POINTS)]

    def pair(self, random_, moderate):
        distance = log_uniform(random_, 0.2, 20.0) if moderate else log_uniform(random_, 1e-8, 1e6)
        angle = random_.uniform(-math.pi, math.pi)
        turning = [random_.uniform(-3.0, 3.0) for _ in range(3)] if moderate else [coupling(random_) for _ in range(3)]
        return (*turning, self.origin + distance * math.cos(angle), self.origin + distance * math.sin(angle), random_.uniform(-4.0, 4.0))

    def settings(self, method, form, rtol):
        keys = {"medium.eta": self.eta, "medium.alpha": self.alpha, "rods_run.rtol": rtol, "rods_run.t_end": self.t_end,
                "rods.0.position.0": self.origin, "rods.0.position.1": self.origin, "rods_run.method": method, "rods_run.form": form,
                "scan.time_limit": POINT_LIMIT}
        if self.contact:
            keys["rods_run.contact_distance"] = self.contact
        return [f"-s{key}={value!r}" if isinstance(value, float) else f"-s{key}={value}" for key, value in keys.items()]

    def __str__(self):
        return (f"eta={self.eta!r} alpha={self.alpha!r} rtol={self.rtol!r} t_end={self.t_end!r} contact={self.contact} "
                f"origin={self.origin!r}")


def scanned(lab, sheet, method, form, rtol):
    """The process and its rows, none if it was refused."""
    lab.write("sheet.toml", SCENE)
    lab.write("points.csv", ",".join(KEYS) + "\n" + "".join(",".join(map(repr, row)) + "\n" for row in sheet.rows))
    done = lab.run("scan", "sheet.toml", "-o", "sheet", "--force", "--quiet", "-j", "1", *sheet.settings(method, form, rtol),
                   limit=POINTS * 4 * POINT_LIMIT + 10.0)
    return done, rows_of(lab.text("sheet", "scan.csv")) if done.code in (0, 3) else []


def named(row):
    """Status and verdict of a row."""
    if not_finite(",".join(row.values())):
        return "not finite", "bad"
    if row["status"] == "ok":
        return (row["outcome"], "good") if row["outcome"] in OUTCOMES else (f"unnamed outcome: {row['outcome']}", "bad")
    return (row["status"], "reported") if row["status"] in STATUSES else (f"unnamed status: {row['status']}", "bad")


def numbers(row):
    return [float(row[name]) for name in ("time", "final_separation", "min_separation")]


def difference(row, other):
    """Of two finished rows, over the size of what differs, at least 1: coordinates have no origin."""
    if row["outcome"] != other["outcome"]:
        return math.inf
    return max(abs(a - b) / max(1.0, abs(b)) for a, b in zip(numbers(row), numbers(other)))


def floor_of(sheet):
    """What rounding of coordinates leaves, over a few steps."""
    return 64.0 * 2.0**-52 * max(1.0, abs(sheet.origin) + min(sheet.t_end, 1e9))


def reference_rows(lab, sheet):
    """Tight runs by two methods; None where they are not both finished and alike to a tenth of the tolerance."""
    tight = max(1e-3 * sheet.rtol, 1e-13)
    runs = [scanned(lab, sheet, method, form, tight)[1] for method, form in REFERENCES]
    if not all(runs):
        return [None] * POINTS
    near = 0.1 * max(sheet.rtol, floor_of(sheet))
    return [one if one["status"] == other["status"] == "ok" and difference(one, other) <= near else None for one, other in zip(*runs)]


def cells_of(lab, group, sheet):
    wanted = reference_rows(lab, sheet)
    for name, (method, form) in SHEET_SETTINGS.items():
        done, rows = scanned(lab, sheet, method, form, sheet.rtol)
        if len(rows) != POINTS:
            status, verdict = done.refused() if done.code not in (0, 3) else ("unnamed: rows missing", "bad")
            yield from (Cell(f"{group}: {name}", str(sheet), status, verdict, done.seconds) for _ in range(POINTS))
            continue
        for row, pair, want in zip(rows, sheet.rows, wanted):
            status, verdict = named(row)
            error = None
            if verdict == "good" and want:
                error = difference(row, want) / max(sheet.rtol, floor_of(sheet))
                verdict = "good" if error <= PAIR_BOUND else "differs"
            where = " ".join(f"{key}={value!r}" for key, value in zip(KEYS, pair))
            yield Cell(f"{group}: {name}", f"{sheet} {where}", status, verdict, done.seconds / POINTS, error,
                       f"reference: {want['outcome']}" if verdict == "differs" else "")


def run_pairs(lab):
    for group, moderate, count in (("pairs, extremes", False, 1 if lab.quick else 30), ("pairs, moderate", True, 1 if lab.quick else 30)):
        for number in range(count):
            random_ = random.Random(f"{group} {lab.seed} {number}")
            sheet = Sheet(random_, moderate)
            lab.batch(f"{group} {number}", lambda: cells_of(lab, group, sheet))
