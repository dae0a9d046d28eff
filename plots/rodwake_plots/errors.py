"""The one exception that means: tell the user in a line and stop."""


class PlotError(Exception):
    pass
