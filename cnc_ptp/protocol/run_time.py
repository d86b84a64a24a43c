"""How long a run may be."""

LONGEST_RUN = 1e7
"""Seconds of machine time, 115 days."""
