"""Tests of what the command line asks of all figures: width, style, film: /usr/bin/python3 tests/plots/test_command.py"""

import contextlib
import os
import re
import subprocess
import sys
import tomllib
from html import unescape
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest import TestCase, main, mock

import matplotlib
from matplotlib.text import Text
from PIL import Image

from made_up_result import LINE, PATHS
from test_theory import PlotsTest as Theory
from plot_case import PROGRAM, PlotCase
from rodwake_plots import draw, run_dir, style
from rodwake_plots.errors import PlotError


class CommandTest(PlotCase):
    build = Theory.build

    def drawn(self, *options, figures=LINE + PATHS):
        self.build(figures=figures)
        done = self.plot(*options)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return {path.stem: Image.open(path) for path in (self.folder / "figures").glob("*.png")}

    def test_every_figure_is_as_wide_as_a_column(self):
        for name, image in self.drawn("--width", "column").items():
            dots = image.info["dpi"][0]
            self.assertAlmostEqual(image.width / dots * 25.4, 86.0, delta=0.6, msg=name)  # 0.2 % of the search, and a dot at each edge
            self.assertAlmostEqual(dots, 300, delta=0.1)

    def test_lengths(self):
        for text, inches in (("page", 178 / 25.4), ("86mm", 86 / 25.4), ("8.6 cm", 86 / 25.4), ("3.4in", 3.4)):
            self.assertAlmostEqual(style.width_of(text), inches)
        for text in ("wide", "86", "-3in", "0.1in", "1.2.3mm", "99in"):
            with self.assertRaisesRegex(PlotError, "--width"):
                style.width_of(text)

    def test_styles(self):
        self.assertEqual(style.look("", "slides").settings["font.size"], 13)
        self.assertEqual(style.look().settings, style.SETTINGS)
        file = self.folder / "own.mplstyle"
        file.write_text("lines.linewidth: 4.5  # thick\n")
        self.assertEqual(style.look("column", str(file)).settings["lines.linewidth"], 4.5)
        file.write_text("# own\nlines.width: 4\n")
        for wrong, expected in ((str(file), "own.mplstyle:2: matplotlib has no setting lines.width"), ("fancy", "neither paper, slides nor a file")):
            done = self.plot("--style", wrong)
            self.assertEqual(done.returncode, 2)
            self.assertIn(expected, done.stderr)

    def test_text_as_high_as_asked_for(self):
        self.build(figures=PATHS)
        with run_dir.RunDir(self.folder) as run:
            sizes = []
            for look in (style.look(), style.look(font_size="18"), style.look("column", font_size="9")):
                made = draw.in_style(lambda look=look: draw.dressed(draw.KINDS["trajectories"].draw(run, draw.figures_of(run)[0]), look), look=look)
                made.axes[0].set_xticks(range(7))  # ticks that come later
                made.draw_without_rendering()
                sizes.append(sorted({round(text.get_fontsize(), 9) for text in made.findobj(Text) if text.get_text()}))
        self.assertEqual(style.look().settings["xtick.labelsize"], 9)
        self.assertEqual(sizes[1], [2 * size for size in sizes[0]])
        self.assertIn(9, sizes[2])
        for wrong in ("0", "tall", "99"):
            with self.assertRaisesRegex(PlotError, "--font-size"):
                style.look(font_size=wrong)

    def test_the_figure_itself_has_the_width(self):
        """Whoever saves it, as Python's users do: nothing hangs over its edges."""
        self.build(figures=LINE + PATHS)
        with run_dir.RunDir(self.folder) as run:
            for wanted in ("column", "86.4mm", "4in", ""):
                look = style.look(wanted)
                for spec in draw.figures_of(run):
                    made = draw.in_style(lambda: draw.dressed(draw.KINDS[spec.kind].draw(run, spec), look), look=look)
                    if wanted:
                        self.assertAlmostEqual(made.get_figwidth(), style.width_of(wanted), places=6)
                    made.draw_without_rendering()
                    box = made.get_tightbbox()
                    self.assertTrue(box.x0 > -0.02 and box.y0 > -0.02 and box.x1 < made.get_figwidth() + 0.02 and box.y1 < made.get_figheight() + 0.02,
                                    (spec.name, box))

    def test_a_users_matplotlibrc_does_not_count(self):
        self.build(figures=LINE)
        self.assertEqual(self.plot().returncode, 0)
        before = (self.folder / "figures/line.png").read_bytes()
        with TemporaryDirectory() as place:
            (Path(place) / "matplotlibrc").write_text("figure.autolayout: True\ntext.usetex: True\nimage.cmap: gray\nbackend: none_such\n"
                                                      "axes.grid: True\nlines.linestyle: --\nsavefig.bbox: tight\n")
            done = subprocess.run([sys.executable, str(PROGRAM), str(self.folder)], capture_output=True, text=True,
                                  env=os.environ | {"MATPLOTLIBRC": place, "MPLBACKEND": "module://none_such"})
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertEqual((self.folder / "figures/line.png").read_bytes(), before)
            done = subprocess.run([sys.executable, str(PROGRAM), str(self.folder)], capture_output=True, text=True, env=os.environ | {"MPLBACKEND": "nonsense"})
            self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_all_of_a_style_file_counts(self):
        file = self.folder / "own.mplstyle"
        file.write_text("axes.prop_cycle: cycler('color', ['ff0000', '00ff00'])\nimage.cmap: magma\nfont.size: 20\naxes.labelsize: 30\n")
        look = style.look("", str(file))
        with style.applied(look.settings):
            self.assertEqual((style.LINE, style.CURVES, style.FIELD_MAP.name), ("#ff0000", ["#ff0000", "#00ff00"] * 2, "magma"))
        self.assertEqual((style.LINE, style.FIELD_MAP.name), (matplotlib.rcParams["axes.prop_cycle"].by_key()["color"][0], "viridis_part"))
        self.build(figures=LINE)
        with run_dir.RunDir(self.folder) as run:
            axes = draw.in_style(lambda: draw.dressed(draw.KINDS["cut"].draw(run, draw.figures_of(run)[0]), look), look=look).axes[0]
        self.assertAlmostEqual(axes.xaxis.label.get_fontsize(), 30)
        self.assertAlmostEqual(axes.get_xticklabels()[0].get_fontsize(), 18)  # 9 of 10 points, as without the file
        self.assertIn("#ff0000", [line.get_color() for line in axes.lines])

    def test_figures_elsewhere(self):
        self.build(figures=LINE)
        before = {path: path.read_bytes() for path in self.folder.rglob("*") if path.is_file()}
        with TemporaryDirectory() as place:
            out = Path(place) / "deep" / "figures of it"
            done = self.plot("--output", str(out))
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertEqual(sorted(path.name for path in out.rglob("*.*")), ["line.png", "report.html"])
            links = re.findall(r'href="([^"#]+)"', (out / "report.html").read_text())
            self.assertTrue(links and all((out / unescape(link)).is_file() for link in links), links)
        self.assertEqual({path: path.read_bytes() for path in self.folder.rglob("*") if path.is_file()}, before)

    def test_a_film_on_request_stays_in_the_report(self):
        with mock.patch("shutil.which", return_value=None):
            self.drawn("--film", figures=LINE)
        self.assertTrue((self.folder / "figures/film.gif").is_file())
        with contextlib.suppress(FileNotFoundError):
            (self.folder / "report.html").unlink()
        self.assertEqual(self.plot("--report-only").returncode, 0)
        self.assertIn("data:image/gif;base64,", (self.folder / "report.html").read_text())

    def test_nothing_to_film(self):
        self.build(figures=LINE)
        self.edit(lambda file: file.pop("rods"))
        (self.folder / "outcome.json").unlink()
        done = self.plot("--film")
        self.assertEqual(done.returncode, 1)
        self.assertIn("neither frames of beads", done.stderr)

    edit = Theory.edit


