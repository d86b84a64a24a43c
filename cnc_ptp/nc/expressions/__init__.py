"""Expressions of NC programs: parsed once to a tree, evaluated as often as their line is executed."""
