"""Function blocks on the motions of an axis that take over, wait, blend and add up: outputs, and where the axis ends."""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import Any

import pytest
from long_support import long
from machine_support import PTP, assert_axis_smooth
from plcopen_support import PlcBench, outputs

from cnc_ptp.plc.plcopen import (
    MC_Halt,
    MC_MoveAbsolute,
    MC_MoveAdditive,
    MC_MoveModulo,
    MC_MoveRelative,
    MC_MoveSuperimposed,
    MC_MoveVelocity,
    MC_SetPosition,
    MC_Stop,
)
from cnc_ptp.protocol.axis_states import AxisStateCode as S

Plan = Callable[[int], dict[str, dict[str, Any]]]
DYNAMICS = {"velocity": 1000.0, "acceleration": 5000.0, "deceleration": 5000.0, "jerk": 50000.0}


class Blocks:
    """A PLC of one axis with blocks by name; `plan(n)` gives the inputs of each in the n-th PLC cycle."""

    def __init__(self, io: Any, blocks: dict[str, type], plan: Plan) -> None:
        self.blocks = {name: block_type(io.axis("x")) for name, block_type in blocks.items()}
        self._plan = plan
        self.n = 0
        self.seen: list[dict[str, str]] = []
        self.states: list[int] = []

    def cycle(self, io: Any) -> None:
        for name, inputs in self._plan(self.n).items():
            self.blocks[name](**inputs)
        self.seen.append({name: outputs(block) for name, block in self.blocks.items()})
        self.states.append(int(io.axis("x").state))
        self.n += 1

    def told(self, name: str) -> list[str]:
        """The outputs of a block in their order, each once in a row."""
        column = [seen[name] for seen in self.seen]
        return [told for told, before in zip(column, [None, *column], strict=False) if told != before]


def run(blocks: dict[str, type], plan: Plan, cycles: int = 250) -> tuple[PlcBench, Blocks]:
    bench = PlcBench(lambda io: Blocks(io, blocks, plan)).run(0.01 * cycles)
    assert not bench.failed, bench.errors()
    return bench, bench.plc


TWO = {"first": MC_MoveAbsolute, "second": MC_MoveAbsolute}


def two(mode: str, **second: Any) -> Plan:
    """The first moves to 500 mm from cycle 10, the second is given in cycle 40, in motion at full velocity."""
    inputs = {"position": 800.0, "buffer_mode": mode, **DYNAMICS, **second}
    return lambda n: {
        "first": {"execute": n >= 10, "position": 500.0, **DYNAMICS},
        "second": {"execute": n >= 40, **inputs},
    }


def test_an_aborting_motion_takes_over() -> None:
    bench, plc = run(TWO, two("aborting", position=-100.0))
    assert plc.told("first") == ["", "busy", "busy active", "command_aborted"]
    assert plc.told("second") == ["", "busy", "busy active", "done"]
    assert plc.seen[41] == {"first": "command_aborted", "second": "busy active"}
    assert bench.position("x") == -100.0 and max(bench.column("x", "set_position")) < 500.0
    assert_axis_smooth(bench.blocks["x"], acceleration=5000.0, jerk=50000.0)


def test_a_buffered_motion_begins_where_the_first_has_ended() -> None:
    bench, plc = run(TWO, two("buffered"))
    assert plc.told("first") == ["", "busy", "busy active", "done"]
    assert plc.told("second") == ["", "busy", "busy active", "done"]
    done = next(n for n, seen in enumerate(plc.seen) if seen["first"] == "done")
    assert plc.seen[done - 1]["second"] == "busy" and "busy" in plc.seen[done]["second"]
    positions, velocities = bench.column("x", "set_position"), bench.column("x", "set_velocity")
    at_500 = [velocity for position, velocity in zip(positions, velocities, strict=True) if position == 500.0]
    assert 0.0 in at_500 and bench.position("x") == 800.0


