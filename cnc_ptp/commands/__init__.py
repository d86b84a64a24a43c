"""The commands of the command line, one a file; each returns the exit status."""
