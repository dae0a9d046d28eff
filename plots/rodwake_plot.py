"""Draw the figures of a run directory and write its report: rodwake_plot.py RUN_DIR [--pdf] [--width 86mm] [--style slides] [--film]."""

import argparse
import contextlib
import logging
import os
import sys
import warnings

from rodwake_plots.errors import PlotError, UsageError


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


class Listing:
    """Standard output as long as somebody reads it: `rodwake plot RUN | head -1` makes every figure."""

    def __init__(self, out):
        self.out = out

    def write(self, text):
        try:
            self.out.write(text)
            self.out.flush()
        except BrokenPipeError:  # what is buffered goes nowhere, now and when the interpreter ends
            os.dup2(os.open(os.devnull, os.O_WRONLY), self.out.fileno())

    def flush(self):
        """Written at once."""


def plot(options):
    # Imported here so that --help and a missing package are quick and plain.
    # Warnings about a glyph or a masked point are not the user's concern; stderr holds errors only.
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    warnings.simplefilter("ignore")
    from rodwake_plots import draw, report, scan_page, style, tradeoff, ways
    from rodwake_plots.run_dir import RunDir

    look = style.look(options.width, options.style, options.font_size)
    if ways.is_there(options.run_dir):
        print(*draw.in_style(ways.write, options.run_dir, options.output), sep="\n")
        return

    with RunDir(options.run_dir, options.output) as run:
        if run.has_tradeoff and not options.report_only:
            print(*draw.in_style(tradeoff.write, run), sep="\n")
        if run.holds_tradeoff_alone:
            return
        figures = draw.figures_of(run, options.film, options.overlay)
        failures = []
        if not options.report_only:
            figures, failures = draw.write_all(run, figures, pdf=options.pdf, look=look)
        report.write(run, figures)
        if run.has_scan:
            scan_page.write(run)
        if failures:  # told last: what could be drawn is there
            raise PlotError("; ".join(failures))


def main(argv=None):
    options = arguments(argv)
    code = 1
    try:
        with contextlib.redirect_stdout(None if options.quiet else Listing(sys.stdout)):
            plot(options)
    except UsageError as error:
        code, message = 2, str(error)
    except PlotError as error:
        message = str(error)
    except ImportError as error:
        message = f"a Python package is missing: {error}"
    except OSError as error:
        message = f"{error.filename or options.run_dir}: {error.strerror or error}"
    except Exception as error:  # a user sees one line; the traceback is for whoever asks for it
        if os.environ.get("RODWAKE_PLOT_DEBUG"):
            raise
        message = f"internal error: {type(error).__name__}: {error} (RODWAKE_PLOT_DEBUG=1 shows where)"
    else:
        return 0
    print("rodwake plot: " + " ".join(message.split()), file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
