"""Commands that run a machine: simulate, run, replay."""
