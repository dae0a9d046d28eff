"""What the tests of the figures of a fit share."""

import json
import re
import shutil

import numpy as np

from made_up_fit import SCENE, write_fit
from plot_case import PlotCase
from rodwake_plots import draw, run_dir, style


def figure(kind, name="fig", **keys):
    return f'[[figures]]\nname = "{name}"\nkind = "{kind}"\n' + "".join(f"{key} = {json.dumps(value)}\n" for key, value in keys.items())


class FitCase(PlotCase):
    KEYS = {}

    def build(self, **keys):
        shutil.rmtree(self.folder)
        self.record = write_fit(self.folder, **(self.KEYS | keys))

    def rewrite(self, **changes):
        (self.folder / "fit.json").write_text(json.dumps(self.record | changes))

    def ask(self, *figures, scene=SCENE):
        (self.folder / "scene.toml").write_text(scene + "".join(figures))
        shutil.rmtree(self.folder / "figures", ignore_errors=True)

    def draw(self, kind, **keys):
        """The matplotlib figure and the caption."""
        self.ask(figure(kind, **keys))
        with run_dir.RunDir(self.folder) as run, style.applied(style.SETTINGS):
            spec = draw.figures_of(run)[0]
            return draw.KINDS[kind].draw(run, spec), draw.caption(run, spec)

    def fails(self, *found, **figure_keys):
        """Asks for the figure and looks for these words in the one line of the error."""
        self.ask(figure(**figure_keys))
        self.assert_fails(*found)

    def page(self):
        done = self.plot()
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return (self.folder / "report.html").read_text()

    def words_of_page(self):
        return re.sub("<[^>]*>", "", self.page())

    def table(self, name):
        path = self.folder / name
        return dict(zip(path.read_text().splitlines()[0].split(","), np.genfromtxt(path, delimiter=",", skip_header=1).T))
