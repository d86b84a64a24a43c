"""A machine file as parameter sets: its text is read, names and values are checked against their declarations."""
