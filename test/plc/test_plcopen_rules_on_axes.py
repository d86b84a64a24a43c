"""PLCopen's rules on a real axis: several blocks of one axis in arbitrary orders of edges, as Hypothesis finds them."""

from __future__ import annotations

from typing import Any, NamedTuple

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from long_support import examples
from plcopen_support import PlcBench, outputs

from cnc_ptp.plc.plcopen import (
    MC_GearIn,
    MC_GearOut,
    MC_Halt,
    MC_Home,
    MC_MoveAbsolute,
    MC_MoveRelative,
    MC_MoveVelocity,
    MC_Reset,
    MC_SetPosition,
    MC_Stop,
)
from cnc_ptp.plc.program.plc_io import PlcIo

QUICK = {"velocity": 2000.0, "acceleration": 10_000.0, "deceleration": 10_000.0, "jerk": 1e6}
BLOCKS: list[tuple[type, dict[str, Any]]] = [
    (MC_MoveAbsolute, {"position": 40.0, **QUICK}),
    (MC_MoveAbsolute, {"position": -30.0, "buffer_mode": "buffered", **QUICK}),
    (MC_MoveRelative, {"distance": 25.0, "buffer_mode": "blending_high", **QUICK}),
    (MC_MoveVelocity, {"velocity": 100.0, "jerk": 1e6}),
    (MC_Halt, {}),
    (MC_Stop, {}),
    (MC_Home, {}),
    (MC_GearIn, {"master": "y"}),
    (MC_GearOut, {}),
    (MC_SetPosition, {"position": 1.0, "relative": True}),
    (MC_Reset, {}),
]
ENDLESS = (MC_MoveVelocity, MC_GearIn)
OF_ANSWER = (MC_GearOut, MC_SetPosition, MC_Reset)
CHOSEN = (0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 5, 5, 6, 7, 8, 8, 9, 10)
"""Blocks by their place, those that move the axis more often."""
STOP_HOLDS = 22165
CYCLES = 120
ENDS = ("done", "command_aborted", "error")
Edges = list[tuple[int, int]]


class Call(NamedTuple):
    """A call of a block: its execute, and the outputs after it."""

    execute: bool
    outputs: tuple[str, ...]
    error_id: int


def traces_of(edges: Edges) -> tuple[list[list[Call]], PlcBench]:
    """All calls of each block in a run; an edge (PLC cycle, block) turns its execute over."""
    turns: dict[int, list[int]] = {}
    for cycle, block in edges:
        turns.setdefault(cycle, []).append(block)
    traces: list[list[Call]] = [[] for _ in BLOCKS]

    def make(io: PlcIo) -> Any:
        blocks = [make_block(io.axis("x")) for make_block, _ in BLOCKS]
        executes = [False] * len(blocks)

        class Plc:
            def cycle(self, io: PlcIo) -> None:
                for block in turns.get(io.cycle // io.block_cycles, []):
                    executes[block] = not executes[block]
                for number, (block, (_, inputs)) in enumerate(zip(blocks, BLOCKS, strict=True)):
                    block(executes[number], **inputs)
                    traces[number].append(Call(executes[number], tuple(outputs(block).split()), block.error_id))

        return Plc()

    bench = PlcBench(make)
    bench.run(0.01 * CYCLES)
    return traces, bench


@settings(max_examples=examples(15), deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(
    st.lists(st.tuples(st.integers(1, CYCLES - 20), st.sampled_from(CHOSEN)), min_size=6, max_size=40),
)
def test_outputs_of_blocks_that_share_an_axis(edges: Edges) -> None:
    traces, bench = traces_of(edges)
    for (block, _), trace in zip(BLOCKS, traces, strict=True):
        for index, call in enumerate(trace):
            check_outputs(block, call)
            if index:
                check_step(trace[index - 1], call)
    for calls in zip(*traces, strict=True):
        moving = [block for (block, _), call in zip(BLOCKS, calls, strict=True) if "active" in call.outputs]
        assert len(moving) <= 1, "two blocks have the axis"
    rising = sum(
        is_edge(before, call) for trace in traces for before, call in zip([NEVER, *trace], trace, strict=False)
    )
    held = sum(
        is_edge(before, call) and call.error_id == STOP_HOLDS
        for trace in traces
        for before, call in zip([NEVER, *trace], trace, strict=False)
    )
    given = sum(record.target == "x" and record.command != "hold_stop" for record in bench.records)
    assert given == rising - held, "a falling edge commands nothing"


NEVER = Call(False, (), 0)


def is_edge(before: Call, call: Call) -> bool:
    return call.execute and not before.execute


def check_outputs(block: type, call: Call) -> None:
    """One of busy, done, command_aborted, error at most, and one in any case while execute is true."""
    states = [name for name in call.outputs if name != "active"]
    assert len(states) <= 1 and (states or not call.execute)
    assert "active" not in call.outputs or states == ["busy"]
    assert block not in ENDLESS or "done" not in states
    assert block not in OF_ANSWER or not {"active", "command_aborted"} & {*call.outputs}
    assert ("error" in states) == bool(call.error_id)


def check_step(before: Call, call: Call) -> None:
    """What may follow: ends hold while execute is true, and for one call otherwise; only an edge starts."""
    if is_edge(before, call):
        assert call.outputs == ("busy",) or (call.outputs == ("error",) and call.error_id == STOP_HOLDS)
    elif "busy" in before.outputs:
        assert call.outputs, "neither a falling edge nor anything else takes busy away without an end"
        assert "active" not in before.outputs or call.outputs != ("busy",)
    elif call.execute:
        assert call.outputs == before.outputs
    else:
        assert call.outputs == ()
