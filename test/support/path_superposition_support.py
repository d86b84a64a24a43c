"""A mill whose z axis is a conveyor beside the channel's path of x and y, and what is added to that path."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from machine_support import CYCLE_TIME, MILL, MachineBench, machine
from superposition_support import SetpointRow, generator

from cnc_ptp.parameters import MachineParameters
from cnc_ptp.protocol.blocks import Command, CommandRecord

CIRCLE = """%CIRCLE
N10 G01 X20 Y0 F6000
N20 G04 X2
N30 G02 X20 Y0 I-20 J0 F3000
N40 G01 X0 Y0 F6000
N50 M30"""
"""After a dwell of 2 s a full circle of 20 mm around the origin."""


def mill(**units: Any) -> MachineParameters:
    """The channel has x and y; x and z do not end at a soft limit where no test wants them to."""
    ample = {"soft_limit_negative": -5000.0, "soft_limit_positive": 5000.0}
    whole = machine(MILL, **{"x": ample | units.pop("x", {}), "z": ample, **units})
    channel = whole.channels["channel"]
    return replace(whole, channels={"channel": replace(channel, axes=channel.axes[:2])})


class PathBench(MachineBench):
    """Runs until it is stopped; commands go through the PLC, as for a user."""

    def __init__(self, program: str = CIRCLE, scenario: str = "", **units: Any) -> None:
        super().__init__(program, scenario, machine=mill(**units), end_when_idle=False)

    def send(self, unit: str, command: str, **arguments: Any) -> CommandRecord:
        """A command for the next block, which is run; its record."""
        self.units["plc"].input(Command(unit, command, arguments))
        self.run(0.01)
        return next(r for r in reversed(self.records) if (r.target, r.command) == (unit, command))

    def accepted(self, unit: str, command: str, **arguments: Any) -> None:
        record = self.send(unit, command, **arguments)
        assert record.accepted, record.message

    @property
    def cycle(self) -> int:
        """The first one of the next block."""
        return self.offline.runner("x").next_cycle

    def array(self, unit: str, name: str) -> np.ndarray:
        return np.array(self.column(unit, name))

    def added(self, unit: str = "x") -> np.ndarray:
        """What was added to the path in each cycle: axis minus channel, mm."""
        index = ("x", "y").index(unit)
        path = [block.set_position[index * block.count : (index + 1) * block.count] for block in self.blocks["channel"]]
        return self.array(unit, "set_position") - np.concatenate(path)

    def contribution_stands(self, unit: str = "x") -> bool:
        """In the last two cycles nothing more was added to the path, or there is none and the axis is at rest."""
        if not self.last("channel").path_active:
            return self.last(unit).set_velocity[-1] == 0.0
        before, last = self.added(unit)[-2:]
        return abs(last - before) < 1e-12


def profile(bench: PathBench, way: float, velocity: float, *, a: float = 400.0, after: int = 10) -> list[SetpointRow]:
    """Gives x the three phases of the manual's example, from `after` cycles on."""
    rows = generator(way, first_cycle=bench.cycle + after, velocity=velocity, a=a)
    assert bench.give("x", "external_setpoints", setpoints=rows).accepted
    return rows


def expected(rows: list[SetpointRow], cycles: int) -> np.ndarray:
    """The contribution of each cycle to rows that begin at 0: before them 0, after them where they end."""
    return np.interp(np.arange(cycles), [row[0] for row in rows], [row[1] for row in rows])


def assert_no_jump(bench: PathBench, unit: str = "x", *, acceleration: float) -> None:
    """Velocity re-integrated from the acceleration, position from the velocity, however the acceleration steps."""
    p, v = bench.array(unit, "set_position"), bench.array(unit, "set_velocity")
    t = CYCLE_TIME
    assert (np.abs(np.diff(v)) <= acceleration * t * (1.0 + 1e-9) + 1e-9).all()
    way = np.diff(p) - 0.5 * t * (v[1:] + v[:-1])
    assert (np.abs(way) <= 0.25 * acceleration * t * t + 1e-9).all()
