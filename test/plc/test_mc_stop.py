"""MC_Stop holds its unit against everybody: scenario, services, channels; PLCopen: Stopping until Done and not Execute."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from answer_support import AXIS_ROWS, AxisBench, after, on_path, slave
from machine_support import CYCLE_TIME, MILL, PTP, MachineBench, spindle_parameters
from plcopen_support import PlcBench, outputs
from spindle_support import bench_of

from cnc_ptp.plc.plcopen import MC_MoveVelocity, MC_ReadStatus, MC_Stop
from cnc_ptp.plc.program.plc_io import PlcIo
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.blocks import Command
from cnc_ptp.protocol.commands import HELD_OFF

HELD = "MC_Stop of the PLC holds the {} while its execute is true (hold_stop); nothing was changed"


class Plan:
    """Moves a unit at `velocity`, and stops it from the 40th to the 120th cycle."""

    def __init__(self, io: PlcIo, unit: str, kind: str, velocity: float, ramps: dict[str, float]) -> None:
        self.unit = getattr(io, kind)(unit)
        self.move, self.stop, self.status = MC_MoveVelocity(self.unit), MC_Stop(self.unit), MC_ReadStatus(self.unit)
        self.velocity, self.ramps, self.n = velocity, ramps, 0
        self.seen: list[tuple[int, str, int]] = []

    def cycle(self, io: PlcIo) -> None:
        self.move(2 <= self.n < 30, velocity=self.velocity)
        self.stop(40 <= self.n < 120, **self.ramps)
        self.status(True)
        self.seen.append((self.n, outputs(self.stop), self.status.stopping))
        io.done(self.n > 160)
        self.n += 1


def planned(unit: str, kind: str, velocity: float, ramps: dict[str, float]) -> Callable[[PlcIo], Plan]:
    return lambda io: Plan(io, unit, kind, velocity, ramps)


@pytest.mark.parametrize("ramps", [{}, {"deceleration": 5000.0, "jerk": 1e5}], ids=["stop", "own ramp"])
def test_a_scenario_does_not_move_an_axis_that_is_held(ramps: dict[str, float]) -> None:
    scenario = """
