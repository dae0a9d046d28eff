#!/usr/bin/python3
"""What the page of `rodwake explore` computes in headless Chromium beside the program; studies/reports/explorer.md has the numbers.

    studies/validate_explorer.py [--program build/release/rodwake] [--only outcomes,strain,speed,axe] [--quick] [--axe axe.min.js]

outcomes: 100 000 random starts (kappa 0.3 to 300 of both signs, half with gammas to 10, alpha 0.01 to 10, eta 0.3 to 3) against
`rodwake scan` at the same rtol; those that end otherwise, and how many of them also do so in the program at a tenth of the tolerance.
strain: 20 000 places against `rodwake field --points`. speed: first picture, frames while a rod is dragged, encounters a second, size.
axe: violations that axe-core finds, of `npm pack axe-core`, whose axe.min.js --axe names. --quick: 500 starts.
"""

import json
import math
import sys
import time
from pathlib import Path

import numpy as np

from lab import SOURCE, parser, rows, rows_of, run_parts, table

sys.path[:0] = [str(SOURCE / "tests" / "support"), str(SOURCE / "tests" / "cli")]
from page_driver import Page  # noqa: E402
from test_explore import KEYS, problem, starts  # noqa: E402

CHUNK, OUTCOMES = 2500, ("contact", "pursuit", "escape", "undecided")
SCENE = """schema = 1
[medium]
eta = 1.0
alpha = 1.0
[coupling]
kappa = 1.0
[[rods]]
position = [0.0, 2.5]
[[rods]]
position = [0.0, -2.5]
[rods_run]
t_end = 40.0
contact_distance = 0.1
rtol = {rtol}
[scan]
design = "list"
file = "{points}"
"""


def open_page(lab, width=1440, height=1000, dark=False):
    path = lab.folder / "explore.html"
    if not path.is_file():
        lab.call("explore", "-o", path, "--quiet")
    return Page(path, width, height, dark=dark, timeout=600)


def by_program(lab, name, points, rtol):
    lab.write(f"{name}.csv", "\n".join(",".join(map(repr, row)) for row in points).join((",".join(KEYS) + "\n", "\n")))
    return rows(lab.make(f"scan_{name}", SCENE.format(rtol=rtol, points=f"{name}.csv"), verbs=("scan",)) / "scan.csv")


def by_page(page, points):
    found = []
    for first in range(0, len(points), CHUNK):
        problems = json.dumps([problem(row) for row in points[first:first + CHUNK]])
        found += page.evaluate(f"""{problems}.map(one => {{
            const {{ outcome, time, min_separation, turn }} = rodwake.simulate(one);
            return [outcome, time, min_separation, ...turn];
        }})""")
    return found


def outcomes(lab):
    points = starts(500 if lab.quick else 100_000)
    program = by_program(lab, "points", points, 1e-8)
    with open_page(lab) as page:
        page.evaluate("rodwake.ready")
        found = by_page(page, points)
    differ = [k for k, (one, row) in enumerate(zip(found, program)) if one[0] != row["outcome"]]
    same = np.array([[one[1], one[3], one[4]] for k, one in enumerate(found) if k not in set(differ)])
    exact = np.array([[float(row[name]) for name in ("time", "turn0", "turn1")] for k, row in enumerate(program) if k not in set(differ)])
    error = np.max(np.abs(same - exact), axis=1)
    counts = {name: sum(one[0] == name for one in found) for name in OUTCOMES}
    print(f"{len(found)} starts: " + ", ".join(f"{count} {name}" for name, count in counts.items()))
    unsure = 0
    if differ:
        finer = by_program(lab, "differ", [points[k] for k in differ], 1e-9)
        unsure = sum(row["outcome"] != program[k]["outcome"] for row, k in zip(finer, differ))
    print(f"outcomes that differ from the program's: {len(differ)}, of which the program itself changes {unsure} at rtol 1e-9")
    print("time and turns at the end, largest difference of each: " + ", ".join(
        f"{share} {np.quantile(error, q):.1e}" for share, q in (("median", 0.5), ("90 %", 0.9), ("99 %", 0.99), ("largest", 1.0)))
        + f"; within 1e-6: {np.mean(error < 1e-6):.2%}")


def strain(lab):
    draw = np.random.default_rng(1)
    count = 500 if lab.quick else 20_000
    r, where = 10 ** draw.uniform(-4, 2, count), draw.uniform(-math.pi, math.pi, count)
    eta, alpha = 10 ** draw.uniform(-1, 2, count), 10 ** draw.uniform(-2, 1, count)
    places = np.column_stack([r * np.cos(where), r * np.sin(where), alpha, eta])
    points = "x,y,xi,eta\n" + "".join(f"{x!r},{y!r},{1 / a!r},{e!r}\n" for x, y, a, e in places.tolist())
    exact = np.array([[float(row[name]) for name in ("exx", "exy", "eyy")]
                      for row in rows_of(lab.call("field", "--points", "-", input=points).stdout)])
    with open_page(lab) as page:
        page.evaluate("rodwake.ready")
        found = np.array(page.evaluate(f"{json.dumps(places.tolist())}.map(([x, y, alpha, eta]) => rodwake.strain(x, y, {{ eta, alpha }}))"))
    size = np.linalg.norm(exact, axis=1)
    seen = size > 1e-290
    error = np.linalg.norm(found - exact, axis=1)[seen] / size[seen]
    print(f"strain at {seen.sum()} places, relative: " + ", ".join(
        f"{share} {np.quantile(error, q):.1e}" for share, q in (("median", 0.5), ("99 %", 0.99), ("largest", 1.0))))


