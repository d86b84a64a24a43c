"""Recordings of runs: written and read as MCAP, compared bit for bit with a second computation, shown as a page."""
