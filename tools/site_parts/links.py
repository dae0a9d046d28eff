"""Links and anchors of Markdown pages, read as GitHub and the site read them."""

import posixpath
import re
from collections import Counter
from dataclasses import dataclass

LINK = re.compile(r"(?P<image>!?)\[(?P<label>[^\]]*)\]\((?P<target>[^)\s#]*)(?P<anchor>#[^)\s]*)?\)")
CODE = re.compile(r"`[^`\n]*`")
FENCE = re.compile(r"\s*(```|~~~)")
ELSEWHERE = re.compile(r"[a-z]+:")  # https:, mailto:


@dataclass
class Link:
    line: int
    target: str  # from the root of the source tree; the page itself for "#anchor"
    anchor: str  # without #


def outside_code(text):
    """The lines of a page with their numbers, blocks of code left out and code within a line blanked."""
    inside = False
    for number, line in enumerate(text.split("\n"), 1):
        if FENCE.match(line):
            inside = not inside
        elif not inside:
            yield number, CODE.sub(lambda code: "`" + "x" * (len(code[0]) - 2) + "`", line)


def resolve(page, target):
    return posixpath.normpath(posixpath.join(posixpath.dirname(page), target)) if target else page


def links(page, text):
    """Links and images of a page that lead into the source tree."""
    for number, line in outside_code(text):
        for match in LINK.finditer(line):
            if not ELSEWHERE.match(match["target"]):
                yield Link(number, resolve(page, match["target"]), (match["anchor"] or "#")[1:])


def anchors(text):
    """What a link can name after #: headings as GitHub turns them into anchors, the second of a kind with -1."""
    seen, lines = Counter(), text.split("\n")
    for number, _ in outside_code(text):
        if match := re.match(r"#{1,6} +(.*?)\s*#*$", lines[number - 1]):
            plain = LINK.sub(lambda link: link["label"], match[1]).translate({ord("`"): None, ord("*"): None})
            slug = re.sub(r"[^\w\- ]", "", plain.lower()).replace(" ", "-")
            yield f"{slug}-{seen[slug]}" if seen[slug] else slug
            seen[slug] += 1


def broken(root, pages):
    """`page:line: what` for each link of the pages (names from the root) that leads nowhere."""
    wrong = []
    for page in pages:
        for link in links(page, (root / page).read_text(encoding="utf-8")):
            if link.target.startswith("..") or not (root / link.target).exists():
                wrong.append(f"{page}:{link.line}: there is no {link.target}")
            elif link.anchor and link.anchor not in set(anchors((root / link.target).read_text(encoding="utf-8"))):
                wrong.append(f"{page}:{link.line}: {link.target} has no heading #{link.anchor}")
    return wrong
