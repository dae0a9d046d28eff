"""Tables of docs/validation_medium.md on the quasi-static closure, of the rows that studies/validate_closure.py makes."""

import numpy as np

CLOSURES = ("steady", "first_order")


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
    body = [[text for _, text in left] + [cells.get(column, "") for column in columns] for left, cells in lines.items()]
    return ["", "| " + " | ".join(titles) + " |", "|---" * len(titles) + "|"] + ["| " + " | ".join(line) + " |" for line in body]


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
    lines = ["", "| largest theta' alpha r^2/4 | encounters | same ending: steady | first order | time of contact off, median (largest): steady | "
             "heading off: steady | first order | first order nearer |", "|---|---|---|---|---|---|---|---|"]
    for low, high in zip(BINS, BINS[1:]):
        here = [row for row in rows if low <= row["memory_number"] < high]
        if not here:
            continue
        same = [sum(same_ending(row, how) for row in here) for how in CLOSURES]
        times = np.array([100 * abs(row["steady_time_error"]) for row in here if np.isfinite(row["steady_time_error"])])
        late = f"{np.median(times):.3g} % ({times.max():.3g} %)" if len(times) else "no contacts"
        off = [np.array([row[f"{how}_heading"] for row in here]) for how in CLOSURES]
        lines.append(f"| {low:g} to {high:g} | {len(here)} | {same[0]} | {same[1]} | {late} | " +
                     " | ".join(heading_words(one) for one in off) + f" | {(off[1] < off[0]).sum()} |")
    return lines


def heading_words(off):
    off = off[np.isfinite(off)]
    return f"{np.median(off):.2g} ({off.max():.2g})" if len(off) else "none"


def circle_table(rows):
    rates = sorted({row["turning_rate"] for row in rows})
    lines = ["", "| alpha | distance | time of memory | " + " | ".join(f"theta' = {rate:g}" for rate in rates) + " |",
             "|---" * (len(rates) + 3) + "|"]
    for alpha, r in sorted({(row["alpha"], row["distance"]) for row in rows}):
        here = sorted((row for row in rows if (row["alpha"], row["distance"]) == (alpha, r)), key=lambda row: row["turning_rate"])
        lines.append(f"| {alpha:g} | {r:g} | {here[0]['memory_time']:.2g} | " +
                     " | ".join(f"{row['steady']:.2g}, {row['first_order']:.2g}" for row in here) + " |")
    return lines
