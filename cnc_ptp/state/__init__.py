"""The state of units between two blocks as bytes, and units from such a state."""
