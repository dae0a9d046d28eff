"""What the pages have in common. Their text comes from files that anybody may have written, so nothing of it is ever run."""

import base64
import hashlib
import json

from . import words

# In JSON inside a script: what could end or begin a script or a comment, and the line ends of old JavaScript.
SPELT = {ord(sign): f"\\u{ord(sign):04x}" for sign in "<>&\u2028\u2029"}


def head(title, style, script=""):
    return (f'<meta charset="utf-8">\n<meta http-equiv="Content-Security-Policy" content="{policy(script)}">\n'
            '<meta name="viewport" content="width=device-width, initial-scale=1">\n<meta name="color-scheme" content="light dark">\n'
            f"<title>{words.escape(title)}</title>\n<style>\n{style}</style>")


def policy(script):
    """Nothing runs but the page's own script, by its hash; nothing is loaded but the pictures and films inside the page."""
    digest = base64.b64encode(hashlib.sha256(script.encode("utf-8")).digest()).decode("ascii")
    scripts = f"script-src 'sha256-{digest}'; " if script else ""
    return f"default-src 'none'; {scripts}style-src 'unsafe-inline'; img-src data:; media-src data:; base-uri 'none'; form-action 'none'"


def json_text(value):
    return json.dumps(value, ensure_ascii=False, separators=(",", ":")).translate(SPELT)