- {at: 1.0, to: x, do: move_velocity, velocity: 20.0}
- {at: 1.3, to: x, do: move_absolute, target: 0.0}
"""
    bench = PlcBench(planned("x", "axis", 50.0, ramps), scenario, machine=PTP).run()
    (refused,) = bench.refusals()
    assert refused == f"P-ERR-22165 axis x: move_velocity refused: {HELD.format('axis')}"
    state, velocity = bench.column("x", "state"), bench.column("x", "set_velocity")
    held = range(700, round(1.2 / CYCLE_TIME))
    assert {state[cycle] for cycle in held} == {S.STOPPING} and not any(velocity[cycle] for cycle in held)
    assert state[1210] == S.STANDSTILL and S.DISCRETE_MOTION in state[1300:]
    assert bench.position("x") == 0.0 and not bench.failed
    done = [n for n, told, _ in bench.plc.seen if told == "done"]
    assert done == list(range(done[0], 120)) and done[0] < 70
    assert [n for n, _, stopping in bench.plc.seen if stopping] == list(range(41, 121))


def test_a_spindle_stops_on_its_own_ramp_and_is_held() -> None:
    scenario = "- {at: 1.1, to: s, do: start, direction: cw, speed_rpm: 100.0}"
    bench = PlcBench(planned("s", "spindle", 500.0, {"deceleration": 500.0}), scenario, machine=MILL).run()
    (refused,) = bench.refusals()
    assert refused == f"P-ERR-22165 spindle s: start refused: {HELD.format('spindle')}"
    speed, state = bench.column("s", "set_speed_rpm"), bench.column("s", "state")
    assert max(speed) > 100.0 and not any(speed[1000:])
    assert set(state[1000:1200]) == {S.STOPPING} and state[-1] == S.STANDSTILL
    assert not bench.failed


def test_the_run_ends_while_it_is_held_and_a_plc_that_ends_releases_it() -> None:
    class Endless(Plan):
        def cycle(self, io: PlcIo) -> None:
            self.stop(True)
            io.done(io.cycle > 500)

    bench = PlcBench(lambda io: Endless(io, "x", "axis", 0.0, {}), machine=PTP).run()
    assert bench.column("x", "state")[-1] == S.STOPPING
    bench = PlcBench(lambda io: Endless(io, "x", "axis", 0.0, {}), machine=PTP, end_when_idle=False).run(0.5)
    bench.units["plc"].command(Command("plc", "stop_all"), 500)
    bench.run(0.1)
    assert bench.column("x", "state")[-1] == S.STANDSTILL
    assert bench.give("x", "move_absolute", target=5.0).accepted


def test_plc_and_clients_hold_each_on_their_own() -> None:
    bench = MachineBench(machine=PTP, end_when_idle=False).run(0.05)
    assert bench.give("x", "hold_stop", enabled=True).accepted
    by_client = "P-ERR-22165 axis x: home refused: MC_Stop of {} holds the axis while its execute is true (hold_stop); "
    assert bench.refused("x", "home") == by_client.format("a client") + "nothing was changed"
    bench.units["plc"].input(Command("x", "hold_stop", {"enabled": True}))  # type: ignore[attr-defined]
    bench.run(0.05)
    assert bench.refused("x", "home") == by_client.format("the PLC and a client") + "nothing was changed"
    assert bench.give("x", "jog", velocity=0.0).accepted
    bench.give("x", "hold_stop", enabled=False)
    assert bench.refused("x", "home") == by_client.format("the PLC") + "nothing was changed"
    bench.give("x", "upstream_lost", source="plc")
    assert not bench.units["x"].stop_held


@pytest.mark.parametrize("by_plc", [False, True])
@pytest.mark.parametrize(("unit", "move"), [("x", "home"), ("s", "home")])
def test_a_reset_ends_the_hold_of_clients_and_not_that_of_the_plc(unit: str, move: str, by_plc: bool) -> None:
    """A client that was killed while its MC_Stop held the unit cannot end its hold; an operator can."""
    bench = MachineBench(machine=MILL, end_when_idle=False).run(0.05)
    assert bench.give(unit, "hold_stop", enabled=True).accepted
    assert bench.give(unit, move).error_id == 22165
    if by_plc:
        bench.units["plc"].input(Command(unit, "reset"))  # type: ignore[attr-defined]
        bench.run(0.05)
        reset = next(record for record in bench.records if record.command == "reset")
    else:
        reset = bench.give(unit, "reset")
    kind = "axis" if unit == "x" else "spindle"
    assert reset.message == f"{kind} {unit}: reset ends MC_Stop of a client (hold_stop)"
    assert bench.give(unit, move).accepted
    bench.run(0.05)
    bench.units["plc"].input(Command(unit, "hold_stop", {"enabled": True}))  # type: ignore[attr-defined]
    bench.run(0.05)
    assert bench.give(unit, "reset").accepted and bench.give(unit, move).error_id == 22165


def test_a_reset_of_the_hli_ends_the_hold_of_clients_too() -> None:
    bench = MachineBench(machine=PTP, end_when_idle=False).run(0.05)
    bench.give("x", "hold_stop", enabled=True)
    arguments = {"control_unit": "reset", "enabled": True, "value": 1.0, "holder": "p1"}
    bench.units["plc"].input(Command("x", "overlay", arguments))  # type: ignore[attr-defined]
    bench.run(0.05)
    assert bench.give("x", "home").accepted


@pytest.mark.parametrize("command", sorted(HELD_OFF["axis"]))
def test_each_motion_of_an_axis_that_is_held_is_refused(command: str) -> None:
    bench = AxisBench()
    after("hold_stop", 10, enabled=True)(bench)
    arguments = next(arguments for given, arguments in AXIS_ROWS.values() if given == command)
    record = bench.give(command, **arguments)
    assert record.error_id == 22165 and bench.unit.stop_held


def test_a_path_does_not_move_an_axis_that_is_held() -> None:
    bench = AxisBench()
    after("hold_stop", 10, enabled=True)(bench)
    on_path(bench)
    reason = "the channel moves the path while MC_Stop holds the axis (hold_stop)"
    (error,) = bench.events
    assert (error.error_id, error.text) == (23009, f"axis x: {reason}; the axis stops on its own ramp (ErrorStop)")
    bench = MachineBench("%P\nG01 X10 F1000\nM30", start=False, end_when_idle=False).run(0.05)
    bench.give("x", "hold_stop", enabled=True)
    bench.run(0.05)
    assert "axis x is in Stopping, it must be in Standstill" in bench.refused("channel", "start")


def test_what_somebody_else_moves_is_not_held() -> None:
    for prepare, number in ((on_path, 23005), (slave, 23040)):
        bench = AxisBench()
        prepare(bench)
        assert bench.give("hold_stop", enabled=True).error_id == number and not bench.unit.stop_held
    spindle = bench_of(spindle_parameters(), spindles=("s", "t"))
    spindle.run(10)
    spindle.accepted("couple", master="t")
    spindle.accepted("coupling_answer", granted=True, reason="")
    text = "P-ERR-24022 spindle s: hold_stop refused: the spindle is a slave of t; command t or decouple the spindle"
    assert spindle.refused("hold_stop", enabled=True) == f"{text}; nothing was changed"


def test_a_drive_that_homes_the_axis_is_held_off_too() -> None:
    bench: Any = AxisBench()
    after("hold_stop", 10, enabled=True)(bench)
    assert bench.give("write_drive_parameter", idn="S-0-0148", value=3).error_id == 22165
    assert bench.give("write_drive_parameter", idn="S-0-0044", value=3).error_id != 22165
