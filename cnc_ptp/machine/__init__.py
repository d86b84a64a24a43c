"""The machine: units wired together, run in step with each other or offline; the job of a run."""
