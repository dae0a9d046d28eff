"""Figures and report of a rodwake run. Reads result files only; no physics is computed here, but for the local order that colours beads."""
