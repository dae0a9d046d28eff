"""How a rod of the bed forgets its heading: mean-square change and mean cosine against the lag, with the fits that give D_r."""

import numpy as np

from . import canvas, curves, measured, style, words
from .errors import PlotError
from .spec import Spec

FILE, TABLE = "heading.csv", "heading_diffusion"
COLUMNS = ("lag", "square", "square_error", "cosine", "cosine_error")
FITTED, BEYOND = "-", (0, (5, 3))


def draw(run, spec):
    parts = measured.holders(run, FILE)
    figure = canvas.figure(style.WIDE, 3.0)
    square, cosine = figure.subplots(1, 2)
    for part, colour in zip(parts, curves.colours(len(parts))):
        draw_part(part, square, cosine, colour, style.safe(part.label) if len(parts) > 1 else None)
    square.set(xlabel=r"lag $\tau$ (s)", ylabel=r"$\langle\Delta\theta^2\rangle$ (rad$^2$)", xscale="log", yscale="log")
    cosine.set(xlabel=r"lag $\tau$ (s)", ylabel=r"$\langle\cos\Delta\theta\rangle$", xlim=(0, None))
    if len(parts) > 1:
        curves.legend(square, fontsize=7.5, loc="upper left", bbox_to_anchor=None)
    for k, axes in enumerate((square, cosine)):
        canvas.letter(axes, k)
    figure.suptitle(style.safe(spec.title), fontsize=10.5)
    return figure


def draw_part(part, square, cosine, colour, label):
    table = read(part)
    curves.points(square, table["lag"], table["square"], table["square_error"], colour, label)
    curves.points(cosine, table["lag"], table["cosine"], table["cosine_error"], colour)
    low, high = (part.number(TABLE, key) for key in ("lag_low", "lag_high"))
    for lag, look in ((np.linspace(low, high, 50), FITTED), (np.linspace(table["lag"][0], low, 30), BEYOND)):
        draw_fits(part, table, (square, cosine), lag, dict(color=colour, linewidth=0.9, linestyle=look))


def at_zero(part, table, D):
    """Where the fitted line, of weights 1/lag^2, has lag 0: below 0 for a rod that turns steadily."""
    lag = table["lag"]
    fitted = (lag >= 0.999 * part.number(TABLE, "lag_low")) & np.isfinite(table["square"])
    return np.average((table["square"] - 2 * D * lag)[fitted], weights=1 / lag[fitted] ** 2)


def draw_fits(part, table, panels, lag, look):
    """Both fits over these lags."""
    square, cosine = panels
    D, D_cosine = (part.estimate(TABLE, key) for key in ("D_r", "D_r_cosine"))
    if D is not None:
        line = at_zero(part, table, D.value) + 2 * D.value * lag
        square.plot(lag, np.where(line > 0, line, np.nan), **look)
    if D_cosine is not None:
        cosine.plot(lag, part.number(TABLE, "cosine_amplitude") * np.exp(-D_cosine.value * lag), **look)


def read(part):
    table = dict(zip(COLUMNS, part.table(FILE, *COLUMNS)))
    if not (table["square"] > 0).any():
        raise PlotError(f"{part.folder / FILE}: the rod never turns: nothing to draw")
    return table | {name: measured.known(table[name]) for name in ("square_error", "cosine_error")}


def caption(run, _):
    def told(part):
        D = part.estimate(TABLE, "D_r")
        reduced = part.estimate(TABLE, "rotational_diffusion")
        return "" if D is None else (f"<i>D</i><sub>r</sub> = {words.with_error(D.value, D.error)} rad²/s"
                                     + (f", in the theory's units {words.with_error(reduced.value, reduced.error)}" if reduced else ""))

    parts = measured.holders(run, FILE)
    numbers = "; ".join(f"{words.label_html(part.label) + ': ' if part.label else ''}{told(part)}" for part in parts if told(part))
    return ("Mean-square change of a rod's heading and mean cosine of it against the lag <i>τ</i>; solid lines: straight line and exponential "
            "over the lags that are fitted; dashed: towards shorter lags, where the rod rattles; bars: standard error"
            f"{'. ' + numbers if numbers else ''}.{measured.not_measured(run, FILE)}")


def defaults(run):
    return [Spec("heading_diffusion", "heading_diffusion")] if measured.some(run, FILE) else []
