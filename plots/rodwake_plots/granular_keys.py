"""What the keys of [granular] mean, for the report. Its tables are in SI units whatever the rest of the scene is in."""

# table: key -> (symbol, meaning, unit)
MEANINGS = {
    "granular": {
        "bead_radius": ("<i>a</i>", "bead radius", "m"),
        "phi_b": ("<i>φ<sub>b</sub></i>", "wanted area fraction <i>Nπa</i>²/<i>L</i>²", ""),
        "beads": ("<i>N</i>", "number of beads", ""),
        "count_rod_area": ("", "whether the rods' shadows share the wanted area fraction", ""),
        "bead_density": ("", "mass density of the beads", "kg/m³"),
        "gravity": ("<i>g</i>", "towards the floor", "m/s²"),
        "box": ("<i>L</i>", "side of the periodic square", "m"),
        "start": ("", "how the beads are placed", ""),
        "restart_from": ("", "checkpoint the run began from", ""),
        "orientation": ("", "wanted angle of the close-packed rows from <i>x</i>", "rad"),
        "start_speed": ("", "rms of each velocity component at the start", "m/s"),
        "time_step": ("Δ<i>t</i>", "step of the integration", "s"),
        "equilibrate": ("", "time before <i>t</i> = 0, rods held", "s"),
        "duration": ("", "time from <i>t</i> = 0 on", "s"),
        "stop_at_travel": ("", "the run ends when the rods' mean travel along their headings reaches this", "m"),
        "seed": ("", "of everything random", ""),
        "runs": ("", "runs that differ in their random start only", ""),
        "overlap_limit": ("", "largest overlap allowed, of the smaller radius", ""),
        "order_cutoff": ("", "beads nearer than this are neighbours in <i>ψ</i><sub>6</sub>", "m"),
    },
    "plates": {
        "gap": ("<i>w</i>", "from floor to lid", "m"),
        "frequency": ("<i>f</i>", "of floor and lid, which move together", "Hz"),
        "gamma": ("<i>Γ</i>", "peak acceleration over gravity, <i>A</i>(2π<i>f</i>)²/<i>g</i>", ""),
    },
    "contacts": {
        "particle_particle": ("", "beads and rods with each other", ""),
        "rod_wall": ("", "rods with floor and lid", ""),
        "bead_wall": ("", "beads with floor and lid", ""),
        "bead_bead": ("", "beads with beads, where different", ""),
        "bead_rod": ("", "beads with rods, where different", ""),
        "rod_rod": ("", "rods with rods, where different", ""),
    },
    "output": {
        "frames": ("", "interval of the stored frames", "s"),
        "table": ("", "interval of the rows of table.csv and tracks.csv", "s"),
        "formats": ("", "files of the frames", ""),
        "last_period": ("", "whether one period of the plates at the end is stored finely", ""),
        "checkpoint": ("", "wall-clock time between checkpoints", "s"),
    },
}
NAMES = {"granular": "Granular bed", "plates": "Plates", "contacts": "Contacts", "output": "Output", "rods": "Rods in the bed"}
COLUMNS = {"position": "m", "heading": "rad", "imposed_speed": "m/s", "thick_diameter": "m", "thin_diameter": "m", "length": "m",
           "density": "kg/m³"}
