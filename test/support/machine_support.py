"""Units and whole machines on the bench, and an independent check that setpoints are smooth."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from error_support import Refused, refusal_of

from cnc_ptp.axis.axis_unit import AxisUnit
from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.runner import UnitRunner
from cnc_ptp.machine.wiring import build_units, unit_kinds
from cnc_ptp.parameters import AxisParameters, GearParameters, MachineParameters, SpindleParameters, read_machine
from cnc_ptp.parameters.view.control_view import ControlParameters
from cnc_ptp.plc.scenario import Entry, parse_scenario
from cnc_ptp.protocol.blocks import AxisBlock, Command, CommandRecord, CycleBlock, CycleTick, Event
from cnc_ptp.protocol.commands import COMMANDS, INTERNAL
from cnc_ptp.protocol.unit import Unit
from cnc_ptp.spindle.spindle_unit import SpindleUnit

ROOT = Path(__file__).parents[2]
MILL = read_machine(ROOT / "config" / "mill.yaml")
PTP = read_machine(ROOT / "config" / "ptp.yaml")
CYCLE_TIME = 0.001
AXIS_COMMANDS = ", ".join(sorted(COMMANDS["axis"].keys() - INTERNAL))
"""What an axis tells somebody who asks for something else."""


class UnitBench:
    """One unit alone: commands between blocks, the cycles of all blocks as columns."""

    def __init__(self, unit: Unit, *, count: int = 10) -> None:
        self.unit = unit
        self.runner = UnitRunner(unit, watchdog_cycles=200)
        self.count = count
        self.blocks: list[Any] = []
        self.events: list[Event] = []

    @property
    def cycle(self) -> int:
        """The cycle at which the next command acts."""
        return self.runner.next_cycle

    def give(self, command: str, **arguments: Any) -> CommandRecord:
        return self.runner.command(Command(self.unit.name, command, arguments))

    def accepted(self, command: str, **arguments: Any) -> str:
        """Gives a command that must be accepted; the warning, if any."""
        record = self.give(command, **arguments)
        assert record.accepted, record.message
        return record.message

    def refusal(self, command: str, **arguments: Any) -> Refused:
        """Gives a command that must be refused; number and values."""
        return refusal_of(self.give(command, **arguments))

    def refused(self, command: str, **arguments: Any) -> str:
        """Gives a command that must be refused; "P-ERR-… text"."""
        record = self.give(command, **arguments)
        assert not record.accepted
        return f"P-ERR-{record.error_id} {record.message}"

    def run(self, cycles: int, inputs: Mapping[str, CycleBlock] | None = None) -> None:
        """Blocks of `count` cycles, the last one shorter where it must be."""
        end = self.cycle + cycles
        while self.cycle < end:
            tick = CycleTick(self.cycle, min(self.count, end - self.cycle))
            self.blocks.append(self.runner.compute(tick, inputs or {}))
            self.events += [event for event in self.unit.take_events() if event.severity]

    def column(self, name: str) -> list[Any]:
        return list(chain.from_iterable(getattr(block, name) for block in self.blocks))

    def columns(self) -> dict[str, list[Any]]:
        """What the blocks hold of every cycle; jobs, answers and control units are about commands."""
        lists = [name for name, value in _fields(self.blocks[0]) if isinstance(value, list)]
        return {name: self.column(name) for name in lists if name not in ("job_events", "answers", "control_units")}

    @property
    def last(self) -> Any:
        """The newest block."""
        return self.blocks[-1]

    @property
    def state(self) -> int:
        return int(self.blocks[-1].state[-1])

    def event_texts(self) -> list[str]:
        return [f"P-ERR-{event.error_id} {event.text}" for event in self.events]


def _fields(block: CycleBlock) -> Iterable[tuple[str, Any]]:
    return ((name, getattr(block, name)) for name in type(block).__dataclass_fields__)


def changed_control(control: ControlParameters, changes: dict[str, Any]) -> ControlParameters:
    """Other parameters of a control loop by short names, which are taken out of `changes`."""

    def taken(**names: str) -> dict[str, Any]:
        return {name: changes.pop(short) for name, short in names.items() if short in changes}

    if "following_error_monitoring" in changes:
        changes["monitoring"] = 4 if changes.pop("following_error_monitoring") else 0
    limits = {"moving_limit": "following_error_limit", "standstill_limit": "standstill_limit"}
    monitoring = replace(control.monitoring, **taken(kind="monitoring", dynamic="dynamic", **limits))
    plant = taken(time_constant="drive_time_constant", encoder_increment="encoder_increment")
    if "kv" in changes:
        plant["kv"] = changes["kv"]
    return replace(
        control,
        **taken(kv="kv", modulo_error="modulo_error", feedforward="feedforward"),
        monitoring=monitoring,
        drive=replace(control.drive, **taken(reverse="reversed")),
        scaling=replace(control.scaling, **taken(analogue="digits_per_deg_s")),
        plant=replace(control.plant, **plant),
    )


def changed(parameters: AxisParameters, **changes: Any) -> AxisParameters:
    """Other parameters of an axis, those of its control loop by their short names too."""
    shared = {name: changes[name] for name in ("encoder_increment", "start_position") if name in changes}
    control = changed_control(parameters.control, changes)
    control = replace(control, plant=replace(control.plant, **shared))
    return replace(parameters, **{"control": control} | changes | shared)


def changed_gear(gear: GearParameters, **changes: Any) -> GearParameters:
    """Other parameters of a gear, those of its control loop by their short names too."""
    return replace(gear, **{"control": changed_control(gear.control, changes)} | changes)


def axis_parameters(**changes: Any) -> AxisParameters:
    """The x axis of config/ptp.yaml: ideal drive, V 10000 mm/s, A 5000 mm/s², J 50000 mm/s³, ±100 m."""
    return changed(PTP.axes["x"], **changes)


def axis_bench(*, count: int = 10, **changes: Any) -> UnitBench:
    return UnitBench(AxisUnit(axis_parameters(**changes), cycle_time=CYCLE_TIME), count=count)


def spindle_parameters(**changes: Any) -> SpindleParameters:
    """The spindle of config/mill.yaml: 12000 rpm, A+ 36000 °/s², A- 40000 °/s². Changes of a gear count for all."""
    spindle = MILL.spindles["s"]
    own = {name: changes.pop(name) for name in [*changes] if name in SpindleParameters.__dataclass_fields__}
    stages = sorted({1, own.get("gear", 1)})
    gears = {stage: changed_gear(spindle.gears[1], stage=stage, **changes) for stage in stages}
    return replace(spindle, **{"gears": gears, **own})


def spindle_bench(*, count: int = 10, **changes: Any) -> UnitBench:
    return UnitBench(SpindleUnit(spindle_parameters(**changes), cycle_time=CYCLE_TIME), count=count)


class MachineBench:
    """A whole machine offline: an NC program, a scenario, commands between blocks."""

    def __init__(
        self,
        program: str | None = None,
        scenario: str = "",
        *,
        machine: MachineParameters = MILL,
        start: bool = True,
        end_when_idle: bool = True,
    ) -> None:
        self.machine = machine
        entries = []
        if program is not None:
            entries.append(Entry(0.0, Command("channel", "load", {"program": "test.nc", "text": program})))
            if start:
                entries.append(Entry(0.0, Command("channel", "start", {})))
        entries += parse_scenario(scenario, "test.yaml", unit_kinds(machine))
        entries.sort(key=lambda entry: entry.at)
        self.units = build_units(machine, scenario=entries, end_when_idle=end_when_idle)
        self.offline = OfflineMachine(machine, self.units)
        self.blocks: dict[str, list[Any]] = {name: [] for name in self.units}
        self.events: list[Event] = []
        self.all_events: list[Event] = []
        self.records: list[CommandRecord] = []

    def give(self, unit: str, command: str, **arguments: Any) -> CommandRecord:
        """A command from a service: acts at the first cycle of the next block."""
        return self.offline.runner(unit).command(Command(unit, command, arguments))

    def refusal(self, unit: str, command: str, **arguments: Any) -> Refused:
        """Gives a command that must be refused; number and values."""
        return refusal_of(self.give(unit, command, **arguments))

    def refused(self, unit: str, command: str, **arguments: Any) -> str:
        record = self.give(unit, command, **arguments)
        assert not record.accepted
        return f"P-ERR-{record.error_id} {record.message}"

    def run(self, seconds: float | None = None) -> MachineBench:
        """To the end of the run, or for `seconds` more."""
        if seconds is None:
            for outputs in self.offline.run():
                self._take(outputs)
                assert len(self.blocks["plc"]) < 20_000, "the run does not end"
        else:
            for _ in range(round(seconds / (CYCLE_TIME * self.machine.block_cycles))):
                self._take(self.offline.tick())
        return self

    def _take(self, outputs: Any) -> None:
        for name, output in outputs.items():
            self.blocks[name].append(output.block)
            self.events += [event for event in output.events if event.severity]
            self.all_events += output.events
            self.records += output.records

    def column(self, unit: str, name: str) -> list[Any]:
        return list(chain.from_iterable(getattr(block, name) for block in self.blocks[unit]))

    def last(self, unit: str) -> Any:
        return self.blocks[unit][-1]

    def position(self, unit: str) -> float:
        return float(self.blocks[unit][-1].set_position[-1])

    @property
    def failed(self) -> bool:
        return bool(self.blocks["plc"][-1].run_failed)

    def errors(self) -> list[str]:
        """Texts of the error events in their order."""
        return [f"P-ERR-{event.error_id} {event.text}" for event in self.events if event.severity == 2]

    def events_of(self, unit: str) -> list[Event]:
        """Events with a number, also those that are only for information."""
        return [event for event in self.all_events if event.source == unit and event.error_id]

    def refusals(self) -> list[str]:
        return [f"P-ERR-{record.error_id} {record.message}" for record in self.records if not record.accepted]

    def states(self, unit: str) -> list[int]:
        """The states of a unit in their order, each once in a row."""
        column = self.column(unit, "state")
        return [state for state, before in zip(column, [None, *column], strict=False) if state != before]

    def program_cycles(self) -> int:
        """Cycles in which the channel ran a program (RUNNING, HOLD, WAITING, STOPPED)."""
        return sum(2 <= state <= 5 for state in self.column("channel", "state"))


def machine(source: MachineParameters = MILL, **units: Mapping[str, Any]) -> MachineParameters:
    """The machine with other parameters of some units: machine(x={"kv": 10.0}, channel={...})."""
    changes: dict[str, Any] = {}
    for kind in ("axes", "spindles", "channels"):
        of_kind = getattr(source, kind)
        change = changed if kind == "axes" else replace
        changes[kind] = {name: change(value, **units.get(name, {})) for name, value in of_kind.items()}
    return replace(source, **changes)


def seven_phases(distance: float, v: float, up: float, down: float, j: float) -> list[tuple[float, float]]:
    """(duration, jerk) of the phases of a motion over `distance` > 0 that reaches v: textbook form, ramps apart."""

    def ramp(a: float, sign: float) -> list[tuple[float, float]]:
        if v * j < a * a:
            rise = math.sqrt(v / j)
            return [(rise, sign * j), (rise, -sign * j)]
        return [(a / j, sign * j), (v / a - a / j, 0.0), (a / j, -sign * j)]

    ramps = ramp(up, 1.0), ramp(down, -1.0)
    way = sum(0.5 * v * sum(d for d, _ in phases) for phases in ramps)
    return [*ramps[0], ((distance - way) / v, 0.0), *ramps[1]]


def position_after(phases: Iterable[tuple[float, float]], t: float) -> tuple[float, float, float]:
    """(p, v, a) at t from rest at 0, integrated phase by phase."""
    p = v = a = 0.0
    for duration, j in phases:
        d = min(duration, t)
        p, v, a = p + v * d + a * d**2 / 2 + j * d**3 / 6, v + a * d + j * d**2 / 2, a + j * d
        t -= d
        if t <= 0.0:
            break
    return p, v, a


def assert_smooth(
    p: list[float],
    v: list[float],
    a: list[float],
    *,
    acceleration: float,
    jerk: float,
    cycle_time: float = CYCLE_TIME,
    kinks: bool = False,
) -> None:
    """No step: a changes by at most J·T a cycle; v and p are its integrals, as far as jerks within ±J can bend them.

    In `kinks` that are passed the velocity steps by at most half of J·T².
    """
    t = cycle_time
    step = 0.75 if kinks else 0.25
    p0, v0, a0 = (np.asarray(column[:-1], dtype=float) for column in (p, v, a))
    p1, v1, a1 = (np.asarray(column[1:], dtype=float) for column in (p, v, a))
    checks = (
        ("acceleration", a, a0, acceleration * (1 + 1e-9) + 1e-6),
        ("jerk: acceleration", a, a1 - a0, jerk * t * (1 + 1e-9) + 1e-6),
        ("velocity", v, v1 - v0 - 0.5 * t * (a0 + a1), step * jerk * t * t * (1 + 1e-9) + 1e-9 * (1.0 + abs(v0))),
        (
            "position",
            p,
            p1 - p0 - 0.5 * t * (v0 + v1) + t * t / 12.0 * (a1 - a0),
            (step - 0.2) * jerk * t**3 + 1e-11 * (1.0 + abs(p0)),
        ),
    )
    kept = np.array([abs(found) <= allowed for _, _, found, allowed in checks])
    if not kept.all():
        k = int(kept.all(axis=0).argmin())
        what, column = next(check[:2] for check, held in zip(checks, kept[:, k], strict=True) if not held)
        raise AssertionError(f"{what} in cycle {k}: {column[k]} -> {column[k + 1]}")


def assert_axes_smooth(bench: MachineBench) -> None:
    """`assert_smooth` for the axes of the channel, with their own limits."""
    for axis in bench.machine.channels["channel"].axes:
        parameters = bench.machine.axes[axis.node]
        columns = [bench.column(axis.node, f"set_{what}") for what in ("position", "velocity", "acceleration")]
        largest = max(parameters.acceleration, parameters.deceleration)
        assert_smooth(*columns, acceleration=largest, jerk=parameters.jerk * (1.0 + 1e-6))


def assert_axis_smooth(
    bench: UnitBench | list[AxisBlock], *, acceleration: float, jerk: float, kinks: bool = False
) -> None:
    """`assert_smooth` for the set values of all blocks of an axis."""
    blocks = bench.blocks if isinstance(bench, UnitBench) else bench
    p, v, a = (
        list(chain.from_iterable(getattr(block, f"set_{name}") for block in blocks))
        for name in ("position", "velocity", "acceleration")
    )
    assert_smooth(p, v, a, acceleration=acceleration, jerk=jerk, kinks=kinks)
