"""What mkdocs does not do by itself: README and other pages of the root are part of the site, links into the source tree become
names or lead to the headers' reference, KaTeX is copied from Debian's package, the search works from a disk."""

import contextlib
import html
import json
import os
import re
import shutil
import subprocess
import sys
import unicodedata
from pathlib import Path

from mkdocs.structure.files import File

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/site_parts"))

from links import CODE, ELSEWHERE, FENCE, LINK, resolve  # noqa: E402

ROOT_PAGES = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md"]
KATEX = Path("/usr/share/javascript/katex")
HEADERS = "include/rodwake"  # doxygen makes api/ from it
EXPLORER = "live.html"  # of rodwake explore; pages show panels of it in frames
FRAME = re.compile(r"<!-- explorer: (?P<panels>[\w,]+)(?:#(?P<state>\S+))? (?P<title>.+) -->")


def program():
    """The program that writes the explorer's page: a built one, else the installed one; None: pages do without."""
    built = [ROOT / "build" / preset / "rodwake" for preset in ("release", "program", "dev")]
    return os.environ.get("RODWAKE_PROGRAM") or next((str(path) for path in built if path.is_file()), shutil.which("rodwake"))


def on_files(files, config):
    for name in ROOT_PAGES:
        if (ROOT / name).is_file():
            files.append(File(name, str(ROOT), config["site_dir"], config["use_directory_urls"]))
    return files


def source_of(page):
    """The page's file from the root of the source tree."""
    return Path(page.file.abs_src_path).relative_to(ROOT).as_posix()


def site_link(page, match):
    """A link of the source tree as it is on the site."""
    if ELSEWHERE.match(match["target"]) or not match["target"]:
        return match[0]
    target = resolve(page, match["target"])
    if target == HEADERS:
        return f'<a href="api/files.html">{match["label"]}</a>'
    if target in ROOT_PAGES or target.startswith("docs/"):
        return f'{match["image"]}[{match["label"]}]({target.removeprefix("docs/")}{match["anchor"] or ""})'
    return f"`{target}`" if match["label"] == target else f'{match["label"]} (`{target}`)'


def in_words(text):
    """An equation as the results of a search show it: Greek letters, no signs of TeX."""
    def letter(match):
        name = "LAMDA" if match[1] == "lambda" else match[1].upper()
        with contextlib.suppress(KeyError):
            return unicodedata.lookup(f"GREEK {'CAPITAL' if match[1][0].isupper() else 'SMALL'} LETTER {name}")
        return {"pm": "±", "times": "×", "approx": "≈", "infty": "∞", "le": "≤", "ge": "≥"}.get(match[1], "")

    return re.sub(r"\\([a-zA-Z]+)", letter, re.sub(r"\\[()\[\]]", "", text))


def frame(match):
    """Panels of the explorer where a page says <!-- explorer: wake,phases#kappa=30 What it shows -->."""
    address = html.escape(f"{EXPLORER}?show={match['panels']}" + (f"#{match['state']}" if match["state"] else ""))
    count = match["panels"].count(",") + 1
    return f'<iframe class="explorer panels{count}" src="{address}" title="{html.escape(match["title"])}" loading="lazy"></iframe>'


def on_page_markdown(markdown, page, config, files):
    source, lines, inside = source_of(page), [], False
    for line in markdown.split("\n"):
        if not inside and (match := FRAME.fullmatch(line)) and program():
            lines.append(frame(match))
            continue
        if FENCE.match(line):
            inside = not inside
        if inside or "](" not in line:
            lines.append(line)
            continue
        code = [span.span() for span in CODE.finditer(line)]
        lines.append(LINK.sub(lambda match: match[0] if any(a <= match.start() and match.end() <= b for a, b in code)
                              else site_link(source, match), line))
    return "\n".join(lines)


def on_post_build(config):
    site = Path(config["site_dir"])
    if program():
        subprocess.run([program(), "explore", "-o", site / EXPLORER, "--force", "--quiet"], check=True)
    for name in ("katex.min.js", "katex.min.css"):
        (site / "katex").mkdir(exist_ok=True)
        shutil.copy(KATEX / name, site / "katex" / name)
    shutil.copytree(KATEX / "fonts", site / "katex/fonts", dirs_exist_ok=True)
    path = site / "search/search_index.json"
    index = json.loads(path.read_text(encoding="utf-8"))
    for entry in index["docs"]:
        entry["text"] = in_words(entry["text"])
    path.write_text(json.dumps(index), encoding="utf-8")
    (site / "search/search_index.js").write_text(f"window.rodwakeSearchIndex = {json.dumps(index)};\n", encoding="utf-8")
