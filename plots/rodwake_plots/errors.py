"""The exceptions that mean: tell the user in a line and stop."""


class PlotError(Exception):
    pass


class MissingError(PlotError):
    """What a figure shows was not computed in this folder: the other figures can be drawn."""


class UsageError(PlotError):
    """An option that cannot be."""
