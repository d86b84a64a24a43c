"""Function blocks that somebody outside calls, on offline machines: ends, aborts, cancels, refusals that change nothing."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import pytest
from machine_support import MILL, PTP, MachineBench
from plcopen_support import FakeUnit, outputs

from cnc_ptp.errors import CncError
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.plc import plcopen
from cnc_ptp.plc.called_blocks import BlockCall, CalledBlocks
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.plc.plcopen.catalogue import BLOCK_TYPES, OF_AXIS, checked_type
from cnc_ptp.protocol.axis_states import AxisStateCode as S

QUICK = {"velocity": 2000.0, "acceleration": 5000.0, "deceleration": 5000.0, "jerk": 50_000.0}


class Outside(MachineBench):
    """A machine offline, with calls from outside between its blocks."""

    def __init__(self, machine: MachineParameters = PTP) -> None:
        super().__init__(machine=machine, end_when_idle=False)
        plc = self.units["plc"]
        assert isinstance(plc, PlcUnit)
        self.calls = CalledBlocks(unit_kinds(machine), machine.sets, plc.is_lost)
        plc.outside.append(self.calls.cycle)
        self.turn(2)

    def turn(self, blocks: int) -> None:
        self.run(0.01 * blocks)

    def until(self, condition: Callable[[], bool], blocks: int = 1000) -> None:
        for _ in range(blocks):
            if condition():
                return
            self.turn(1)
        raise AssertionError("it has not come true")

    def ended(self, call: BlockCall) -> str:
        """The outputs of a call at its end."""
        self.until(lambda: call.ended)
        return outputs(call.block)

    def start(self, unit: str, name: str, **inputs: Any) -> BlockCall:
        return self.calls.start(unit, name, inputs)

    def now(self, unit: str, field: str) -> Any:
        return getattr(self.last(unit), field)[-1]


@pytest.fixture
def m() -> Outside:
    return Outside()


def test_a_positioning_from_its_start_to_its_end(m: Outside) -> None:
    call = m.start("x", "MC_MoveAbsolute", position=50.0, **QUICK)
    seen = []
    while not call.ended:
        m.turn(1)
        seen.append(outputs(call.block))
    assert [*dict.fromkeys(seen)] == ["busy", "busy active", "done"] and seen[1] == "busy active"
    assert m.now("x", "set_position") == 50.0
    assert [(r.target, r.command, r.cycle) for r in m.records] == [("x", "move_absolute", 20)]
    m.turn(3)
    assert len(m.records) == 1


def test_another_block_aborts_and_a_buffered_one_waits(m: Outside) -> None:
    first = m.start("x", "MC_MoveAbsolute", position=5000.0, **QUICK)
    m.turn(20)
    second = m.start("x", "MC_MoveAbsolute", position=500.0, buffer_mode="aborting", **QUICK)
    third = m.start("x", "MC_MoveRelative", distance=-100.0, buffer_mode="buffered", **QUICK)
    assert m.ended(first) == "command_aborted"
    assert outputs(second.block) == "busy active" and outputs(third.block) == "busy"
    assert m.ended(second) == "done" and m.ended(third) == "done"
    assert m.now("x", "set_position") == 400.0


def test_calls_of_one_block_act_in_the_order_of_their_starts(m: Outside) -> None:
    calls = [m.start("x", "MC_MoveAbsolute", position=float(p), **QUICK) for p in (100, 200)]
    assert [m.ended(call) for call in calls] == ["command_aborted", "done"]
    assert m.now("x", "set_position") == 200.0


def test_a_cancel_halts_on_the_ramp(m: Outside) -> None:
    call = m.start("x", "MC_MoveVelocity", velocity=1000.0)
    m.until(lambda: call.block.in_velocity)
    begin = m.now("x", "set_position")
    m.calls.cancel(call)
    assert m.ended(call) == "command_aborted"
    m.until(lambda: m.now("x", "state") == S.STANDSTILL)
    assert m.now("x", "set_position") > begin + 50.0 and m.records[-1].command == "halt"


@pytest.mark.parametrize("name", ["MC_GearIn", "MC_CamIn"])
def test_a_cancelled_coupling_ends_and_its_axis_halts(m: Outside, name: str) -> None:
    table = {"cam_table": [(0.0, 0.0), (5000.0, 5000.0), (10_000.0, 10_000.0)], "periodic": False}
    call = m.start("y", name, master="x", **(table if name == "MC_CamIn" else {}))
    reached = "in_sync" if name == "MC_CamIn" else "in_gear"
    m.until(lambda: getattr(call.block, reached))
    m.start("x", "MC_MoveVelocity", velocity=500.0)
    m.until(lambda: m.now("y", "set_velocity") >= 499.0)
    m.calls.cancel(call)
    assert m.ended(call) == "command_aborted"
    m.until(lambda: m.now("y", "state") == S.STANDSTILL)
    assert m.now("x", "set_velocity") == 500.0
    assert [(r.command, r.accepted) for r in m.records if r.target == "y"][-2:] == [("decouple", True), ("halt", True)]


def test_a_cancel_of_a_superimposed_motion_leaves_the_motion_below(m: Outside) -> None:
    below = m.start("x", "MC_MoveAbsolute", position=3000.0, **(QUICK | {"velocity": 1000.0}))
    m.turn(30)
    above = m.start("x", "MC_MoveSuperimposed", distance=1000.0, velocity_difference=100.0)
    m.turn(30)
    m.calls.cancel(above)
    assert m.ended(above) == "command_aborted"
    assert m.ended(below) == "done" and 3000.0 < m.now("x", "set_position") < 4000.0


def test_mc_stop_holds_the_axis_while_its_call_is_open(m: Outside) -> None:
    move = m.start("x", "MC_MoveVelocity", velocity=1000.0)
    m.until(lambda: move.block.in_velocity)
    stop = m.start("x", "MC_Stop")
    m.turn(1)
    refused = m.start("x", "MC_MoveAbsolute", position=0.0)
    assert m.ended(refused) == "error" and refused.block.error_text == (
        "axis x: move_absolute refused: MC_Stop holds it while execute is true; nothing was changed"
    )
    assert m.ended(move) == "command_aborted" and m.ended(stop) == "done"
    m.turn(1)
    assert m.ended(m.start("x", "MC_MoveAbsolute", position=0.0, **QUICK)) == "done"


def test_blocks_that_end_with_the_answer(m: Outside) -> None:
    given: dict[str, dict[str, Any]] = {
        "MC_Reset": {},
        "MC_SetPosition": {"position": 5.0, "relative": True},
        "MC_WriteParameter": {"parameter": "P-AXIS-00236", "value": 5.0},
        "MC_ExtSetPointGenEnable": {"mode": "absolute"},
        "MC_ExtSetPointGenDisable": {},
    }
    for name, inputs in given.items():
        assert m.ended(m.start("x", name, **inputs)) == "done", name
    assert m.now("x", "set_position") == 5.0
    out = m.start("x", "MC_GearOut")
    assert m.ended(out) == "error" and out.block.error_id == 23047


def test_a_spindle() -> None:
    m = Outside(MILL)
    turn = m.start("s", "MC_MoveVelocity", velocity=-600.0)
    m.until(lambda: turn.block.in_velocity)
    orient = m.start("s", "MC_OrientSpindle", position=90.0)
    assert m.ended(turn) == "command_aborted" and m.ended(orient) == "done"
    turn = m.start("s", "MC_MoveVelocity", velocity=600.0)
    m.until(lambda: turn.block.in_velocity)
    m.calls.cancel(turn)
    assert m.ended(turn) == "command_aborted"
    m.until(lambda: m.now("s", "set_speed_rpm") == 0.0)
    mode = m.start("s", "MC_OrientSpindle", position=90.0, buffer_mode="blending_low")
    assert m.ended(mode) == "error" and mode.block.error_id == 22166


def test_a_lost_unit_ends_its_calls(m: Outside) -> None:
    call = m.start("x", "MC_MoveVelocity", velocity=1000.0)
    m.until(lambda: call.block.in_velocity)
    m.give("plc", "upstream_lost", source="x")
    m.turn(1)
    assert outputs(call.block) == "error" and call.block.error_id == 26101


REFUSALS: list[tuple[str, str, dict[str, Any], int, str]] = [
    (
        "axis", "MC_MovAbsolute", {"position": 1.0}, 22002,
        f"P-ERR-22002 axis u: unknown function block 'MC_MovAbsolute'; did you mean MC_MoveAbsolute?; nothing was changed. Known: {', '.join(OF_AXIS)}",
    ),
    (
        "spindle", "MC_MoveAbsolute", {"position": 1.0}, 22002,
        "P-ERR-22002 spindle u: unknown function block 'MC_MoveAbsolute'; nothing was changed. Known: MC_Reset, MC_Stop, "
        "MC_Halt, MC_Home, MC_MoveVelocity, MC_OrientSpindle, MC_GearIn, MC_GearOut",
    ),
    (
        "axis", "MC_Halt", {"position": 1.0}, 22001,
        "P-ERR-22001 axis u: MC_Halt refused: unknown input 'position'; nothing was changed. Known: none",
    ),
    (
        "axis", "MC_SetPosition", {"position": 1.0, "jerk": 1.0}, 22001,
        "P-ERR-22001 axis u: MC_SetPosition refused: unknown input 'jerk'; nothing was changed. Known: position, relative",
    ),
    (
        "axis", "MC_MoveAbsolute", {"velocity": 1.0}, 22001,
        "P-ERR-22001 axis u: MC_MoveAbsolute refused: input 'position' is missing; nothing was changed",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "name", "inputs", "number", "text"), REFUSALS)
def test_what_cannot_be_meant(kind: str, name: str, inputs: dict[str, Any], number: int, text: str) -> None:
    with pytest.raises(CncError) as refused:
        checked_type(kind, "u", name, inputs)
    assert (refused.value.number, str(refused.value)) == (number, text)


def test_a_refused_call_is_none(m: Outside) -> None:
    with pytest.raises(CncError):
        m.start("x", "MC_MoveAbsolute", distance=5.0)
    m.turn(3)
    assert not m.records and m.now("x", "set_position") == 0.0


@pytest.mark.parametrize(("kind", "name"), [(kind, name) for kind, known in BLOCK_TYPES.items() for name in known])
def test_the_inputs_of_the_catalogue_are_those_of_the_blocks(kind: str, name: str) -> None:
    """Called with all that is needed, a block gives a command; with nothing else it takes each optional input."""
    example: dict[str, Any] = {
        "buffer_mode": "buffered",
        "direction": "cw",
        "parameter": "P-AXIS-00236",
        "master": "y",
        "mode": "relative",
    }
    example |= {"cam_table": [(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)], "relative": True, "periodic": False}
    found = BLOCK_TYPES[kind][name]
    for optional in [(), *((each,) for each in found.optional), found.optional]:
        unit = FakeUnit(kind)
        block = found.make(unit)
        block(True, **{each: example.get(each, 2.0) for each in (*found.needed, *optional)})
        assert len(unit.given) == 1 and block.busy, (name, optional)
    if kind == "axis":
        own = inspect.signature(getattr(plcopen, name).__call__).parameters
        assert {*own} - {"self", "execute"} == {*found.needed, *found.optional}


def test_every_block_with_execute_is_in_the_catalogue() -> None:
    levels = {"MC_Power", "MC_SetOverride", "MC_ReadStatus", "MC_ReadAxisError", "MC_ReadParameter"}
    known = {name for name in plcopen.__all__ if name.startswith("MC_")} - levels - {"MC_ExtSetPointGenFeed"}
    assert known == {name for types in BLOCK_TYPES.values() for name in types}
