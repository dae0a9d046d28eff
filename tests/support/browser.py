"""Opens a report in headless Chromium, as a reader does, and tells what the browser made of it."""

import re
import tempfile
from html.parser import HTMLParser
from pathlib import Path

from chromium import command  # noqa: F401: for those who start one of their own
from page_driver import Page

LISTEN = """
window.seen = [];
window.addEventListener("error", event => {
  if (event.target !== window) seen.push("cannot load " + (event.target.src || event.target.href));
}, true);
"""

# What scrolls inside its own box may be wider than the window.
LOOK = """(() => {
  const all = [...document.querySelectorAll("body *")], right = document.documentElement.clientWidth;
  const scrolls = node => node && node !== document.body
                          && (/auto|scroll/.test(getComputedStyle(node).overflowX) || scrolls(node.parentElement));
  return {
    errors: window.seen,
    title: document.title,
    width: window.innerWidth,
    images: [...document.images].map(one => [one.alt, one.naturalWidth, Math.round(one.getBoundingClientRect().width)]),
    figures: document.querySelectorAll("figure").length,
    headings: [...document.querySelectorAll("h2")].map(one => one.textContent),
    beyond: all.filter(one => one.getBoundingClientRect().right > right + 0.5 && !scrolls(one.parentElement))
               .map(one => one.tagName + ": " + one.textContent.slice(0, 60)),
    loaded: performance.getEntriesByType("resource").map(one => one.name).filter(name => !name.startsWith("data:")),
  };
})()"""
POINTING = {"src", "href", "srcset", "poster", "action", "formaction", "data", "background", "ping", "xlink:href"}


def look(page, width=1200, height=1000):
    """What the browser saw on a page, given as text, in a window of this size: a dict of LOOK's names."""
    with tempfile.TemporaryDirectory(prefix="rodwake-page-") as folder:
        path = Path(folder) / "page.html"
        path.write_text(page, encoding="utf-8")
        with Page(path, width, height, first=LISTEN) as opened:
            seen = opened.evaluate(LOOK)
            return seen | {"errors": seen["errors"] + opened.errors}


def unprotected(page):
    """The page without the policy that lets nothing run but its own script: for tests of what stands behind that policy."""
    found, count = re.subn(r'<meta http-equiv="Content-Security-Policy" content="[^"]*">\n', "", page)
    if count != 1:
        raise AssertionError(f"the page has {count} policies")
    return found


def is_beside(name):
    """Whether a link goes to a file in the page's folder or below it."""
    return not re.match(r"\w+:|/|\.\.", name.strip())


class References(HTMLParser):
    """Everything that points out of a page: attributes, and url() and @import of its styles."""

    def __init__(self):
        super().__init__()
        self.found, self.in_style = [], False

    def handle_starttag(self, tag, attributes):
        self.in_style = tag == "style"
        for name, value in attributes:
            if (tag, name) == ("a", "href") and is_beside(value or ""):
                continue  # nothing is fetched before somebody follows it
            if name in POINTING:
                self.add(value or "")
            elif name == "style":
                self.add_styles(value or "")

    def handle_endtag(self, tag):
        self.in_style = self.in_style and tag != "style"

    def handle_data(self, data):
        if self.in_style:
            self.add_styles(data)

    def add_styles(self, text):
        for _, name in re.findall(r"""url\(\s*(["']?)(.*?)\1\s*\)""", text) + re.findall(r"""@import\s+(["'])(.*?)\1""", text):
            self.add(name)

    def add(self, name):
        if not name.strip().startswith(("data:", "#")):
            self.found.append(name)


def references(page):
    """What the page would fetch from elsewhere."""
    reader = References()
    reader.feed(page)
    reader.close()
    return reader.found
