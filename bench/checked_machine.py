"""An offline machine that is commanded from outside; after each command and block its invariants are looked at.

- a refusal that says that nothing was changed leaves the state of all units as it was, bit by bit; after others
  it is in ErrorStop,
- setpoints are finite, ErrorStop and an error number go together, without power there is no job,
- a path has one owner, nobody is led by nobody, and an axis in ErrorStop brakes, or follows its master.
"""

from __future__ import annotations

import marshal
import math
import random
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from typing import Any

from cnc_ptp.axis.axis_unit import AxisUnit
from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.runner import UnitRunner
from cnc_ptp.machine.wiring import build_units, unit_kinds
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, Command, CommandRecord, SpindleBlock
from cnc_ptp.protocol.unit import A_CLIENT, PLC, Unit
from cnc_ptp.spindle.spindle_unit import SpindleUnit
from cnc_ptp.state.machine_state import StateStore

UNCHANGED = ("nothing was changed", "nothing was executed", "nothing was started")
"""What a refusal says that leaves everything as it was."""
WITHOUT_REFERENCES = 2
"""Version of marshal in which it does not count who else holds a value."""
WHOLE = 0.1
"""Share of commands after whose refusal all units are compared; after the others the one that refused."""


class Checks:
    """What must hold for all blocks; `violations` has what did not."""

    def __init__(self) -> None:
        self.violations: list[str] = []

    def require(self, holds: bool, text: str) -> None:
        if not holds:
            self.violations.append(text)

    def check_block(self, name: str, block: Any) -> None:
        """Setpoints are finite; error and ErrorStop go together; without power there is no job."""
        if not isinstance(block, (AxisBlock, SpindleBlock)):
            return
        self.require(all(map(math.isfinite, setpoints(block))), f"{name} has a setpoint that is not finite")
        for state, error in zip(block.state, block.error_id, strict=True):
            self.require(
                (state == S.ERROR_STOP) == (error != 0) or self.is_pair(block), f"{name} {state} error {error}"
            )
        self.require(block.state[-1] != S.DISABLED or not block.job, f"{name} without power has job {block.job}")

    def is_pair(self, block: Any) -> bool:
        """A gantry slave in error follows its master to the end."""
        return isinstance(block, AxisBlock) and bool(block.master)

    def check_owners(self, blocks: Mapping[str, Any]) -> None:
        """No axis is on two paths; one in SynchronizedMotion has a master or a path. `blocks` of all units."""
        paths = [block for block in blocks.values() if isinstance(block, ChannelBlock)]
        taken = [axis for block in paths if block.path_active for axis in block.axes]
        self.require(len(taken) == len(set(taken)), f"axes on two paths: {taken}")
        for name, block in blocks.items():
            if not isinstance(block, AxisBlock):
                continue
            if block.state[-1] == S.SYNCHRONIZED_MOTION:
                self.require(bool(block.master) or name in taken, f"{name} is led by nobody")
            if {*block.state} == {S.ERROR_STOP} and block.set_velocity[0] and len({*block.set_velocity}) == 1:
                master = blocks[block.master] if block.master else None
                led = master is not None and any(master.set_velocity)
                self.require(led, f"{name} does not brake in ErrorStop, at {block.set_velocity[0]:g}")


