"""What the tests of the figures of a scan share: made-up folders, and looking at colours at places of the axes."""

import json
import shutil

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb

import made_up_scan as made_up
from plot_case import PlotCase
from rodwake_plots import draw, run_dir, scan_columns
from rodwake_plots.style import SETTINGS, applied

NEAR = 6 / 255  # of a colour: rounding to bytes twice, and of pictures that were made smaller


def figure(kind="phase_diagram", name="fig", **keys):
    return f'[[figures]]\nname = "{name}"\nkind = "{kind}"\n' + "".join(f"{key} = {json.dumps(value)}\n" for key, value in keys.items())


class ScanCase(PlotCase):
    KEYS = {}

    def build(self, **keys):
        shutil.rmtree(self.folder)
        self.points, self.codes = made_up.write_scan(self.folder, **(self.KEYS | keys))

    def ask(self, *figures):
        """Another scene over the same files."""
        path = self.folder / "scene.toml"
        path.write_text(path.read_text().split("[[figures]]")[0] + "".join(figures))
        shutil.rmtree(self.folder / "figures", ignore_errors=True)

    def draw(self, kind="phase_diagram", **keys):
        """The matplotlib figure, drawn, and the caption."""
        self.ask(figure(kind, **keys))
        with run_dir.RunDir(self.folder) as run, applied(SETTINGS):
            spec = draw.figures_of(run)[0]
            made = draw.KINDS[kind].draw(run, spec)
            canvas = FigureCanvasAgg(made)
            canvas.draw()
            self.pixels = np.asarray(canvas.buffer_rgba())[..., :3] / 255
            return made, draw.caption(run, spec)

    def rewrite(self, name, change):
        path = self.folder / name
        path.write_text(change(path.read_text()))

    def retell(self, **changes):
        """Other values in scan.json."""
        self.rewrite("scan.json", lambda text: json.dumps(json.loads(text) | changes))

    def colour_at(self, axes, x, y):
        """Of the pixel at a place in data coordinates."""
        column, row = axes.transData.transform((x, y))
        return self.pixels[self.pixels.shape[0] - 1 - int(row), int(column)]

    def assert_colour(self, axes, x, y, colour):
        found = self.colour_at(axes, x, y)
        self.assertLess(np.abs(found - to_rgb(colour)).max(), NEAR, f"at ({x}, {y}): {found}, not {colour}")

    def assert_outcome(self, axes, x, y, name):
        self.assert_colour(axes, x, y, scan_columns.COLOURS[name])


def texts(legend):
    return [text.get_text() for text in legend.get_texts()]
