"""Control units of the HLI on the bench: units alone, and what they report."""

from __future__ import annotations

from typing import Any

from machine_support import CYCLE_TIME, MILL, UnitBench, axis_bench, spindle_bench

from cnc_ptp.channel.channel_unit import ChannelUnit
from cnc_ptp.plc.hli.messages import ControlMessage
from cnc_ptp.protocol.blocks import CommandRecord, ControlUnitState
from cnc_ptp.protocol.control_units import CONTROL_UNITS


def channel_bench() -> UnitBench:
    parameters = MILL.channels["channel"]
    return UnitBench(ChannelUnit(parameters, axes=MILL.axes, spindles=MILL.spindles, cycle_time=CYCLE_TIME))


BENCHES = {"axis": axis_bench, "spindle": spindle_bench, "channel": channel_bench}


class HliBench:
    """A unit whose control units a PLC `p1` serves."""

    def __init__(self, kind: str, **changes: Any) -> None:
        self.kind = kind
        self.bench = BENCHES[kind](**changes)
        self.known: dict[str, ControlUnitState] = {}
        self.run()

    @property
    def name(self) -> str:
        return self.bench.unit.name

    def run(self, cycles: int = 10) -> Any:
        """The last block of so many cycles."""
        before = len(self.bench.blocks)
        self.bench.run(cycles)
        for block in self.bench.blocks[before:]:
            self.known |= {state.name: state for state in block.control_units}
        return self.bench.last

    def ask(self, command: str, **arguments: Any) -> CommandRecord:
        """What others ask for."""
        record = self.bench.give(command, **arguments)
        self.run()
        return record

    def serve(
        self, control_unit: str, value: float = 0.0, holder: str = "p1", *, silent: bool = False
    ) -> CommandRecord:
        arguments = {"silent": True} if silent else {}
        return self.ask("overlay", control_unit=control_unit, enabled=True, value=value, holder=holder, **arguments)

    def give_back(self, control_unit: str) -> CommandRecord:
        return self.ask("overlay", control_unit=control_unit, enabled=False)

    def state(self, control_unit: str) -> tuple[bool, float, float]:
        """Served, request and state, as the unit has reported them."""
        known = self.known[control_unit]
        return known.held, known.request, known.state


AXIS = {
    "semaphore": 1, "type": 3, "position": 12.5, "velocity": 0.0, "acceleration": 0.0, "deceleration": 0.0, "jerk": 0.0,
    "activation_position": 0.0, "factor": 0.0, "weight": 0.0, "master": 0, "buffer_mode": 0,
}  # fmt: skip
SPINDLE = {
    "semaphore": 1, "type": 2, "speed": 600.0, "position": 90.0, "direction": 0, "gear": 2, "min_speed": 0.0,
    "acceleration": 0.0, "factor_num": 0.0, "factor_den": 0.0, "weight": 0.0, "master": 0,
}  # fmt: skip
"""External commands: to 12.5 mm; M03 at 600 rpm."""


def message(
    kind: str = "axis", source: str = "p1", sequence: int = 0, *, valid: bool = True, **units: float | None
) -> ControlMessage:
    """A message that serves the control units that are given; `external`, `functions`, `done`: the rest."""
    external = units.pop("external", None) or {}
    functions, done = units.pop("functions", False), units.pop("done", ())
    served = {
        unit.name: (units.get(unit.name) is not None, units.get(unit.name) or 0.0) for unit in CONTROL_UNITS[kind]
    }
    return ControlMessage(source, sequence, valid, served, external, bool(functions), tuple(done))  # type: ignore[arg-type]
