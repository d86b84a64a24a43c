"""The order of execution: conditions, loops, jumps, subroutines."""
