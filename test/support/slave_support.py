"""Machines with slave axes on the bench, and the relation that a slave must keep in every cycle."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
from error_support import Refused, refusal_of
from machine_support import PTP, MachineBench, changed

from cnc_ptp.axis.coupling import Coupling
from cnc_ptp.motion.setpoints import MotionState, Setpoints
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.protocol.blocks import Command, CommandRecord

A, J = 5000.0, 50_000.0
"""Acceleration and jerk of all linear axes of config/ptp.yaml."""
D = "velocity: 2000, acceleration: 5000, deceleration: 5000, jerk: 50000"
DYNAMICS = {"velocity": 2000.0, "acceleration": 5000.0, "deceleration": 5000.0, "jerk": 50_000.0}
COMPENSATION = {
    "length": 5000.0,
    "difference": 500.0,
    "process_velocity": 2000.0,
    "velocity_increase": 300.0,
    "acceleration": 500.0,
    "deceleration": 1000.0,
}
"""The manual's example of TX1250 3.2.4."""
PROTECTED, DELAYED, STOPPED, HAS_JOB = 1 << 5, 1 << 6, 1 << 7, 1 << 8
COMPENSATING, ERROR = 1 << 13, 1 << 31


def follow(coupling: Coupling, position: float, master: Iterable[MotionState]) -> list[MotionState]:
    """The states of a slave for those of its master."""
    return coupling.follow(position, Setpoints.of(master)).states()


class SlaveBench(MachineBench):
    """A machine without channel that runs until it is stopped; commands go through the PLC, as for a user."""

    def __init__(self, scenario: str = "", *, machine: MachineParameters = PTP, end_when_idle: bool = False) -> None:
        super().__init__(None, scenario, machine=machine, end_when_idle=end_when_idle)

    def tick(self) -> None:
        """One block."""
        self._take(self.offline.tick())

    def send(self, unit: str, command: str, **arguments: Any) -> CommandRecord:
        """A command for the next block through the PLC, which completes couplings; runs that block."""
        return self.send_all([(unit, command, arguments)])[0]

    def send_all(self, commands: Iterable[tuple[str, str, dict[str, Any]]]) -> list[CommandRecord]:
        """Commands for the same block; runs until all are answered. The records in the order of the commands."""
        wanted = [Command(unit, command, arguments) for unit, command, arguments in commands]
        for command in wanted:
            self.units["plc"].input(command)
        before = len(self.records)
        self.tick()
        while self.units["plc"]._outgoing:
            self.tick()
        news = self.records[before:]
        answers = []
        for command in wanted:
            answers.append(next(r for r in news if (r.target, r.command) == (command.target, command.command)))
            news.remove(answers[-1])
        return answers

    def do(self, unit: str, command: str, **arguments: Any) -> str:
        """Sends a command that must be accepted; its warning."""
        record = self.send(unit, command, **arguments)
        assert record.accepted, record.message
        return record.message

    def denial(self, unit: str, command: str, **arguments: Any) -> Refused:
        """Sends a command that must be refused; number and values."""
        return refusal_of(self.send(unit, command, **arguments))

    def denied(self, unit: str, command: str, **arguments: Any) -> str:
        """Sends a command that must be refused; "P-ERR-… text"."""
        record = self.send(unit, command, **arguments)
        assert not record.accepted
        return f"P-ERR-{record.error_id} {record.message}"

    def values(self, unit: str, name: str = "set_position") -> np.ndarray:
        return np.array(self.column(unit, name), dtype=float)

    def bits(self, unit: str, bit: int) -> np.ndarray:
        return np.array(self.column(unit, "status_bits")) & bit != 0

    def state(self, unit: str) -> int:
        return int(self.last(unit).state[-1])

    @property
    def cycle(self) -> int:
        """The cycle at which the next command acts."""
        return sum(block.count for block in self.blocks["plc"])

    def settle(self, seconds: float = 20.0) -> SlaveBench:
        """Until all axes are at a standstill for 0.1 s."""
        for _ in range(round(seconds * 10)):
            self.run(0.1)
            if all(not any(self.last(axis).set_velocity) for axis in self.machine.axes):
                return self
        raise AssertionError("the axes do not come to rest")


def axes_named(*names: str, block_cycles: int = 10, **changes: Any) -> MachineParameters:
    """A machine of equal linear axes in this order (those of config/ptp.yaml), with the given changes."""
    axes = {name: changed(PTP.axes["x"], name=name, **changes) for name in names}
    return replace(PTP, axes=axes, block_cycles=block_cycles)


def assert_linear(
    bench: SlaveBench,
    master: str,
    slave: str,
    factor: float,
    offset: float = 0.0,
    *,
    begin: int = 0,
    end: int | None = None,
) -> None:
    """Slave = factor · master + offset to 1e-9 mm, and velocity and acceleration as well, in every cycle."""
    part = slice(begin, end)
    for name, constant, slack in (("position", offset, 1e-9), ("velocity", 0.0, 1e-8), ("acceleration", 0.0, 1e-7)):
        of_master, of_slave = bench.values(master, f"set_{name}")[part], bench.values(slave, f"set_{name}")[part]
        assert len(of_slave) and np.abs(factor * of_master + constant - of_slave).max() <= slack, name
