"""The exceptions that mean: tell the user in a line and stop."""


class PlotError(Exception):
    pass


class UsageError(PlotError):
    """An option that cannot be."""
