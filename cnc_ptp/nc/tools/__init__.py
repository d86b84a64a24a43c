"""Tools of a program: compensation data of T and D, lengths and offsets in machine coordinates, V.G.WZ."""
