"""examples/homing.*: the axes home, and the program mills where the machine is, not where the encoders counted."""

from __future__ import annotations

from pathlib import Path

import pytest
from machine_support import MachineBench

from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit

EXAMPLES = Path(__file__).parents[2] / "examples"


def place_in_the_machine(bench: MachineBench, axis: str) -> float:
    return float(bench.units[axis]._loop.encoder)


def test_the_program_homes_and_mills() -> None:
    text = (EXAMPLES / "homing.nc").read_text()
    bench = MachineBench(text, machine=read_machine(EXAMPLES / "homing.yaml")).run()
    assert bench.errors() == bench.refusals() == []
    assert [bench.position(axis) for axis in "xyz"] == [50.0, 20.0, -5.0]
    assert [place_in_the_machine(bench, axis) for axis in "xyz"] == pytest.approx([50.0, 20.0, -5.0], abs=2e-3)


def test_the_scenario_homes_without_a_program() -> None:
    scenario = (EXAMPLES / "homing_by_plc.yaml").read_text()
    bench = MachineBench(None, scenario, machine=read_machine(EXAMPLES / "homing.yaml")).run()
    assert bench.errors() == bench.refusals() == []
    for axis in "xyz":
        assert bench.last(axis).state[-1] == S.STANDSTILL
        assert not bench.last(axis).status_bits[-1] & StatusBit.NOT_REFERENCED
        assert bench.position(axis) == pytest.approx(place_in_the_machine(bench, axis), abs=2e-3)
    assert set(bench.column("x", "set_velocity")[5500:5990]) == {0.0}
