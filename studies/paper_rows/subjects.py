"""The subjects of the page, in its order."""

from . import bed, bed_pairs, fits, noise, theory_field, theory_pairs

ALL = (theory_field.FIELD, theory_pairs.PAIRS, bed.BED, bed_pairs.PAIRS, noise.NOISE, fits.WAKE_ROWS, bed_pairs.FILMS)
