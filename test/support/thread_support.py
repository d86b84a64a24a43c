"""Threads on the lathe of config/lathe.yaml: run them, and compare axes and spindle cycle by cycle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np
from machine_support import ROOT, MachineBench
from numpy.typing import NDArray

from cnc_ptp.parameters import MachineParameters, read_machine

MACHINE = read_machine(ROOT / "config" / "lathe.yaml")
SLOW: Final = 6000.0
"""deg/s² of the spindle in these tests: the numbers of docs/threads.md are measured with it."""


def slower(machine: MachineParameters) -> MachineParameters:
    """The same machine with a spindle that needs 4 s to 4000 rpm."""
    spindle = machine.spindles["s"]
    gears = {
        stage: replace(
            gear, max_acceleration=2 * SLOW, acceleration=SLOW, deceleration=SLOW, emergency_deceleration=2 * SLOW
        )
        for stage, gear in spindle.gears.items()
    }
    return replace(machine, spindles={**machine.spindles, "s": replace(spindle, gears=gears)})


LATHE = slower(MACHINE)
HEAD = "%T\nN10 G18 G90 M03 S400\nG00 X36 Z105\n"
"""Three lines: the first line behind it is line 4. The axes stand at X36 Z105."""
Floats = NDArray[np.float64]


def lathe(**changes: Any) -> MachineParameters:
    """Another channel of the lathe; `spindle`, `x`, `z`: other parameters of these."""
    spindle = replace(LATHE.spindles["s"], **changes.pop("spindle", {}))
    axes = {name: replace(axis, **changes.pop(name, {})) for name, axis in LATHE.axes.items()}
    channel = replace(LATHE.channels["channel"], **changes)
    return replace(LATHE, channels={"channel": channel}, spindles={"s": spindle}, axes=axes)


NO_RETRACT = lathe(thread_retract_axis="", thread_retract=0.0)


def cut(text: str, scenario: str = "", machine: MachineParameters = LATHE, head: str = HEAD) -> MachineBench:
    """Runs a program to its end; all axes must stay within their limits."""
    bench = MachineBench(head + text + "\nM30\n", scenario, machine=machine).run()
    assert_within_limits(bench)
    return bench


def column(bench: MachineBench, unit: str, name: str) -> Floats:
    return np.array(bench.column(unit, name), dtype=np.float64)


def assert_within_limits(bench: MachineBench) -> None:
    """Velocity, acceleration and jerk of each axis; and position, velocity and acceleration fit each other."""
    for name, axis in bench.machine.axes.items():
        p, v, a, j = (column(bench, name, f"set_{what}") for what in ("position", "velocity", "acceleration", "jerk"))
        assert abs(v).max() <= max(axis.max_velocity, axis.rapid_velocity) * (1.0 + 1e-9)
        assert abs(a).max() <= max(axis.acceleration, axis.deceleration) * (1.0 + 1e-9)
        assert abs(j).max() <= axis.jerk * (1.0 + 1e-6)
        step = 0.001
        assert abs(np.diff(p) - 0.5 * step * (v[1:] + v[:-1])).max() <= axis.jerk * step**3 / 6.0
        assert abs(np.diff(v)).max() <= axis.acceleration * step * (1.0 + 1e-9)
        assert abs(np.diff(a)).max() <= axis.jerk * step * (1.0 + 1e-6)


class Pass:
    """The cycles of a thread block: way of the axis from its start (mm) and angle of the spindle (deg, + = its way)."""

    def __init__(
        self, bench: MachineBench, line: int, lead: float, *, axis: str = "z", actual: bool = False, sense: int = 1
    ) -> None:
        moving = (column(bench, "channel", "line") == line) & (column(bench, axis, "set_velocity") != 0.0)
        places = column(bench, axis, "actual_position" if actual else "set_position")[moving]
        self.start = column(bench, axis, "set_position")[moving][0]
        self.way = abs(places - round(self.start, 2))
        self.angle = sense * column(bench, "s", "actual_position_deg")[moving]
        self.lead = lead
        self.acceleration = column(bench, "s", "set_acceleration_deg_s2")[moving]

    def phases(self, begin: float, end: float) -> Floats:
        """Angle of the spindle at which the thread begins, as each cycle with a way from `begin` to `end` mm has it."""
        inside = (self.way > begin) & (self.way < end)
        assert inside.sum() > 100
        return self.angle[inside] - self.way[inside] / self.lead * 360.0

    def phase(self, begin: float, end: float) -> float:
        """Their mean, 0 … 360 deg."""
        return float(np.mean(self.phases(begin, end)) % 360.0)

    def error(self, begin: float, end: float) -> float:
        """Largest deviation from the thread that most cycles are on, mm."""
        phases = self.phases(begin, end)
        return float(abs(phases - np.median(phases)).max()) * self.lead / 360.0


def apart(one: float, other: float) -> float:
    """deg from one phase to another, -180 … 180."""
    return (other - one + 180.0) % 360.0 - 180.0


def texts(bench: MachineBench, numbers: Sequence[int] | None = None) -> list[str]:
    """Events with a number; all, or some."""
    events = [event for event in bench.all_events if event.error_id]
    return [f"{e.error_id} {e.text}" for e in events if numbers is None or e.error_id in numbers]
