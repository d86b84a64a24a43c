"""A machine file as parameter sets: text, names and values against their declarations, all parameters of a node."""
