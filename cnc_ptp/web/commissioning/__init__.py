"""Commissioning from pages: identification, circle test, curves, changed machine files."""
