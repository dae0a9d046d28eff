"""The exceptions that mean: tell the user in a line and stop."""


class PlotError(Exception):
    pass


class MissingError(PlotError):
    """What a figure shows is not in a file of this folder. If it never was, the other figures can be drawn."""

    def __init__(self, file, why):
        super().__init__(f"{file}: {why}")
        self.file = file


class UsageError(PlotError):
    """An option that cannot be."""
