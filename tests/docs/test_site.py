"""The docs as a site, built by mkdocs and opened from the disk in headless Chromium."""

import html
import json
import re
import subprocess
import tempfile
import unittest
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import browser
import rodwake
from rodwake import SOURCE


class Page(HTMLParser):
    """What a page points to, what it can be pointed at, and its equations as they stand before KaTeX."""

    def __init__(self, text):
        super().__init__()
        self.links, self.loaded, self.ids, self.equations, self.depth = [], [], {"", "__skip"}, [], 0
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        named = dict(attributes)
        self.ids |= {named.get("id"), named.get("name")}
        if tag == "a" and named.get("href"):
            self.links.append(named["href"])
        elif tag in ("img", "script", "iframe", "link"):
            self.loaded += [named[key] for key in ("src", "href") if named.get(key)]
        if "arithmatex" in (named.get("class") or ""):
            self.equations.append("")
            self.depth = 1

    def handle_endtag(self, tag):
        self.depth = 0

    def handle_data(self, data):
        if self.depth:
            self.equations[-1] += data


def dead(pages, files):
    """Links and loaded files of pages (name: Page) that are not there, and what is fetched; api/ is made by doxygen, not by mkdocs."""
    wrong = []
    for name, page in pages.items():
        for target in page.links + page.loaded:
            if re.match(r"https?:", target) and target in page.loaded:
                wrong.append(f"{name} loads {target}")
            if re.match(r"\w+:", target):
                continue
            path, _, anchor = unquote(target).partition("#")
            there = path.partition("?")[0] or name
            if not (there in pages or there in files or there.startswith("api/") or there == "."):
                wrong.append(f"{name}: there is no {there}")
            elif there in pages and anchor not in pages[there].ids:
                wrong.append(f"{name}: {there} has no #{anchor}")
    return wrong


# Opens pages one after the other in a frame as wide as a phone, and writes how wide each of them is.
WIDTHS = """<!doctype html><body><pre id="widths"></pre><script>
(async () => {
  for (const name of NAMES) {
    const frame = Object.assign(document.createElement("iframe"), { width: 390, height: 800, src: name });
    const loaded = new Promise(resolve => frame.onload = resolve);
    document.body.append(frame);
    await loaded;
    document.getElementById("widths").textContent += name + " " + frame.contentDocument.documentElement.scrollWidth + "\\n";
    frame.remove();
  }
})();
</script>"""


def dump(uri):
    """The page as the browser has it when its scripts have run."""
    with tempfile.TemporaryDirectory(prefix="rodwake-page-") as folder:
        return subprocess.run([*browser.command(folder, 1200, 900), "--allow-file-access-from-files", "--virtual-time-budget=30000",
                               "--dump-dom", uri], capture_output=True, text=True, timeout=60).stdout


class SiteTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="rodwake-site-")
        cls.addClassCleanup(cls.folder.cleanup)
        cls.site = Path(cls.folder.name)
        cls.built = subprocess.run(["mkdocs", "build", "--strict", "--quiet", "--site-dir", cls.site], cwd=SOURCE, capture_output=True,
                                   text=True, timeout=120)
        cls.pages = {path.name: Page(path.read_text()) for path in cls.site.glob("*.html") if path.name not in ("404.html", "live.html")}
        cls.files = {path.relative_to(cls.site).as_posix() for path in cls.site.rglob("*")}

    def test_builds_without_a_warning(self):
        self.assertEqual((self.built.returncode, self.built.stderr), (0, ""))
        self.assertEqual(set(self.pages), {"index.html", "CHANGELOG.html", "CONTRIBUTING.html",
                                           *(path.stem + ".html" for path in (SOURCE / "docs").glob("*.md"))})

    def test_nothing_is_dead_or_fetched(self):
        self.assertGreater(sum(len(page.links) for page in self.pages.values()), 500)
        self.assertEqual(dead(self.pages, self.files), [])

    def test_dead_links_are_found(self):
        page = Page('<a href="#no"></a><a href="gone.html"></a><a href="https://a.b"></a><script src="https://c.d"></script><p id="x">')
        self.assertEqual(dead({"a.html": page}, set()), ["a.html: a.html has no #no", "a.html: there is no gone.html", "a.html loads https://c.d"])

    def test_every_equation_is_rendered(self):
        """All equations on one page, in the browser."""
        equations = [text for page in self.pages.values() for text in page.equations]
        self.assertGreater(len(equations), 700)
        page = self.site / "equations.html"
        page.write_text('<!doctype html><meta charset="utf-8"><body>' + "".join(f'<p class="arithmatex">{html.escape(text)}</p>'
                                                                                for text in [*equations, r"\(\wrong\)"])
                        + '<script src="katex/katex.min.js"></script><script src="site.js"></script>', encoding="utf-8")
        shown = dump(page.as_uri())
        page.unlink()
        self.assertEqual(shown.count('<span class="katex">') + shown.count('class="katex-error"'), len(equations) + 1)
        self.assertEqual(re.findall(r'style="color: rgb\(204, 0, 0\);">(?:<[^>]*>)*([^<]*)', shown), [r"\wrong"])

    def test_no_page_is_wider_than_a_phone(self):
        wide, page = self.site / "wide.html", self.site / "widths.html"
        wide.write_text('<!doctype html><p style="width: 500px">wide</p>')
        page.write_text(WIDTHS.replace("NAMES", json.dumps([*sorted(self.pages), wide.name])))
        widths = dict(re.findall(r"^(?:.*>)?(\w+\.html) (\d+)$", dump(page.as_uri()), re.MULTILINE))
        page.unlink()
        wide.unlink()
        self.assertEqual(len(widths), len(self.pages) + 1)
        self.assertEqual([name for name, width in widths.items() if int(width) > 390], ["wide.html"])

    def test_panels_of_the_explorer_compute_in_pages(self):
        framed = {name: [target for target in page.loaded if target.startswith("live.html")] for name, page in self.pages.items()}
        self.assertEqual({name for name, targets in framed.items() if targets}, {"index.html", "tutorial.html", "theory.html", "scans.html"})
        for target in sum(framed.values(), []):
            panels = re.search(r"show=([\w,]+)", target)[1].split(",")
            with self.subTest(target), browser.Page(self.site / "live.html", 760, 800) as page:
                page.go(self.site / "live.html", target.removeprefix("live.html"))
                page.evaluate("rodwake.ready")
                shown = page.evaluate("[...document.querySelectorAll('.panel')].filter(one => !one.hidden).map(one => one.id)")
                self.assertEqual(sorted(shown), sorted(panels))
                self.assertEqual(page.evaluate("document.querySelector('header').hidden && !document.querySelector('#whole').hidden"), True)
                self.assertEqual(page.evaluate("rodwake.page.paths.run.outcome"), page.evaluate("document.querySelector('#badge').textContent"))
                self.assertEqual(page.errors, [])

    def test_search_from_a_disk(self):
        shown = dump((self.site / "index.html").as_uri() + "?q=microrheology")
        found = re.findall(r'<a href="file:[^"]*/(\w+\.html)[^"]*" class="md-search-result__link', shown)
        self.assertIn("extending.html", found)
        self.assertNotIn("scans.html", found)
        index = json.loads((self.site / "search/search_index.json").read_text(encoding="utf-8"))
        text = " ".join(entry["text"] for entry in index["docs"])
        self.assertIn("on a substrate, with drag ζ per area", text)
        self.assertNotIn("\\(", text)

    def test_reference_of_the_headers(self):
        """Doxygen reads every public header without a warning, and keeps what stands at its top."""
        with tempfile.TemporaryDirectory(prefix="rodwake-api-") as folder:
            settings = (SOURCE / "tools/site_parts/Doxyfile").read_text() + f"OUTPUT_DIRECTORY = {folder}\n"
            done = subprocess.run(["doxygen", "-"], input=settings, cwd=SOURCE, capture_output=True, text=True, timeout=120)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            files = Path(folder, "api/files.html").read_text()
            self.assertIn("mutual_wakes.hpp", files)
            self.assertEqual({link for link in self.pages["cpp.html"].links if link.startswith("api/")}, {"api/files.html"})
            field = Path(folder, "api/field_8hpp.html").read_text()
            self.assertIn("Exact steady field of one rod moving along +x through the medium", field)
            self.assertIn("-(1/xi) d_x U - lap U - eta grad div U = delta(r) xhat", field)


if __name__ == "__main__":
    rodwake.main()
