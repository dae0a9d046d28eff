"""Draw the figures of a run directory and write its report: rodwake_plot.py RUN_DIR [--pdf] [--width 86mm] [--style slides] [--film]."""

import sys

from rodwake_plots import errors

if __name__ == "__main__":  # before the imports that take time
    errors.fill_closed_descriptors()
    errors.take_signals()

import argparse  # noqa: E402
import contextlib  # noqa: E402
import os  # noqa: E402
import logging  # noqa: E402
import warnings  # noqa: E402
from pathlib import Path  # noqa: E402


def arguments(argv):
    parser = argparse.ArgumentParser(prog="rodwake_plot.py", description="Figures and report of a finished run.")
    parser.add_argument("run_dir", help="directory that holds result.h5 and scene.toml")
    parser.add_argument("--output", default="", metavar="DIR", help="folder for figures and report; the run directory stays as it is")
    parser.add_argument("--pdf", action="store_true", help="write each figure as PDF too")
    parser.add_argument("--width", default="", metavar="W", help="width of figures: column, page, or a length such as 86mm; figures of several panels take two columns")
    parser.add_argument("--style", default="", metavar="S", help="paper (the default), slides, or a matplotlib style file")
    parser.add_argument("--font-size", default="", metavar="PT", help="of axis numbers and legends in points; other text in proportion")
    parser.add_argument("--overlay", action="store_true", help="paths of all variants in one panel, with a legend")
    parser.add_argument("--film", action="store_true", help="film of the beads, or of the rods, too")
    parser.add_argument("--quiet", action="store_true", help="do not list the files written")
    parser.add_argument("--report-only", action="store_true", help="keep the figures, write report.html again")
    return parser.parse_args(argv)


def plot(options):
    # Imported here so that --help and a missing package are quick and plain.
    os.environ.pop("MPLBACKEND", None)  # figures are drawn without one, and matplotlib refuses to start with one it does not know
    # Warnings about a glyph or a masked point are not the user's concern; stderr holds errors only.
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    warnings.simplefilter("ignore")
    from rodwake_plots import style

    look = style.look(options.width, options.style, options.font_size)
    with style.applied(look.settings):
        draw_folder(options, look)


def draw_folder(options, look):
    """All that the folder holds, in the style that is applied."""
    from rodwake_plots import design, tradeoff
    from rodwake_plots.run_dir import RunDir

    if tradeoff.has_ways(options.run_dir):
        print(*tradeoff.write_ways(options.run_dir, options.output), sep="\n")
        return

    commands = [part for part, is_there in ((tradeoff, tradeoff.has_rods), (design, design.has_design)) if is_there(options.run_dir)]
    for part in commands:
        print(*part.write(options.run_dir, options.output), sep="\n")
    if commands and not (Path(options.run_dir) / "scene.toml").is_file():  # of commands that do no run
        return

    with RunDir(options.run_dir, options.output) as run:
        draw_all(run, options, look)


def draw_all(run, options, look):
    """Draws the figures, then the pages. Failures are reported last, when everything else is drawn."""
    from rodwake_plots import draw, report, scan_page

    figures = draw.figures_of(run, options.film, options.overlay)
    shown = [(figure, "") for figure in figures] if options.report_only else draw.write_all(run, figures, options.pdf, look)
    failures = [f'figure "{figure.name}": {why}' for figure, why in shown if why]
    for page in [(report.write, run, shown)] + [(scan_page.write, run)] * run.has_scan:
        found, error = errors.attempt(*page)
        failures += [errors.reason(error)] if error else found or []
    if failures:
        raise errors.PlotError("; ".join(failures))


def main(argv=None):
    errors.forget_said()
    with contextlib.redirect_stderr(errors.Stream(sys.stderr)), contextlib.redirect_stdout(errors.Stream(sys.stdout)):
        options = arguments(argv)
        with contextlib.redirect_stdout(None if options.quiet else sys.stdout):
            _, error = errors.attempt(plot, options)
        if error is None:
            return 0
        errors.say(errors.reason(error))
        return 2 if isinstance(error, errors.UsageError) else 1


if __name__ == "__main__":
    sys.exit(main())
