"""Cases that a review has found: no circle of masters, no run-away when a coupling ends, gantry pairs in error."""

from __future__ import annotations

from itertools import pairwise

import pytest
from machine_support import PTP, MachineBench, machine

from cnc_ptp.machine.gate import BlockGate
from cnc_ptp.machine.wiring import Inputs
from cnc_ptp.protocol.axis_states import AxisStateCode
from cnc_ptp.protocol.blocks import AxisBlock, CycleTick, PlcBlock

MOVE = "velocity: 2000, acceleration: 5000, deceleration: 5000, jerk: 50000"
S = AxisStateCode


def play(scenario: str, seconds: float | None = None, **changes: dict[str, object]) -> MachineBench:
    return MachineBench(scenario=scenario, machine=machine(PTP, **changes)).run(seconds)


def test_a_refused_decoupling_opens_no_way_to_a_circle() -> None:
    """y stays a slave of x, so x cannot become one of y in the same block."""
    bench = play("""
- {at: 0, to: y, do: couple, master: x, factor: 1}
- {at: 0.1, to: y, do: decouple, target: 1.0e9}
- {at: 0.1, to: x, do: couple, master: y, factor: 1}
""")
    assert [text[:11] for text in bench.refusals()] == ["P-ERR-12000", "P-ERR-23046"]
    assert bench.last("y").master == "x" and bench.last("x").master == ""


@pytest.mark.parametrize(
    "end",
    [
        "{at: 0.25, to: y, do: decouple}",
        "{at: 0.25, to: y, do: decouple, target: 1000}",
        "{at: 0.25, to: y, do: power, enabled: off}",
    ],
)
@pytest.mark.parametrize("factor", [8.0, -4.0])
def test_leaving_a_fast_coupling_while_it_accelerates_is_no_run_away(end: str, factor: float) -> None:
    """The slave's acceleration is |factor| times that of the master; what is left of it is at most the axis' own."""
    bench = play(
        f"""
- {{at: 0, to: y, do: couple, master: x, factor: {factor}}}
- {{at: 0, to: x, do: move_absolute, target: 5000, {MOVE}}}
- {end}
""",
        1.0,
    )
    velocities = [abs(velocity) for velocity in bench.column("y", "set_velocity")]
    growth = 5000.0**2 / (2.0 * 50_000.0)
    assert max(velocities[250:]) <= velocities[250] + growth + 1e-6 <= 10_000.0
    if "power" in end:
        bench.run(5.0)
        assert bench.last("y").set_velocity[-1] == 0.0


def test_an_inward_acceleration_does_not_reverse_the_axis() -> None:
    """A cyclic slave that brakes with more than its own jerk takes out in time stops without running backwards."""
    bench = play(
        f"""
- {{at: 0, to: y, do: couple_cyclic, master: x, acc_bound: 50000}}
- {{at: 0, to: x, do: move_absolute, target: 5000, {MOVE}}}
- {{at: 0.1, to: y, do: set_cyclic_factor, factor: 0.5}}
- {{at: 0.7, to: y, do: set_cyclic_factor, factor: 0.0}}
- {{at: 0.71, to: y, do: decouple}}
""",
        1.5,
    )
    assert min(bench.column("y", "set_velocity")) >= -1e-6


GANTRY = f"""
- {{at: 0, to: y, do: couple_gantry, master: x, difference_limit: 3}}
- {{at: 0.1, to: x, do: move_absolute, target: 5000, {MOVE}}}
"""


def test_a_torn_gantry_pair_stops_at_once_whatever_the_delay_of_errors() -> None:
    delayed = {"error_propagation_delayed": True, "error_propagation_delay": 5.0}
    bench = play(GANTRY, 3.0, x=delayed, y={"kv": 200.0, **delayed})
    errors = bench.column("y", "error_id")
    torn = next(cycle for cycle, error in enumerate(errors) if error)
    master = bench.column("x", "error_id")
    assert next(cycle for cycle, error in enumerate(master) if error) <= torn + 20
    for axis in ("x", "y"):
        assert bench.last(axis).state[-1] == S.ERROR_STOP and bench.last(axis).set_velocity[-1] == 0.0
    assert bench.position("x") == pytest.approx(bench.position("y"), abs=1e-9)


def test_a_channel_may_not_move_a_slave() -> None:
    """Coupled in the very block in which the program starts: an error, not a wrong contour."""
    bench = MachineBench(
        "%P\nN10 G01 X20 Y20 F3000\nM30",
        '- {at: 0.5, to: "y", do: couple, master: z, factor: 1}\n- {at: 0.5, to: channel, do: start}',
        start=False,
    ).run(3.0)
    assert bench.failed
    assert any("the channel moves the path while the axis is a slave" in text for text in bench.errors())


def test_enabling_and_starting_a_pushed_master_does_not_throw_its_slave() -> None:
    """x is moved without enable; when it counts from there again and starts in the same block, y continues smoothly."""
    bench = MachineBench(scenario='- {at: 0, to: "y", do: couple, master: x, factor: 1}', machine=PTP)
    bench.run(0.1)
    bench.give("x", "power", enabled=False)
    bench.run(0.1)
    drive = bench.units["x"]._loop.drive  # type: ignore[attr-defined]
    drive._true_position += 60.0
    drive.step(0.0)
    bench.run(0.1)
    bench.give("x", "power", enabled=True)
    bench.give("x", "move_relative", distance=10.0, velocity=100.0)
    bench.run(1.0)
    positions = bench.column("y", "set_position")
    assert max(abs(b - a) for a, b in pairwise(positions)) < 0.2
    assert positions[-1] == pytest.approx(10.0, abs=1e-9)


def axis_block(first_cycle: int) -> AxisBlock:
    return AxisBlock(first_cycle, 10, *([0.0] * 10 for _ in range(15)), *([0] * 10 for _ in range(3)))


def test_the_gate_keeps_blocks_of_a_master_that_come_before_they_are_needed() -> None:
    gate = BlockGate(Inputs(upstream=("plc",), feedback=()))
    for cycle in (0, 10):
        gate.add_master_block("x", axis_block(cycle))
    gate.add_tick(CycleTick(0, 10))
    gate.add_block("plc", PlcBlock(0, 10))
    assert gate.begin() is not None and gate.opened
    gate.follow("x")
    tick, inputs = gate.complete() or (None, {})
    assert tick == (0, 10) and inputs["x"].first_cycle == 0
    gate.follow(None)
    gate.add_tick(CycleTick(10, 10))
    gate.add_block("plc", PlcBlock(10, 10))
    assert gate.begin() is not None and gate.complete() is not None
    gate.add_master_block("x", axis_block(20))
    gate.add_tick(CycleTick(20, 10))
    gate.add_block("plc", PlcBlock(20, 10))
    assert gate.begin() is not None
    gate.follow("x")
    assert gate.complete() is not None


def test_the_gate_waits_for_the_master_and_notices_a_skipped_block() -> None:
    gate = BlockGate(Inputs(upstream=("plc",), feedback=()))
    gate.add_tick(CycleTick(0, 10))
    gate.add_block("plc", PlcBlock(0, 10))
    gate.begin()
    gate.follow("x")
    assert gate.missing() == ["x"] and gate.skipped() == [] and gate.complete() is None
    gate.add_master_block("x", axis_block(10))
    assert gate.skipped() == ["x"]
    gate.drop("x")
    assert gate.complete() is not None
