"""The machine: units wired together, run in step or offline; program and scenario of a run."""
