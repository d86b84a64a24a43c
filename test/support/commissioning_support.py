"""Synthetic recordings of one axis with known truth."""

from __future__ import annotations

import numpy as np

from cnc_ptp.commissioning.trace import AxisTrace

T = 0.001
COLUMNS = (
    "set_velocity",
    "actual_position",
    "actual_velocity",
    "command_velocity",
    "additive_velocity",
    "actual_torque",
)


def trace_of(axis="x", cycle=None, cycle_time=T, mean_velocity=False, **columns):
    """A recording with the given columns; those that are left out are 0, actual values are the set ones."""
    length = len(next(iter(columns.values())))
    rows = {name: np.zeros(length) for name in COLUMNS} | {"cycle": np.arange(length)}
    if "set_velocity" in columns:
        rows["actual_velocity"] = rows["command_velocity"] = columns["set_velocity"]
        rows["actual_position"] = np.cumsum(columns["set_velocity"]) * cycle_time
    rows |= columns
    if cycle is not None:
        rows["cycle"] = cycle
    given = {name: np.array(row) for name, row in rows.items() if row is not None}
    return AxisTrace.of_rows(axis, cycle_time, given, mean_velocity=mean_velocity)


def stribeck(speed, *, coulomb=120.0, static=180.0, stribeck_velocity=4.0, viscous=0.3):
    """Friction in N over the magnitude of the velocity in mm/s (Armstrong-Hélouvry)."""
    return coulomb + (static - coulomb) * np.exp(-((speed / stribeck_velocity) ** 2)) + viscous * speed


def phases(speeds, *, seconds=0.5, rest=0.1, both=True, cycle_time=T):
    """Set velocities: each speed forth and back, with rests in between."""
    parts = [np.zeros(round(rest / cycle_time))]
    for speed in speeds:
        for direction in (1.0, -1.0) if both else (1.0,):
            parts += [np.full(round(seconds / cycle_time), direction * speed), np.zeros(round(rest / cycle_time))]
    return np.concatenate(parts)


def friction_run(speeds, *, friction=stribeck, load=0.0, noise=0.0, seed=1, transient=0.0, **options):
    """A recording of phases with friction torque, weight, noise, and `transient` N more in the first 0.1 s of each."""
    velocity = phases(speeds, **options)
    torque = np.sign(velocity) * friction(np.abs(velocity)) + load
    starts = np.flatnonzero(np.diff(velocity, prepend=0.0) * np.sign(velocity) > 0.0)
    for start in starts:
        torque[start : start + 100] += transient * np.sign(velocity[start])
    torque += noise * np.random.default_rng(seed).standard_normal(len(torque))
    return trace_of(set_velocity=velocity, actual_torque=torque)
