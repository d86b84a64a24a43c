"""The NC channel: the sequence of a program, its functions and waits, and what it knows of its axes and spindles."""
