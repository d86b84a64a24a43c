"""The commands of the command line, one a file, grouped by what a person does; each returns the exit status."""
