"""The longest run."""

LONGEST_RUN = 1e7
"""Seconds of machine time, 115 days."""
