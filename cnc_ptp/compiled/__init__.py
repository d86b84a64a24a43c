"""The kernel as a compiled library: built from the same sources by mypyc, used while they are what it was built from."""
