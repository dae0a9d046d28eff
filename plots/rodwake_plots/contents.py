"""What leads from the report to something else: its contents, the files behind each figure, the command that makes it again."""

import os
import re
import shlex

from . import schema, words

MOST_FILES = 6
VERBS = ("dem", "rods", "fit", "field", "scan", "run")  # that make a folder from a scene alone
FIT_TABLES = ("fit_profile_*.csv", "fit_curve_*.csv", "fit_map_*.csv", "fit_trajectory_*.csv")


def identifier(name):
    return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")


def navigation(sections, figures):
    """Links to the sections [name] that are there, and under them to the figures [(number, name)]."""
    links = " ".join(f'<a href="#{identifier(name)}">{name}</a>' for name in sections)
    if len(figures) > 1:
        links += '<br><span class="figures">' + " ".join(f'<a href="#figure-{number}">{number} {words.label_html(name)}</a>'
                                                         for number, name in figures) + "</span>"
    return f'<nav aria-label="Contents">{links}</nav>'


def files_of(run, spec):
    """Paths of the run directory whose numbers a figure shows, relative to it; those of variants and of an ensemble's runs too."""
    names = list(schema.FIGURES[spec.kind]["files"])
    if spec.kind == "profile":
        names = [f"profile_{spec.component}_{spec.along}.csv"]
    if spec.kind in ("fit", "fit_map", "fit_trajectories"):
        names += FIT_TABLES
    found = [path for name in names for pattern in (name, f"variants/*/{name}", f"runs/*/{name}") for path in sorted(run.path.glob(pattern))]
    return [path.relative_to(run.path).as_posix() for path in found]


def links(run, spec):
    """Data, and the figure as it goes into a paper."""
    found = files_of(run, spec)
    parts = [link(beside(run, path), path) for path in found[:MOST_FILES]] + ([f"and {len(found) - MOST_FILES} more"] if len(found) > MOST_FILES else [])
    text = f"Data: {', '.join(parts)}" if parts else ""
    drawn = [link(f"figures/{spec.name}{ending}", ending[1:].upper()) for ending in (".pdf", ".png", ".mp4", ".gif")
             if (run.figures_dir / f"{spec.name}{ending}").is_file()]
    return f'<div class="files">{" · ".join(filter(None, (text, *drawn)))}</div>'


def beside(run, path):
    """A file of the run as a link of the page, which may stand elsewhere."""
    return path if run.output == run.path else os.path.relpath(run.path / path, run.output)


def link(path, text):
    return f'<a href="{words.escape(path)}">{words.escape(text)}</a>'


def reproduce(run):
    """The command that makes this run again from the resolved scene, and what else it depends on."""
    told = run.provenance or {}
    command = str(told.get("command") or "")
    first = next((word for word in split(command)[1:] if not word.startswith("-")), "")
    verb = first if first in VERBS else "run"  # a run of Python, too
    program = f"rodwake {words.escape(told.get('version', run.version))}" + (f", git {words.escape(told['git'])}" if told.get("git") else "")
    seed = f", seed {words.number(told['seed'])}" if words.is_number(told.get("seed")) else ""
    took = f"; it took {words.number(float(told['wall_seconds']), 2)} s" if words.is_number(told.get("wall_seconds")) else ""
    return (f'<div class="reproduce">\n<pre>rodwake {words.escape(verb)} scene.toml -o again\nrodwake plot again --pdf</pre>\n'
            f'<p>{link(beside(run, "scene.toml"), "scene.toml")} is the scene with every default written out; the result does not depend on the number '
            f"of threads. Made by {program}{seed}{took}.</p>\n"
            + (f"<p>As it was called: <code>{words.escape(command)}</code></p>\n" if command else "") + "</div>")


def split(command):
    try:
        return shlex.split(command)
    except ValueError:
        return command.split()
