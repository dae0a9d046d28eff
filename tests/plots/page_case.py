"""What the tests of scan.html share: made-up scans, the page in a browser, looking at its pixels."""

import csv
import shutil

import h5py
import numpy as np

import made_up_scan as made_up
from page_driver import Page
from plot_case import PlotCase  # first: puts the plots on the path
from rodwake_plots import run_dir, scan_columns, scan_page

WIDE, NARROW = 1200, 400


class PageCase(PlotCase):
    KEYS = {}

    def build(self, **keys):
        shutil.rmtree(self.folder)
        self.points, self.codes = made_up.write_scan(self.folder, **(self.KEYS | keys))
        self.write_page()

    def write_page(self):
        with run_dir.RunDir(self.folder) as run:
            self.path = self.folder / "scan.html"
            self.path.write_text(scan_page.document(run))

    def open(self, width=WIDE, **how):
        page = self.enterContext(Page(self.path, width, **how))
        page.evaluate("scanPage.ready")
        return page

    def table(self):
        return list(csv.DictReader((self.folder / "scan.csv").read_text().splitlines()))

    def row_near(self, kappa, x, where=True):
        """The row of scan.csv nearest to a place, as the diagram shows it."""
        away = np.hypot((np.log10(self.points[:, 0]) - np.log10(kappa)) / 3, (self.points[:, 1] - x) / 12)
        return int(np.where(where, away, np.inf).argmin())

    def place(self, page, row):
        return page.evaluate(f"scanPage.pointAt({row})")

    def assert_clean(self, page):
        """No error, and nothing fetched but the page itself."""
        self.assertEqual((page.errors, page.requests), ([], [self.path.resolve().as_uri()]))

    def assert_pixel(self, page, row, name):
        """The colour of the diagram a little beside a point, off whatever marks it."""
        colour = [round(255 * part) for part in scan_columns.rgba(scan_columns.COLOURS[name])[:3] / 255]
        x, y = self.place(page, row)
        found = page.evaluate(f"""(() => {{
            const map = document.getElementById("map"), box = map.getBoundingClientRect();
            return [...map.getContext("2d").getImageData({x} - box.left, {y} - box.top, 1, 1).data];
        }})()""")
        self.assertEqual(found[:3], colour)

    def stored(self):
        """The trajectories of scan.h5."""
        with h5py.File(self.folder / "scan.h5") as file:
            return {name: file["trajectories"][name][()] for name in ("point", "t", "x", "y", "theta")}

    def assert_walk(self, page, stored, sample):
        """Half-way along each rod's path, where the page's own scale puts it, the canvas has the colour of the rod."""
        x, y = stored["x"][sample], stored["y"][sample]
        width, height = (page.evaluate(f"document.getElementById('path').client{side}") for side in ("Width", "Height"))
        low, high = np.array([x.min(), y.min()]), np.array([x.max(), y.max()])
        scale, middle = min((np.array([width, height]) - 68) / (high - low)), (low + high) / 2
        for rod, colour in ((0, "#d55e00"), (1, "#0072b2")):
            px, py = width / 2 + scale * (x[40, rod] - middle[0]), height / 2 - scale * (y[40, rod] - middle[1])
            near = page.evaluate(f"""(() => {{
                const data = document.getElementById("path").getContext("2d").getImageData({px} - 2, {py} - 2, 5, 5).data;
                return Array.from({{ length: 25 }}, (_, at) => [...data.subarray(4 * at, 4 * at + 3)]);
            }})()""")
            wanted = [int(colour[at:at + 2], 16) for at in (1, 3, 5)]
            self.assertLess(min(max(abs(a - b) for a, b in zip(one, wanted)) for one in near), 40, f"rod {rod} is not drawn at {px}, {py}")


def shown(value, digits):
    """As the page writes numbers that need no power of ten."""
    return f"{float(f'{value:.{digits}g}'):.12g}".replace("-", "−")


def grouped(count):
    return f"{count:,}".replace(",", "\u2009")
