"""Checks of parameters against each other: problems stop a node, notices go to the log."""
