"""PLCopen's rules of outputs, in random orders of calls: a checker that knows the whole trace says what must be true."""

from __future__ import annotations

import random
from typing import Any, NamedTuple

import pytest
from plcopen_support import ABORTED, ACCEPTED, ACTIVE, DONE, FAILED, REFUSED, WAITS, FakeUnit, axis_block, outputs

from cnc_ptp.plc import plcopen
from cnc_ptp.plc.plcopen import (
    MC_CamIn,
    MC_ExtSetPointGenDisable,
    MC_ExtSetPointGenEnable,
    MC_GearIn,
    MC_GearOut,
    MC_Halt,
    MC_Home,
    MC_MoveAbsolute,
    MC_MoveAdditive,
    MC_MoveModulo,
    MC_MoveRelative,
    MC_MoveSuperimposed,
    MC_MoveVelocity,
    MC_OrientSpindle,
    MC_ReadAxisError,
    MC_ReadStatus,
    MC_Reset,
    MC_SetOverride,
    MC_SetPosition,
    MC_Stop,
    MC_WriteParameter,
)

INPUTS: dict[type, str] = {
    MC_MoveAbsolute: "position",
    MC_MoveRelative: "distance",
    MC_MoveAdditive: "distance",
    MC_MoveModulo: "position",
    MC_MoveSuperimposed: "distance",
    MC_MoveVelocity: "velocity",
    MC_OrientSpindle: "position",
    MC_Stop: "jerk",
    MC_Halt: "",
    MC_Home: "",
    MC_Reset: "",
    MC_SetPosition: "position",
    MC_WriteParameter: "value",
    MC_GearIn: "ratio_numerator",
    MC_CamIn: "master_offset",
    MC_GearOut: "",
    plcopen.MC_CamOut: "",
    MC_ExtSetPointGenEnable: "position",
    MC_ExtSetPointGenDisable: "",
}
"""Blocks with `execute`, each with an input that goes into its command."""
OF_ANSWER = (
    MC_Reset, MC_SetPosition, MC_WriteParameter, MC_GearOut, plcopen.MC_CamOut, MC_ExtSetPointGenEnable,
    MC_ExtSetPointGenDisable,
)  # fmt: skip
"""Blocks that end with the answer of their unit."""
OUTPUT_OF = {DONE: "done", ABORTED: "command_aborted", FAILED: "error", REFUSED: "error"}


class Call(NamedTuple):
    """A call and what could be known in it: `told` of the command of the newest rising edge."""

    execute: bool
    value: float
    told: str | None
    outputs: str


def expected(trace: list[Call], index: int, of_answer: bool) -> str:
    """The outputs of call `index`, from the rules and everything that came before."""
    edges = [i for i in range(index + 1) if trace[i].execute and not (i and trace[i - 1].execute)]
    if not edges:
        return ""
    edge = edges[-1]
    ends = [i for i in range(edge + 1, index + 1) if is_end(trace[i].told, of_answer)]
    if not ends:
        return "busy active" if trace[index].told == ACTIVE and index > edge else "busy"
    if all(call.execute for call in trace[ends[0] + 1 : index + 1]):
        told = trace[ends[0]].told
        return "done" if of_answer and told not in OUTPUT_OF else OUTPUT_OF[str(told)]
    return ""


def is_end(told: str | None, of_answer: bool) -> bool:
    return told in OUTPUT_OF or (of_answer and told is not None)


def next_told(told: str | None, chance: random.Random) -> str | None:
    """How the unit goes on with a command."""
    steps: dict[str | None, list[str | None]] = {
        None: [None, WAITS, ACTIVE, REFUSED, DONE],
        WAITS: [WAITS, ACTIVE, ABORTED, FAILED],
        ACTIVE: [ACTIVE, ACTIVE, DONE, ABORTED, FAILED],
    }
    return chance.choice(steps.get(told, [told]))


def random_trace(block_type: type, seed: int) -> tuple[list[Call], FakeUnit]:
    """Calls with random inputs on a unit that goes its own ways."""
    chance = random.Random(seed)
    unit = FakeUnit("spindle" if block_type is MC_OrientSpindle else "axis")
    block, name = block_type(unit), INPUTS[block_type]
    needed = {"master": "y"} if block_type in (MC_GearIn, MC_CamIn) else {}
    trace: list[Call] = []
    execute = False
    for _ in range(250):
        execute = execute if chance.random() < 0.7 else not execute
        value = chance.uniform(1.0, 100.0)
        for given in unit.given[:-1]:
            given.tells = ABORTED  # an older command is none of the block's business any more
        if unit.given:
            unit.last.tells = next_told(unit.last.tells, chance)
        told = unit.last.tells if unit.given else None
        block(execute, **needed, **({name: value} if name else {}))
        trace.append(Call(execute, value, told, outputs(block)))
    return trace, unit


@pytest.mark.parametrize("block_type", INPUTS, ids=lambda each: each.__name__)
def test_outputs_in_random_orders_of_calls(block_type: type) -> None:
    of_answer = block_type in OF_ANSWER
    for seed in range(8):
        trace, unit = random_trace(block_type, seed)
        seen = set()
        for index, call in enumerate(trace):
            wanted = expected(trace, index, of_answer)
            if block_type in (MC_MoveVelocity, MC_GearIn, MC_CamIn):
                wanted = wanted.replace("done", "error")  # an endless motion must not end by itself
            assert call.outputs == wanted, (seed, index, trace[max(0, index - 5) : index + 1])
            seen.add(call.outputs)
            if call.execute:
                assert call.outputs
        assert len(seen) >= (4 if of_answer else 6) - (block_type in (MC_MoveVelocity, MC_GearIn, MC_CamIn))
        edges = [
            c.value
            for c, before in zip(trace, [None, *trace], strict=False)
            if c.execute and not (before and before.execute)
        ]
        assert len(unit.given) == len(edges)  # a falling edge, and inputs that change, command nothing
        if INPUTS[block_type]:
            for given, value in zip(unit.given, edges, strict=True):
                assert value in given.arguments.values()


def test_every_block_with_execute_is_among_them() -> None:
    levels = {"MC_Power", "MC_SetOverride", "MC_ReadStatus", "MC_ReadAxisError", "MC_ReadParameter"}
    of_execute = {name for name in plcopen.__all__ if name.startswith("MC_")} - levels - {"MC_ExtSetPointGenFeed"}
    assert of_execute == {block_type.__name__ for block_type in INPUTS}


def test_outputs_of_level_blocks_in_random_orders_of_calls() -> None:
    for seed in range(20):
        chance = random.Random(seed)
        unit = FakeUnit()
        blocks: list[Any] = [MC_SetOverride(unit), MC_ReadStatus(unit), MC_ReadAxisError(unit)]
        for step in range(300):
            unit.block = axis_block(chance.randrange(8)) if step > 20 else None
            if unit.given and unit.last.tells is None and chance.random() < 0.5:
                unit.last.tells = chance.choice((ACCEPTED, ACCEPTED, REFUSED))
            for block in blocks:
                enable = chance.random() < 0.8
                block(enable, 0.01 * chance.randrange(3)) if isinstance(block, MC_SetOverride) else block(enable)
                valid = block.enabled if isinstance(block, MC_SetOverride) else block.valid
                assert not (valid and block.error) and not (block.busy and block.error)
                assert block.busy or block.error if enable else not (valid or block.busy or block.error)
                assert bool(block.error_id) == bool(block.error_text) == block.error
