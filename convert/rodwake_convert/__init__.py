"""Films of particles in the formats of other programs, to and from the H5MD that rodwake reads."""