class DocsImagesTest(TestCase):
    """tools/docs_images knows every picture of the docs, and the figure that its scene names."""

    def test_every_picture(self):
        root = PROGRAM.parents[1]
        loader = SourceFileLoader("docs_images", str(root / "tools/docs_images"))
        tool = module_from_spec(spec_from_loader("docs_images", loader))
        with mock.patch("sys.dont_write_bytecode", True):
            loader.exec_module(tool)
        self.assertLessEqual(set(tool.PICTURES), {path.stem for path in (root / "docs/images").glob("*.png")})
        for name, one in tool.PICTURES.items():
            scene = tomllib.loads((root / one.scene).read_text())
            if one.verb == "run":
                self.assertLessEqual(set(one.figure.split()), {figure["name"] for figure in scene["figures"]}, name)
        with TemporaryDirectory() as folder:
            picture = Path(folder) / "wide.png"
            Image.new("RGB", (2200, 1000), "red").save(picture)
            with contextlib.redirect_stdout(None):
                tool.store([picture], picture)
                self.assertEqual(Image.open(picture).size, (1100, 500))
                Image.new("RGB", (300, 250), "blue").save(small := Path(folder) / "small.png")
                tool.store([picture, small], picture)  # both as high as the lower one: 550 and 300 wide
            self.assertEqual(Image.open(picture).size, (850, 250))


del Theory  # its tests run in their own file

if __name__ == "__main__":
    main()
