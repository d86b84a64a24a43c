"""Threads (G33): a path that follows the angle of a spindle instead of time."""