@pytest.mark.parametrize(
    ("mode", "velocity"),
    [("blending_low", 400.0), ("blending_previous", 1000.0), ("blending_next", 400.0), ("blending_high", 1000.0)],
)
def test_a_blended_motion_passes_the_first_target_at_its_velocity(mode: str, velocity: float) -> None:
    bench, plc = run(TWO, two(mode, velocity=400.0))
    positions, velocities = bench.column("x", "set_position"), bench.column("x", "set_velocity")
    passing = next(n for n, position in enumerate(positions) if position >= 500.0)
    step = 50000.0 * 0.001**2 / 2.0 + 5000.0 * 0.001  # what a cycle can change
    assert velocities[passing] == pytest.approx(velocity, abs=step)
    assert plc.told("first")[-1] == "done" and plc.told("second")[-1] == "done" and bench.position("x") == 800.0
    assert_axis_smooth(bench.blocks["x"], acceleration=5000.0, jerk=50000.0)


def test_a_waiting_motion_is_aborted_with_the_active_one_by_a_stop() -> None:
    blocks = {**TWO, "stop": MC_Stop}

    def plan(n: int) -> dict[str, dict[str, Any]]:
        return {**two("buffered")(n), "stop": {"execute": n >= 50}}

    bench, plc = run(blocks, plan)
    assert plc.told("first")[-1] == plc.told("second")[-1] == "command_aborted"
    assert plc.told("stop") == ["", "busy", "busy active", "done"]
    assert "busy active" not in plc.told("second") and bench.position("x") < 500.0


def test_additive_counts_from_the_target_and_relative_from_where_the_axis_is() -> None:
    def plan(n: int) -> dict[str, dict[str, Any]]:
        return {
            "first": {"execute": n >= 10, "position": 500.0, **DYNAMICS},
            "more": {"execute": n >= 40, "distance": 100.0, **DYNAMICS},
        }

    additive, _ = run({"first": MC_MoveAbsolute, "more": MC_MoveAdditive}, plan)
    relative, _ = run({"first": MC_MoveAbsolute, "more": MC_MoveRelative}, plan)
    assert additive.position("x") == 600.0
    here = relative.column("x", "set_position")[400]
    assert 100.0 < here < 400.0 and relative.position("x") == pytest.approx(here + 100.0, abs=1e-9)


def test_velocity_is_reached_and_taken_over_by_a_halt() -> None:
    seen: list[bool] = []

    def plan(n: int) -> dict[str, dict[str, Any]]:
        return {
            "move": {"execute": n >= 10, "velocity": -300.0, "acceleration": 2000.0, "jerk": 20000.0},
            "halt": {"execute": n >= 100},
        }

    class Watching(MC_MoveVelocity):
        def __call__(self, *arguments: Any, **inputs: Any) -> None:
            super().__call__(*arguments, **inputs)
            seen.append(self.in_velocity)

    bench, plc = run({"move": Watching, "halt": MC_Halt}, plan)
    assert plc.told("move") == ["", "busy", "busy active", "command_aborted"]
    assert plc.told("halt") == ["", "busy", "busy active", "done"]
    # 0.15 s + 0.1 s of ramp; known one block later
    assert 33 <= seen.index(True) <= 37 and all(seen[seen.index(True) : 101]) and not any(seen[101:])
    assert min(bench.column("x", "set_velocity")) == -300.0 and S.CONTINUOUS_MOTION in plc.states


def test_a_velocity_that_is_changed_on_the_fly() -> None:
    def plan(n: int) -> dict[str, dict[str, Any]]:
        return {
            "move": {"execute": n % 50 >= 10 and n < 100, "velocity": 300.0 if n < 50 else -200.0},
            "stop": {"execute": n >= 150},
        }

    bench, plc = run({"move": MC_MoveVelocity, "stop": MC_Stop}, plan)
    velocities = bench.column("x", "set_velocity")
    assert max(velocities) == pytest.approx(300.0) and min(velocities) == pytest.approx(-200.0)
    assert plc.told("move")[-2:] == ["command_aborted", ""] and plc.told("stop")[-1] == "done"
    assert_axis_smooth(bench.blocks["x"], acceleration=5000.0, jerk=50000.0)