def thread_time(page):
    """What the page's thread has had of the processor, ms."""
    return next(1e3 * one["value"] for one in page.send("Performance.getMetrics")["metrics"] if one["name"] == "ThreadTime")


def drag(page, seconds):
    """Frames a second while a pointer moves all the time, what the page's scripts take for a frame, and its thread of the processor, ms."""
    x, y = page.evaluate("""(() => {
        const box = document.querySelector("#paths-stage .handle.body.rod1").getBoundingClientRect();
        rodwake.page.frames.length = 0;
        return [box.left + 20, box.top + 20];
    })()""")
    page.pointer("mousePressed", x, y, button="left", buttons=1, clickCount=1)
    page.evaluate("window.drawn = 0; (function count() { ++drawn; requestAnimationFrame(count); })()")
    began, moved, cost = time.monotonic(), 0, thread_time(page)
    while time.monotonic() < began + seconds:
        moved += 1
        page.pointer("mouseMoved", x + 60 * math.sin(moved / 20), y + 40 * math.sin(moved / 13), button="left", buttons=1)
    cost = (thread_time(page) - cost) / page.evaluate("drawn")
    frames = page.evaluate("rodwake.page.frames")
    page.pointer("mouseReleased", x, y, button="left", buttons=0, clickCount=1)
    return 1e3 * (len(frames) - 1) / (frames[-1][0] - frames[0][0]), float(np.median([work for _, work in frames])), cost


def speed(lab):
    found = []
    for _ in range(1 if lab.quick else 5):
        with open_page(lab) as page:
            page.send("Performance.enable", timeDomain="threadTicks")
            page.go(page.path)
            page.evaluate("rodwake.ready.then(() => new Promise(done => requestAnimationFrame(done)))")
            first, start = page.evaluate("performance.now()"), thread_time(page)
            page.wait_for(lambda page=page: page.evaluate("rodwake.page.diagram.done"), "the diagram is not done", 120)
            frames, work, cost = drag(page, 1 if lab.quick else 5)
            kernel = page.evaluate("[rodwake.page.paths.milliseconds, rodwake.page.wake.milliseconds]")
            batch = page.evaluate("""(() => {
                const random = (low, high) => low + (high - low) * Math.random(), numbers = [];
                for (let k = 0; k < 4000; ++k)
                    numbers.push(...rodwake.flat({ kappa: 0.3 * 1000 ** Math.random(), t_end: 40, contact_distance: 0.1 },
                                                 [[0, 0, 0], [random(-6, 6), -5, random(-3, 3)]]));
                const began = performance.now();
                rodwake.encounters(numbers, 1e-6);
                return 4000 / (performance.now() - began) * 1e3;
            })()""")
            found.append([first, start, frames, work, cost, *kernel, batch])
    names = ("first picture, ms", "of that the page's thread, CPU ms", "frames a second while dragging", "the page's scripts a frame, ms",
             "the page's thread a frame, CPU ms", "an encounter with its path, ms", "the wake, drawn, ms", "encounters a second, rtol 1e-6")
    size = (lab.folder / "explore.html").stat().st_size
    table("Speed", ("quantity", "median", "least", "most"), [("size of the page, kB", f"{size / 1e3:.0f}", "", "")] + [
        (name, *(f"{value:.4g}" for value in (np.median(column), np.min(column), np.max(column)))) for name, column in zip(names, np.transpose(found))])


def axe(lab):
    script = lab.options.axe
    if script is None:
        print("axe: left out; npm pack axe-core, unpack it and name its axe.min.js with --axe")
        return
    for width, dark in ((360, False), (360, True), (1440, False), (1440, True)):
        with open_page(lab, width, dark=dark) as page:
            page.evaluate("rodwake.ready")
            page.evaluate("document.querySelectorAll('details').forEach(one => one.open = true)")
            page.evaluate(script.read_text() + "; 0")
            wrong, passed = page.evaluate("axe.run().then(found => [found.violations.map(one => one.id), found.passes.length])")
        print(f"axe at {width} px, {'dark' if dark else 'light'}: {len(wrong)} violations {wrong or ''}, {passed} rules pass")


PARTS = {"outcomes": outcomes, "strain": strain, "speed": speed, "axe": axe}

if __name__ == "__main__":
    options = parser(__doc__, "report", "quick", "keep", "threads", parts=PARTS)
    options.add_argument("--axe", type=Path, help="axe.min.js of the npm package axe-core")
    run_parts(options.parse_args(), PARTS)
