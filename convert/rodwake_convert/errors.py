"""What ends a conversion, and how words and bytes of a damaged file are shown to the user."""


class InputError(Exception):
    """The input is wrong: exit code 2. The message begins with the path of the input."""


class OutputError(Exception):
    """The output cannot be written, or a library is missing: exit code 1."""


def shown(word, most=60):
    """A word of a file as it may be printed: bytes that are not UTF-8 and control characters as \\x.., cut after 60 characters."""
    raw = word if isinstance(word, bytes) else str(word).encode("utf-8", "surrogateescape")
    text = raw.decode("utf-8", "backslashreplace")
    text = "".join(c if c.isprintable() else f"\\x{ord(c):02x}" for c in text[:most + 1])
    return text[:most] + "..." * (len(text) > most)


def reason(error):
    """The text of an exception of a library, in one line."""
    return " ".join(shown(error, 200).split()) or type(error).__name__