def test_a_superimposed_motion_aborts_nothing_and_adds_its_distance() -> None:
    def plan(n: int) -> dict[str, dict[str, Any]]:
        return {
            "first": {"execute": n >= 10, "position": 500.0, **DYNAMICS},
            "added": {"execute": n >= 30, "distance": 40.0, "velocity_difference": 200.0},
        }

    bench, plc = run({"first": MC_MoveAbsolute, "added": MC_MoveSuperimposed}, plan)
    assert plc.told("first") == ["", "busy", "busy active", "done"]
    assert plc.told("added") == ["", "busy", "busy active", "done"]
    assert plc.seen[35] == {"first": "busy active", "added": "busy active"}
    assert bench.position("x") == pytest.approx(540.0, abs=1e-9)


def test_a_second_superimposed_motion_aborts_the_first_and_only_that() -> None:
    """The first has gone about 40 mm of its 400 then: the axis ends 30 mm beyond what it has gone."""

    def plan(n: int) -> dict[str, dict[str, Any]]:
        return {
            "basic": {"execute": n >= 10, "position": 500.0, **DYNAMICS},
            "first": {"execute": n >= 30, "distance": 400.0, "velocity_difference": 200.0},
            "second": {"execute": n >= 60, "distance": 30.0, "velocity_difference": 200.0},
        }

    bench, plc = run({"basic": MC_MoveAbsolute, "first": MC_MoveSuperimposed, "second": MC_MoveSuperimposed}, plan)
    alone, _ = run({"basic": MC_MoveAbsolute}, lambda n: {"basic": plan(n)["basic"]})
    assert plc.told("basic") == ["", "busy", "busy active", "done"]
    assert plc.told("first") == ["", "busy", "busy active", "command_aborted"]
    assert plc.told("second") == ["", "busy", "busy active", "done"]
    assert plc.seen[61] == {"basic": "busy active", "first": "command_aborted", "second": "busy active"}
    covered = bench.column("x", "set_position")[600] - alone.column("x", "set_position")[600]
    assert bench.position("x") == pytest.approx(500.0 + covered + 30.0, abs=1e-9)


def test_at_velocity_0_a_block_is_in_velocity_until_another_aborts_it() -> None:
    class OfX(Blocks):
        def cycle(self, io: Any) -> None:
            super().cycle(io)
            in_velocity.append(self.blocks["zero"].in_velocity)

    in_velocity: list[bool] = []
    plan: Plan = lambda n: {  # noqa: E731
        "move": {"execute": n >= 10, "velocity": 300.0},
        "zero": {"execute": n >= 60, "velocity": 0.0},
        "back": {"execute": n >= 150, "position": 0.0, **DYNAMICS},
    }
    blocks = {"move": MC_MoveVelocity, "zero": MC_MoveVelocity, "back": MC_MoveAbsolute}
    bench = PlcBench(lambda io: OfX(io, blocks, plan)).run(4.0)
    assert bench.plc.told("move") == ["", "busy", "busy active", "command_aborted"]
    assert bench.plc.told("zero") == ["", "busy", "busy active", "command_aborted"]
    assert in_velocity[149] and bench.plc.states[149] == S.CONTINUOUS_MOTION
    assert not in_velocity[61] and not in_velocity[152]
    assert bench.plc.told("back")[-1] == "done" and bench.position("x") == 0.0