class CheckedMachine(Checks):
    """A new machine."""

    def __init__(self, machine: MachineParameters) -> None:
        super().__init__()
        self.machine = machine
        self.units: Mapping[str, Unit] = build_units(machine, end_when_idle=False)
        self.offline = OfflineMachine(machine, self.units)
        self.kinds = unit_kinds(machine)
        self._store = StateStore(machine)
        self._chance = random.Random(0)

    @property
    def plc(self) -> PlcUnit:
        unit = self.units[PLC]
        assert isinstance(unit, PlcUnit)
        return unit

    def command(self, command: Command, *, looked_at: bool = True) -> CommandRecord:
        """One command between two blocks; if it is looked at, what a refusal changes is a violation."""
        if not looked_at:
            return self.offline.runner(command.target).command(command)
        look = self.content if self._chance.random() < WHOLE else partial(self.unit_content, command.target)
        before, left = look(), Record(self.units[command.target])
        record = self.offline.runner(command.target).command(command)
        if record.accepted:
            return record
        said = f"{command.target} {command.command} {command.arguments}: {record.message}"
        if any(text in record.message for text in UNCHANGED):
            with left.taken_away():
                after = look()
            self.require(bits(before) == bits(after), f"a refusal has changed something: {said}")
        else:
            self.require("ErrorStop" in record.message, said)
        return record

    def tick(self) -> Mapping[str, Any]:
        """The outputs of the next block."""
        outputs = self.offline.tick()
        blocks = {name: output.block for name, output in outputs.items()}
        for name, block in blocks.items():
            self.check_block(name, block)
        self.check_owners(blocks)
        return outputs

    def state(self) -> bytes:
        """All units as bytes."""
        self._bring_up_to_date()
        return self._store.encode(self.offline, with_plc=True)

    def content(self) -> list[Any]:
        """What all units hold (state/machine_state.py)."""
        self._bring_up_to_date()
        return self._store.content_of_units(self.offline.next_cycle, *self.offline.parts)

    def unit_content(self, name: str) -> list[Any]:
        """What one unit holds."""
        return content_of(self._store, self.offline.runner(name), self.offline.next_cycle)

    def _bring_up_to_date(self) -> None:
        for unit in self.units.values():
            bring_up_to_date(unit, self.offline.next_cycle)

    def twin(self, state: bytes) -> OfflineMachine:
        """Another machine with a state of this one."""
        offline = OfflineMachine(self.machine, build_units(self.machine, end_when_idle=False))
        restored = self._store.restore(state)
        offline.go_on_from(restored.next_cycle, restored.runners, restored.blocks)
        return offline


def content_of(store: StateStore, runner: UnitRunner, cycle: int) -> list[Any]:
    """What a unit holds; `cycle`: the next one."""
    bring_up_to_date(runner.unit, cycle)
    return store.content_of_units(runner.next_cycle, {runner.unit.name: runner}, {})


def bits(value: Any) -> bytes:
    """The same for what is equal to the bit. Raises ValueError for anything but plain lists, numbers and texts."""
    return marshal.dumps(value, WITHOUT_REFERENCES)


def bring_up_to_date(unit: Unit, cycle: int) -> None:
    """What a look at a unit does, which is no change."""
    forget_last_command(unit)
    if isinstance(unit, AxisUnit):
        unit._axis.setpoint(cycle)


def forget_last_command(unit: Unit) -> None:
    """What it keeps from one command to the next for its record alone."""
    unit._warning, unit._warning_id, unit._values, unit._given_by = "", 0, {}, A_CLIENT


def setpoints(block: AxisBlock | SpindleBlock) -> list[float]:
    """Positions and velocities of a block."""
    if isinstance(block, AxisBlock):
        return [*block.set_position, *block.set_velocity]
    return [*block.set_position_deg, *block.set_speed_rpm]


class Record:
    """What a refused command leaves in its unit: record and event; in a spindle also its number and its answer."""

    def __init__(self, unit: Unit) -> None:
        """Before the command is given."""
        self._unit, self._events, self._records = unit, len(unit.events), len(unit.records)
        self._of_spindle = self._spindle()

    def _spindle(self) -> tuple[Any, ...]:
        unit = self._unit
        if not isinstance(unit, SpindleUnit):
            return ()
        return unit.next_number, unit._job_given, unit._turned_down, [*unit._refused]

    def _put(self, of_spindle: tuple[Any, ...]) -> None:
        if isinstance(self._unit, SpindleUnit):
            unit = self._unit
            unit.next_number, unit._job_given, unit._turned_down, unit._refused[:] = of_spindle

    @contextmanager
    def taken_away(self) -> Iterator[None]:
        """For a while the unit does not have it."""
        unit, now = self._unit, self._spindle()
        records, unit.records[self._records :] = unit.records[self._records :], []
        told, unit.events[self._events :] = unit.events[self._events :], []
        self._put(self._of_spindle)
        yield
        self._put(now)
        unit.records.extend(records)
        unit.events.extend(told)
