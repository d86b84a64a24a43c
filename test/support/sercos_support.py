"""SERCOS drives and axes on the bench."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import replace
from math import sqrt
from typing import Any

from machine_support import CYCLE_TIME, ROOT, UnitBench

from cnc_ptp.axis.axis_unit import AxisUnit
from cnc_ptp.control.drives import Drive, make_drive
from cnc_ptp.control.drives.sercos import idns
from cnc_ptp.control.drives.sercos.service_channel import ServiceChannel
from cnc_ptp.parameters import AxisParameters, read_machine
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit
from cnc_ptp.protocol.blocks import CycleBlock, CycleTick, Event

EXAMPLE = read_machine(ROOT / "examples" / "sercos.yaml")
START, EDGE, MARK = 85.0, -1.0, -4.0
"""In the machine: the axis at start, the edge of its home switch, the first marker pulse behind it."""
V, A, J = 60.0, 400.0, 8000.0
"""The drive's own motions."""


def sercos_axis(
    *, fault: str = "NONE", parameter_scaling: bool = False, ideal: bool = True, **homing: Any
) -> AxisParameters:
    """The axis of examples/sercos.yaml with another homing; `ideal`: a drive without lag, an encoder without steps.

    Short names: `at` of the start, `acceleration` and `jerk` of the drive, `referenced` at start, `bus_delay`.
    """
    axis = EXAMPLE.axes["x"]
    sercos = axis.control.sercos
    assert sercos is not None
    names = {"acceleration", "jerk"} & homing.keys()
    referenced, at = homing.pop("referenced", False), homing.pop("at", START)
    kind, bus_delay = homing.pop("interface", "velocity"), homing.pop("bus_delay", 0)
    motion = {name: homing.pop(name) for name in names}
    changed = replace(axis.homing, **homing)
    sercos = replace(
        sercos, homing=changed, fault=fault, parameter_scaling=parameter_scaling, referenced=referenced, **motion
    )
    plant = replace(axis.control.plant, start_position=at, bus_delay_cycles=bus_delay)
    drive = replace(axis.control.drive, interface=kind)
    if ideal:
        plant = replace(plant, time_constant=0.0, encoder_increment=0.0)
        drive = replace(drive, ideal=True)
    start = at if referenced else 0.0
    control = replace(axis.control, sercos=sercos, plant=plant, drive=drive)
    return replace(axis, homing=changed, control=control, referenced_at_start=referenced, start_position=start)


class SercosBench(UnitBench):
    """An axis alone that keeps its events of all kinds."""

    def __init__(self, unit: AxisUnit, *, count: int) -> None:
        super().__init__(unit, count=count)
        self.all_events: list[Event] = []

    def run(self, cycles: int, inputs: Mapping[str, CycleBlock] | None = None) -> None:
        end = self.cycle + cycles
        while self.cycle < end:
            tick = CycleTick(self.cycle, min(self.count, end - self.cycle))
            self.blocks.append(self.runner.compute(tick, inputs or {}))
            events = self.unit.take_events()
            self.all_events += events
            self.events += [event for event in events if event.severity]

    @property
    def encoder(self) -> float:
        """Where the axis is in the machine."""
        return float(self.unit._loop.encoder)  # type: ignore[attr-defined]

    @property
    def referenced(self) -> bool:
        return not self.last.status_bits[-1] & StatusBit.NOT_REFERENCED

    def read(self, idn: str) -> int | str:
        record = self.give("read_drive_parameter", idn=idn)
        assert record.message == f"{idn} = {record.values[idn]}"
        return record.values[idn]  # type: ignore[return-value]

    def write(self, idn: str, value: int) -> None:
        assert self.accepted("write_drive_parameter", idn=idn, value=value) == ""


def sercos_bench(*, count: int = 10, **changes: Any) -> SercosBench:
    bench = SercosBench(AxisUnit(sercos_axis(**changes), cycle_time=CYCLE_TIME), count=count)
    bench.run(count)
    return bench


def to_rest(bench: SercosBench, cycles: int = 30_000) -> SercosBench:
    """Until the axis neither homes nor stops, and 50 cycles more."""
    for _ in range(cycles // 10):
        bench.run(10)
        if bench.state not in (S.HOMING, S.STOPPING):
            break
    bench.run(50)
    return bench


def home(bench: SercosBench, **arguments: Any) -> SercosBench:
    assert bench.accepted("home", **arguments) == ""
    return to_rest(bench)


class DriveBench:
    """A SERCOS drive alone, the newest position, velocity and set position of each cycle."""

    def __init__(self, **changes: Any) -> None:
        self.drive: Drive = make_drive(sercos_axis(**changes).control, CYCLE_TIME)
        assert self.drive.service is not None
        self.service: ServiceChannel = self.drive.service
        self.positions = [self.drive.position]
        self.diagnoses: list[str] = []

    def run(self, cycles: int, command: float = 0.0) -> DriveBench:
        for _ in range(cycles):
            self.drive.step(command)
            self.positions.append(self.drive.position)
            text = str(self.service.read(idns.DIAGNOSIS))
            if not self.diagnoses or self.diagnoses[-1] != text:
                self.diagnoses.append(text)
        return self

    def home(self, cycles: int = 10_000) -> DriveBench:
        """To the acknowledgement, or for so many cycles."""
        self.service.write(idns.HOMING, 3)
        for _ in range(cycles):
            if self.answer != 7:
                break
            self.run(1)
        return self

    @property
    def answer(self) -> int:
        return int(self.service.read(idns.HOMING))

    def velocities(self) -> list[float]:
        """Of the positions, cycle by cycle."""
        return [(after - before) / CYCLE_TIME for before, after in itertools.pairwise(self.positions)]


def ramp(velocity: float, acceleration: float, jerk: float) -> tuple[float, float]:
    """Duration and distance of a jerk-limited ramp from rest to `velocity`, textbook form."""
    if velocity * jerk < acceleration**2:
        duration = 2.0 * sqrt(velocity / jerk)
    else:
        duration = velocity / acceleration + acceleration / jerk
    return duration, 0.5 * velocity * duration
