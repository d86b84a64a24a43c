"""A simulated SERCOS drive: parameters behind a service channel, and homing that the drive does on its own."""
