"""The kernel as a compiled library: built by mypyc, used while the sources are those that it was built from."""
