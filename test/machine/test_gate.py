"""The gate: every order of arrival gives the same computations, once each; gaps and late comers are noticed."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from long_support import examples

from cnc_ptp.machine.gate import BlockGate
from cnc_ptp.machine.wiring import Inputs
from cnc_ptp.protocol.blocks import ChannelBlock, CycleBlock, CycleTick, PlcBlock
from cnc_ptp.protocol.unit import CLOCK

INPUTS = Inputs(upstream=("plc",), feedback=("x", "y"))


def block(first_cycle: int, count: int = 10) -> PlcBlock:
    return PlcBlock(first_cycle, count)


def take(gate: BlockGate) -> tuple[CycleTick, dict[str, CycleBlock]] | None:
    """The next computation, of a unit without a master."""
    return gate.complete() if gate.begin() is not None else None


def gate_with(*arrivals: tuple[str, int]) -> BlockGate:
    """A gate that has seen blocks ("plc", 0) and ticks ("tick", 0)."""
    gate = BlockGate(INPUTS)
    for source, cycle in arrivals:
        if source == "tick":
            gate.add_tick(CycleTick(cycle, 10))
        else:
            gate.add_block(source, block(cycle))
    return gate


def test_the_first_block_needs_no_feedback() -> None:
    gate = gate_with(("tick", 0))
    assert gate.missing() == ["plc"] and take(gate) is None
    gate.add_block("plc", block(0))
    work = take(gate)
    assert work is not None
    tick, inputs = work
    assert tick == CycleTick(0, 10) and list(inputs) == ["plc"] and gate.next_cycle == 10
    assert take(gate) is None and gate.missing() == ["clock"]


def test_later_blocks_need_upstream_and_feedback() -> None:
    gate = gate_with(("tick", 0), ("plc", 0))
    take(gate)
    gate.add_tick(CycleTick(10, 10))
    assert gate.missing() == ["plc", "x", "y"]
    gate.add_block("y", block(0))
    gate.add_block("plc", block(10))
    assert gate.missing() == ["x"]
    gate.add_block("x", block(0))
    work = take(gate)
    assert work is not None and [(name, b.first_cycle) for name, b in work[1].items()] == [
        ("plc", 10),
        ("x", 0),
        ("y", 0),
    ]


@settings(max_examples=examples(100), deadline=None, derandomize=True)
@given(st.permutations([(name, 10 * n) for name in ("tick", "plc", "x", "y") for n in range(5)]), st.data())
def test_any_order_of_blocks_gives_the_same_computations(order: list[tuple[str, int]], data: st.DataObject) -> None:
    """Ticks keep their order (one sender); blocks come in any, some of them twice."""
    ticks = iter(range(0, 50, 10))
    gate, computed = BlockGate(INPUTS), []
    doubles = 0
    for source, cycle in order:
        if source == "tick":
            assert gate.add_tick(CycleTick(next(ticks), 10))
        else:
            gate.add_block(source, block(cycle))
            if data.draw(st.booleans()):
                gate.add_block(source, block(cycle))
                doubles += 1
        while (work := take(gate)) is not None:
            computed.append((work[0].first_cycle, {name: b.first_cycle for name, b in work[1].items()}))
            if data.draw(st.booleans()):
                gate.add_block("plc", block(work[0].first_cycle))
                doubles += 1
    assert computed == [(n, {"plc": n} | ({"x": n - 10, "y": n - 10} if n else {})) for n in range(0, 50, 10)]
    assert gate.duplicates == doubles


def test_ticks_twice_and_with_a_gap() -> None:
    gate = BlockGate(INPUTS)
    assert gate.add_tick(CycleTick(0, 10)) and gate.add_tick(CycleTick(10, 10))
    assert gate.add_tick(CycleTick(10, 10)) and gate.duplicates == 1
    assert not gate.add_tick(CycleTick(30, 10))


def test_a_tick_without_cycles_ends_the_run_when_all_is_computed() -> None:
    gate = gate_with(("tick", 0))
    assert gate.add_tick(CycleTick(10, 0)) and not gate.closed
    gate.add_block("plc", block(0))
    assert take(gate) is not None
    assert gate.closed and take(gate) is None


def test_a_last_tick_behind_a_gap_is_noticed() -> None:
    gate = gate_with(("tick", 0))
    assert not gate.add_tick(CycleTick(20, 0)) and not gate.closed


def test_close_ends_at_once() -> None:
    gate = gate_with(("tick", 0), ("plc", 0))
    gate.close()
    assert gate.closed and take(gate) is None


def test_a_later_block_tells_that_the_needed_one_is_lost() -> None:
    gate = gate_with(("tick", 0), ("plc", 0))
    take(gate)
    assert gate.skipped() == []
    for source, cycle in (("tick", 10), ("x", 10), ("y", 0), ("plc", 20)):
        if source == "tick":
            gate.add_tick(CycleTick(cycle, 10))
        else:
            gate.add_block(source, block(cycle))
    assert gate.skipped() == ["plc", "x"]
    gate.drop("plc")
    gate.drop("x")
    assert gate.skipped() == [] and gate.sources == ("y",)
    work = take(gate)
    assert work is not None and list(work[1]) == ["y"]
    gate.add_block("plc", block(20))  # ignored from now on
    assert gate.duplicates == 0 and gate.sources == ("y",)


def test_blocks_of_strangers_are_ignored() -> None:
    gate = BlockGate(INPUTS)
    gate.add_block("z", ChannelBlock(0, 10))
    assert gate.sources == ("plc", "x", "y") and gate.duplicates == 0


@pytest.mark.parametrize(
    ("arrivals", "waking", "waits"),
    [
        ([], {"plc"}, False),
        ([("tick", 10), ("tick", 20), ("tick", 30)], {"plc"}, False),  # late: what wakes it is still to come
        ([("tick", 10), ("plc", 10)], {"plc"}, True),
        ([("tick", 10), ("plc", 10), ("x", 0)], {"plc"}, True),
        ([("tick", 10), ("plc", 10), ("x", 0), ("y", 0)], {"plc"}, False),  # nothing is missing
        ([("plc", 10), ("x", 0), ("y", 0)], {"plc"}, True),
        ([("x", 0), ("y", 0)], {CLOCK}, False),
        ([("tick", 10)], {CLOCK}, True),
        ([("plc", 10), ("x", 0)], {"x", "y"}, False),
        ([("plc", 10), ("x", 0), ("y", 0)], {"x", "y"}, True),
    ],
)
def test_a_node_looks_for_the_rest_once_what_wakes_it_has_come(
    arrivals: list[tuple[str, int]], waking: set[str], waits: bool
) -> None:
    gate = gate_with(("tick", 0), ("plc", 0))
    take(gate)
    for source, cycle in arrivals:
        if source == "tick":
            gate.add_tick(CycleTick(cycle, 10))
        else:
            gate.add_block(source, block(cycle))
    assert gate.waits_for_others(waking) is waits


def test_a_node_does_not_look_for_the_rest_of_what_it_will_not_be_woken_for() -> None:
    gate = gate_with(("tick", 0), ("plc", 0))
    assert gate.begin() is not None and not gate.waits_for_others({"plc"})  # open: the block of a master wakes it
    gate.follow("m")
    assert gate.complete() is None and not gate.waits_for_others({"plc"})
    gate.follow(None)
    assert gate.complete() is not None
    gate.add_block("plc", block(10))
    assert gate.waits_for_others({"plc"})
    gate.drop("plc")
    assert not gate.waits_for_others({"plc"})
    gate.add_tick(CycleTick(10, 10))
    assert gate.waits_for_others({"plc"})  # for x and y; the tick stands for what comes no more
    gate.close()
    assert not gate.waits_for_others({"plc"})
