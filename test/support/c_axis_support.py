"""A lathe whose main spindle is a C axis, and what the tests of it ask its runs."""

from __future__ import annotations

from cmath import exp
from dataclasses import replace
from math import radians
from typing import Any

import numpy as np
from machine_support import ROOT, MachineBench

from cnc_ptp.parameters import MachineParameters, read_machine
from cnc_ptp.protocol.spindle_states import SpindleBit

LATHE = read_machine(ROOT / "config" / "lathe.yaml")


def lathe(**channel: Any) -> MachineParameters:
    """The lathe with other parameters of its channel."""
    return replace(LATHE, channels={"channel": replace(LATHE.channels["channel"], **channel)})


def run(program: str, scenario: str = "", machine: MachineParameters = LATHE) -> MachineBench:
    return MachineBench(program, scenario, machine=machine).run()


def errors(bench: MachineBench, unit: str = "channel") -> list[str]:
    return [event.text for event in bench.events_of(unit) if event.severity == 2]


def on_path(bench: MachineBench) -> list[int]:
    """Cycles in which the path moves the spindle."""
    return [cycle for cycle, bit in enumerate(bench.column("s", "status_bits")) if bit & SpindleBit.ON_PATH]


def machine_path(bench: MachineBench) -> list[tuple[float, float, float]]:
    """Set positions of X, of the spindle (deg) and of Z in the cycles in which the path moves the spindle."""
    x, z = bench.column("x", "set_position"), bench.column("z", "set_position")
    angle = bench.column("s", "set_position_deg")
    return [(x[cycle], angle[cycle], z[cycle]) for cycle in on_path(bench)]


def face_path(bench: MachineBench) -> list[complex]:
    """The same on the face: x + i·y, mm."""
    return [radius * exp(1j * radians(angle)) for radius, angle, _ in machine_path(bench)]


def differences(values: list[float]) -> list[float]:
    """The largest velocity, acceleration and jerk in samples of 1 ms, per s, s² and s³."""
    largest = []
    for order in range(1, 4):
        largest.append(float(np.abs(np.diff(values, order)).max()) * 1000.0**order)
    return largest


def assert_within_limits(bench: MachineBench) -> None:
    """X, Z and C, from their positions alone."""
    x, angle, z = (list(column) for column in zip(*machine_path(bench), strict=True))
    gear, ramp = LATHE.spindles["s"].gears[1], LATHE.channels["channel"].c_axis_ramp
    spindle = (gear.max_speed, gear.acceleration, gear.acceleration / ramp)
    for axis, values in (("x", x), ("z", z)):
        limits = LATHE.axes[axis]
        allowed = (limits.rapid_velocity, limits.acceleration, limits.jerk)
        assert all(value <= most * SAMPLED for value, most in zip(differences(values), allowed, strict=True)), axis
    assert all(value <= most * SAMPLED for value, most in zip(differences(angle), spindle, strict=True))


SAMPLED = 1.0 + 1e-4
"""Differences of positions are rounded."""
