"""Clients of a running machine: commands for its units, and their newest blocks."""
