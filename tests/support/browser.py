"""Opens a report in headless Chromium, as a reader does, and tells what the browser made of it."""

import base64
import html
import json
import re
import shutil
import subprocess
import tempfile
from html.parser import HTMLParser
from pathlib import Path

LISTEN = """<script>
window.seen = { errors: [] };
const tell = text => window.seen.errors.push(String(text));
window.addEventListener("error", event => tell(event.message || "cannot load " + (event.target.src || event.target.href)), true);
window.addEventListener("unhandledrejection", event => tell(event.reason));
console.error = tell;
</script>"""

# What scrolls inside its own box may be wider than the window.
LOOK = """<script>
window.addEventListener("load", () => {
  const seen = window.seen, all = [...document.querySelectorAll("body *")], right = document.documentElement.clientWidth;
  const scrolls = node => node && node !== document.body
                          && (/auto|scroll/.test(getComputedStyle(node).overflowX) || scrolls(node.parentElement));
  seen.seconds = performance.now() / 1000;
  seen.title = document.title;
  seen.width = window.innerWidth;
  seen.images = [...document.images].map(one => [one.alt, one.naturalWidth, Math.round(one.getBoundingClientRect().width)]);
  seen.figures = document.querySelectorAll("figure").length;
  seen.headings = [...document.querySelectorAll("h2")].map(one => one.textContent);
  seen.beyond = all.filter(one => one.getBoundingClientRect().right > right + 0.5 && !scrolls(one.parentElement))
                   .map(one => one.tagName + ": " + one.textContent.slice(0, 60));
  seen.loaded = performance.getEntriesByType("resource").map(one => one.name).filter(name => !name.startsWith("data:"));
  const told = document.createElement("pre");
  told.id = "seen";
  told.textContent = btoa(unescape(encodeURIComponent(JSON.stringify(seen))));
  parent.document.body.append(told);
});
</script>"""
POINTING = {"src", "href", "srcset", "poster", "action", "formaction", "data", "background", "ping", "xlink:href"}


def look(page, width=1200, height=1000, timeout=60):
    """What the browser saw on a page, given as text, in a window of this size: a dict of LOOK's names.

    The window is a frame: the browser's own is never narrower than 500 pixels.
    """
    page = page.replace("<head>", "<head>" + LISTEN, 1).replace("</body>", LOOK + "</body>")
    with tempfile.TemporaryDirectory(prefix="rodwake-page-") as folder:
        frame = Path(folder) / "frame.html"
        frame.write_text(f'<!doctype html><meta charset="utf-8"><body><iframe width="{width}" height="{height}" style="border: 0" '
                         f'srcdoc="{html.escape(page)}"></iframe></body>', encoding="utf-8")
        done = run("--dump-dom", folder, frame, max(width, 600), height, timeout)
    found = re.search(r'<pre id="seen">([\w+/=]+)</pre>', done.stdout)
    if not found:
        raise AssertionError(f"the browser did not get to the end of the page (exit code {done.returncode}): {done.stderr[-2000:]}")
    return json.loads(base64.b64decode(found[1]).decode("utf-8"))


def picture(page, path, width=1200, height=1000, timeout=60):
    """The page as the browser shows it, a PNG; for looking at reports by eye."""
    with tempfile.TemporaryDirectory(prefix="rodwake-page-") as folder:
        run(f"--screenshot={path}", folder, Path(page).resolve(), width, height, timeout)


def run(action, folder, page, width, height, timeout):
    return subprocess.run([*command(folder, width, height), action, page.as_uri()], capture_output=True, text=True, timeout=timeout)


def command(folder, width, height):
    """No sandbox: it needs privileges that a container does not have; the page is our own. No name resolves: nothing is fetched."""
    program = shutil.which("chromium")
    if program is None:
        raise AssertionError("chromium is not installed: tools/packages.txt names what the tests need")
    return [program, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
            "--disable-extensions", "--disable-background-networking", "--disable-component-update", "--hide-scrollbars",
            "--host-resolver-rules=MAP * ~NOTFOUND", f"--user-data-dir={folder}/profile", f"--window-size={width},{height}"]


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
