"""Clients of a running machine: commands for its units, and a look at them."""
