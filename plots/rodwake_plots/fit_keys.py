"""Meanings of the keys of [fit] for the tables of the report; lengths are in the unit of the profiles."""

MEANINGS = {
    "fit": {
        "parameters": ("", "what is fitted", ""),
        "start": ("", "where the search starts", ""),
        "bounds": ("", "how far each may go", ""),
        "fixed": ("", "values that are not fitted", ""),
        "tied": ("", "parameters that are a multiple of another", ""),
        "log": ("", "searched in the logarithm", ""),
        "box": ("<i>L</i>", "side of the periodic box of the theory", ""),
        "heading": ("", "of the rod against the sides of the box", "rad"),
        "core": ("", "places nearer to the rod's centre are left out", ""),
        "independent_spacing": ("", "places nearer to each other share data; their errors are enlarged", ""),
        "method": ("", "how the minimum is searched", ""),
        "loss": ("", "what is minimised: squares, or a loss that large deviations sway less", ""),
        "loss_width": ("", "deviations beyond this many errors count as large", ""),
        "polish": ("", "Levenberg-Marquardt steps at the end", ""),
        "starts": ("", "searches from different starts", ""),
        "spread": ("", "how far the starts are spread, a factor", ""),
        "seed": ("", "of the starts and of random searches", ""),
        "tolerance": ("", "relative, of parameters and objective", ""),
        "max_evaluations": ("", "most evaluations of one start", ""),
        "likelihood": ("", "parameters whose likelihood is followed", ""),
        "length_unit": ("", "name of the profiles' unit of length", ""),
    },
}
NAMES = {"profiles": "Profiles of the fit", "trajectories": "Trajectories of the fit", "compare": "Other values compared with the fit"}