def test_a_new_position_is_the_origin_of_what_follows() -> None:
    def plan(n: int) -> dict[str, dict[str, Any]]:
        return {
            "set": {"execute": n >= 10, "position": 1000.0},
            "move": {"execute": n >= 20, "position": 1100.0, **DYNAMICS},
        }

    bench, plc = run({"set": MC_SetPosition, "move": MC_MoveAbsolute}, plan)
    assert plc.told("set") == ["", "busy", "done"]
    positions = bench.column("x", "set_position")
    assert positions[90] == 0.0 and positions[110] == 1000.0 and bench.position("x") == 1100.0
    relative, _ = run(
        {"set": MC_SetPosition}, lambda n: {"set": {"execute": n >= 10, "position": -7.0, "relative": True}}, 20
    )
    assert relative.position("x") == -7.0


def test_a_modulo_axis_is_taken_over_in_motion() -> None:
    class OfC(Blocks):
        def __init__(self, io: Any) -> None:
            super().__init__(io, {}, lambda n: {})
            self.blocks = {name: MC_MoveModulo(io.axis("c")) for name in ("first", "second")}
            self._plan = lambda n: {
                "first": {"execute": n >= 10, "position": 90.0, "velocity": 100.0},
                "second": {"execute": n >= 40, "position": -300.0, "velocity": 100.0, "buffer_mode": "aborting"},
            }

    bench = PlcBench(OfC, machine=PTP).run(8.0)
    assert bench.plc.told("first")[-1] == "command_aborted" and bench.plc.told("second")[-1] == "done"
    assert bench.position("c") % 360.0 == pytest.approx(300.0, abs=1e-9)


ALL: dict[str, type] = {
    "absolute": MC_MoveAbsolute,
    "relative": MC_MoveRelative,
    "additive": MC_MoveAdditive,
    "velocity": MC_MoveVelocity,
    "added": MC_MoveSuperimposed,
    "halt": MC_Halt,
    "stop": MC_Stop,
    "set": MC_SetPosition,
}
MODES = ("aborting", "aborting", "buffered", "blending_low", "blending_previous", "blending_next", "blending_high")


@pytest.mark.parametrize("seed", [*range(2), *long(range(2, 6))])
def test_blocks_in_random_order_on_one_axis(seed: int) -> None:
    """While execute is true one output is; at most one motion is active; all have ended when the axis stands."""
    chance = random.Random(seed)
    execute = dict.fromkeys(ALL, False)

    def plan(n: int) -> dict[str, dict[str, Any]]:
        given: dict[str, dict[str, Any]] = {}
        for name in chance.sample(list(ALL), len(ALL)):
            if n > 250:
                execute[name] = name == "stop" and n < 255
            elif chance.random() < (0.3 if execute[name] else 0.06):
                execute[name] = not execute[name]
            given[name] = {"execute": execute[name], **inputs(name)}
        return given

    def inputs(name: str) -> dict[str, Any]:
        mode, velocity = {"buffer_mode": chance.choice(MODES)}, chance.uniform(50.0, 900.0)
        place = chance.uniform(-800.0, 800.0)
        return {
            "absolute": {"position": place, "velocity": velocity, **mode},
            "relative": {"distance": place, "velocity": velocity, **mode},
            "additive": {"distance": place, "velocity": velocity, **mode},
            "velocity": {"velocity": chance.choice((-1.0, 1.0)) * velocity, **mode},
            "added": {"distance": place / 10.0},
            "set": {"position": place},
        }.get(name, {})

    bench, plc = run(ALL, plan, 400)
    motions = [name for name in ALL if name not in ("added", "set")]
    for n, seen in enumerate(plc.seen):
        for told in seen.values():
            assert told in ("", "busy", "busy active", "done", "command_aborted", "error"), (n, seen)
        assert sum("active" in seen[name] for name in motions) <= 1, (n, seen)
    assert set(plc.seen[-1].values()) == {""}
    records = [record for record in bench.records if record.target == "x"]
    assert len(records) > 30 and sum(record.accepted for record in records) > 15
    assert any("command_aborted" in seen.values() for seen in plc.seen)
