"""Figures and report of a rodwake run. Reads result files only; no physics is computed here."""
