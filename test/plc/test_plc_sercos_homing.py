"""examples/plc_sercos_homing.py (TX1250 4.2): the PLC lets the drive home the axis, and tells the manual's three errors.

`Io` is the least that the file needs of what a PLC in a file sees: references to axes, events, the end of the run.
"""

from __future__ import annotations

import importlib.util
from dataclasses import replace
from typing import Any

import pytest
from machine_support import ROOT, MachineBench, machine
from sercos_support import EXAMPLE

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.blocks import Command, CommandAnswer


class AxisReference:
    """Gives commands through the PLC and finds the answers in the blocks of the axis."""

    def __init__(self, bench: MachineBench) -> None:
        self._bench = bench
        self._given: list[Command] = []

    def give(self, command: str, **arguments: Any) -> int:
        self._given.append(Command("x", command, arguments))
        self._bench.units["plc"].input(self._given[-1])  # type: ignore[attr-defined]
        return len(self._given) - 1

    def answer(self, ticket: int) -> CommandAnswer | None:
        number = self._given[ticket].id
        answers = (answer for block in self._bench.blocks["x"] for answer in block.answers)
        return next((answer for answer in answers if answer.id == number), None) if number else None


class Io:
    def __init__(self, bench: MachineBench) -> None:
        self._axis = AxisReference(bench)
        self.events: list[str] = []
        self.ended = False

    def axis(self, name: str) -> AxisReference:
        assert name == "x"
        return self._axis

    def event(self, text: str) -> None:
        self.events.append(text)

    def done(self) -> None:
        self.ended = True


def run(fault: str = "NONE", *, parameter_scaling: bool = False) -> tuple[MachineBench, Io, Any]:
    control = EXAMPLE.axes["x"].control
    assert control.sercos is not None
    sercos = replace(control.sercos, fault=fault, parameter_scaling=parameter_scaling)
    bench = MachineBench(machine=machine(EXAMPLE, x={"control": replace(control, sercos=sercos)}), end_when_idle=False)
    specification = importlib.util.spec_from_file_location("plc", ROOT / "examples" / "plc_sercos_homing.py")
    assert specification is not None and specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    io = Io(bench)
    plc = module.Plc(io)
    while not io.ended and len(bench.blocks["plc"]) < 2000:
        plc.cycle(io)
        bench.run(0.01)
    bench.run(1.0)
    assert io.ended
    return bench, io, plc


def test_it_homes_and_moves_the_axis() -> None:
    bench, io, plc = run()
    assert plc.error == 0 and io.events == ["x is homed, its reference point is at 100 mm"]
    assert bench.position("x") == 120.0 and bench.errors() == bench.refusals() == []
    # the marker pulse is at -4 mm in the machine
    assert bench.units["x"]._loop.encoder == pytest.approx(120.0 - 104.0, abs=1e-3)  # type: ignore[attr-defined]
    assert bench.states("x") == [S.STANDSTILL, S.HOMING, S.STANDSTILL, S.DISCRETE_MOTION, S.STANDSTILL]


@pytest.mark.parametrize(
    ("fault", "scaled", "text"),
    [
        ("NONE", True, "homing of x: error 16#FFFFFFFF, the drive says: follows its cyclic commands"),
        ("ABORTED", False, "homing of x: error 16#FFFFFFFE, the drive says: excessive position deviation"),
        ("NO_REFERENCE", False, "homing of x: error 16#FFFFFFFD, the drive says: homing is completed"),
    ],
)
def test_it_tells_the_errors_of_the_manual(fault: str, scaled: bool, text: str) -> None:
    bench, io, _ = run(fault, parameter_scaling=scaled)
    assert io.events == [text]
    assert bench.last("x").state[-1] == S.STANDSTILL and bench.errors() == []
