"""Figures and films of run directories as data of the page: WebP, no wider than the page shows them."""

import base64
import io

from PIL import Image, ImageSequence

WIDEST, FILM_WIDTH = 1500, 400  # pixels
QUALITY, FILM_QUALITY = 82, 30
FRAMES = 30  # of a film, about: a page of films must not grow beyond some megabytes


def source(folder, name):
    """The film of that name, or the figure."""
    for ending in (".mp4", ".gif", ".png"):
        path = folder / "figures" / (name + ending)
        if path.is_file():
            return path
    return None


def markup(path, cache):
    """The element that shows it. Films by ffmpeg stay as they are."""
    alt = f"{path.stem} of {path.parent.parent.name}"
    if path.suffix == ".mp4":
        return f'<video controls loop muted playsinline aria-label="{alt}" src="data:video/mp4;base64,{encoded(path.read_bytes())}"></video>'
    data, (width, height) = shrunk(path, cache)
    return f'<img alt="{alt}" width="{width}" height="{height}" src="data:image/webp;base64,{encoded(data)}">'


def encoded(data):
    return base64.b64encode(data).decode("ascii")


def shrunk(path, cache):
    kept = cache / f"{path.parent.parent.name}-{path.stem}.webp"
    if not kept.is_file() or kept.stat().st_mtime < path.stat().st_mtime:
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_bytes(film(path) if path.suffix == ".gif" else still(path))
    data = kept.read_bytes()
    with Image.open(io.BytesIO(data)) as image:
        return data, image.size


def fitted(image, width):
    image = image.convert("RGB")
    return image if image.width <= width else image.resize((width, round(image.height * width / image.width)), Image.LANCZOS)


def still(path):
    with Image.open(path) as image, io.BytesIO() as out:
        fitted(image, WIDEST).save(out, "WEBP", quality=QUALITY, method=6)
        return out.getvalue()


def film(path):
    with Image.open(path) as image, io.BytesIO() as out:
        every, step = -(-image.n_frames // FRAMES), image.info.get("duration", 100)
        first, *rest = (fitted(frame, FILM_WIDTH) for k, frame in enumerate(ImageSequence.Iterator(image)) if k % every == 0)
        first.save(out, "WEBP", save_all=True, append_images=rest, duration=step * every, loop=0, quality=FILM_QUALITY, method=4)
        return out.getvalue()
