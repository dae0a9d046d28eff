"""HTML of words.py as parts of which a page makes nodes without reading markup: a text, or [tag, parts...]."""

from html.parser import HTMLParser

TAGS = ("b", "i", "sub", "sup")


def parts(html):
    reader = Reader()
    reader.feed(html)
    reader.close()
    return reader.found


class Reader(HTMLParser):
    """A tag that words.py does not make stays text."""

    def __init__(self):
        super().__init__()
        self.found = []
        self._open = [self.found]

    def handle_starttag(self, tag, _):
        if tag not in TAGS:
            return self.handle_data(self.get_starttag_text())
        self._open[-1].append([tag])
        self._open.append(self._open[-1][-1])

    def handle_endtag(self, tag):
        if tag in TAGS and len(self._open) > 1:
            self._open.pop()

    def handle_data(self, text):
        self._open[-1].append(text)
