"""Beds of the studies of the medium: their scenes, and how they are run."""

import math

from lab import Lab, estimate, mean, read_json, weighted

A = 4e-4         # m, radius of a bead
PERIOD = 5e-3    # s, of the plates
COST = 1.1e-4    # CPU s a bead and simulated second, with some margin
SOUND_COST = 6   # times that where currents are measured
HEAD = "schema = 1\n[granular]\n"


class Beds(Lab):
    def make(self, name, scene, *settings, seed=None):
        """The run directory of a scene, measured if it says so."""
        return super().make(name, scene, *settings, verbs=("dem", "measure") if "[measure]" in self.text_of(scene) else ("dem",), seed=seed)

    def fit(self, name, text):
        """The result of a fit: fit.json."""
        return read_json(super().make(name, text, verbs=("fit",)), "fit")


def bed(duration, keys="", measure="", rods="", frames=0.1, runs=1, formats="[]", box="fit", equilibrate=2.0):
    """A bed of density 0.80 in the box of an unstrained crystal."""
    density = "" if "phi_b" in keys else "phi_b = 0.80\n"
    return (f'{HEAD}{density}box = "{box}"\nstart = "lattice"\nequilibrate = "{equilibrate} s"\nduration = "{duration:.6g} s"\nruns = {runs}\n{keys}'
            f'[granular.output]\nformats = {formats}\nlast_period = false\nframes = "{frames} s"\n{rods}'
            + (f"[measure]\n{measure}" if measure else ""))


def rod(speed=None, x=20, y=39):
    held = "" if speed is None else f'imposed_speed = "{speed} mm/s"\n'
    return f'[[granular.rods]]\nkind = "motile"\nposition = ["{x} a", "{y} a"]\n{held}'


def combined(folders, kind, name):
    """Mean of runs alike; its error from their scatter, of fewer than four from their own errors."""
    found = [estimate(measured[name]) for measured in (read_json(folder, "measure").get(kind, {}) for folder in folders) if name in measured]
    if len(found) >= 4:
        return mean([value for value, _ in found])
    return weighted(found) if found else (math.nan, math.nan)
