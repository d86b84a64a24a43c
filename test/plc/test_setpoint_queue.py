"""External setpoints on their way through the PLC: order, spreading, horizon, ends."""

from __future__ import annotations

import random
from collections.abc import Sequence

import pytest
from machine_support import CYCLE_TIME, PTP, MachineBench, axis_bench

from cnc_ptp.plc.setpoint_queue import SetpointQueue
from cnc_ptp.protocol.blocks import Command

SetpointRow = list[float]
HORIZON = 60_000
"""60 s in cycles of 1 ms."""


WARNINGS: list[tuple[int, int, str]] = []


def row(cycle: int, position: float = 0.0, direction: int = 1) -> SetpointRow:
    return [cycle, position, 0.0, 0.0, direction]


def new_queue() -> SetpointQueue:
    return SetpointQueue(
        cycle_time=CYCLE_TIME, warn=lambda cycle, number, text, _values: WARNINGS.append((cycle, number, text))
    )


def rows_of(commands: Sequence[Command], axis: str = "x") -> list[SetpointRow]:
    assert all(command.command == "external_setpoints" for command in commands)
    return [row for command in commands if command.target == axis for row in command.arguments["setpoints"]]


def taken(queue: SetpointQueue, first_cycle: int, count: int = 10) -> list[SetpointRow]:
    return rows_of(list(queue.take(first_cycle, count)))


def cycles(rows: Sequence[SetpointRow]) -> list[float]:
    return [each[0] for each in rows]


# order


@pytest.mark.parametrize("way", ["add", "arrive"])
def test_rows_in_any_order_go_out_in_the_order_of_their_cycles(way: str) -> None:
    queue = new_queue()
    rows = [row(cycle, 0.1 * cycle) for cycle in range(100, 200)]
    shuffled = random.Random(5).sample(rows, len(rows))
    for each in shuffled:
        queue.add("x", [each]) if way == "add" else queue.arrive("x", each)
    out = []
    for first_cycle in range(90, 210, 10):
        block = taken(queue, first_cycle)
        assert all(first_cycle <= cycle < first_cycle + 10 for cycle in cycles(block))
        out += block
    assert out == rows and not queue


def test_rows_that_come_while_others_wait_take_their_place() -> None:
    queue = new_queue()
    for cycle in (30, 10, 15):
        queue.arrive("x", row(cycle))
    assert cycles(taken(queue, 10)) == [10, 15]
    queue.arrive("x", row(25))
    assert taken(queue, 0) == []
    assert cycles(taken(queue, 20)) == [25]
    assert cycles(taken(queue, 30)) == [30]


def test_of_two_rows_of_one_cycle_the_later_counts() -> None:
    queue = new_queue()
    for position in (1.0, 2.0, 3.0):
        queue.arrive("x", row(12, position))
    queue.arrive("x", row(13, 4.0))
    assert taken(queue, 10) == [row(12, 3.0), row(13, 4.0)]


def test_a_late_row_goes_out_at_once() -> None:
    queue = new_queue()
    queue.arrive("x", row(7))
    queue.arrive("x", row(101))
    assert cycles(taken(queue, 100)) == [7, 101]


def test_a_row_that_was_overtaken_goes_out_by_itself() -> None:
    """The axis refuses a command as a whole: the rows in order must not suffer for the one that is not."""
    queue = new_queue()
    queue.add("x", [row(cycle) for cycle in range(100, 110)])
    assert len(taken(queue, 100)) == 10
    for cycle in (111, 105, 109, 112):
        queue.arrive("x", row(cycle))
    commands = list(queue.take(110, 10))
    assert [cycles(command.arguments["setpoints"]) for command in commands] == [[105], [109], [111, 112]]


def test_each_axis_has_its_own_rows() -> None:
    queue = new_queue()
    queue.add("x", [row(3, 1.0)])
    queue.arrive("y", row(2, 2.0))
    queue.arrive("z", row(50, 3.0))
    commands = list(queue.take(0, 10))
    assert rows_of(commands, "x") == [row(3, 1.0)] and rows_of(commands, "y") == [row(2, 2.0)]
    assert rows_of(commands, "z") == [] and queue


# rows without a cycle


@pytest.mark.parametrize(
    ("number", "expected"),
    [
        (1, [100]),
        (2, [100, 105]),
        (3, [100, 103, 106]),
        (4, [100, 102, 105, 107]),
        (10, list(range(100, 110))),
        (25, list(range(100, 110))),
    ],
)
def test_rows_without_a_cycle_are_spread_over_the_next_block(number: int, expected: list[int]) -> None:
    """The newest ten where there are more."""
    queue = new_queue()
    for n in range(number):
        queue.arrive("x", row(0, float(n)))
    out = taken(queue, 100)
    assert cycles(out) == expected
    assert [each[1] for each in out] == [float(n) for n in range(max(0, number - 10), number)]
    assert not queue


def test_the_first_cycle_of_all_is_one_to_spread_over() -> None:
    queue = new_queue()
    for n in range(10):
        queue.arrive("x", row(0, float(n)))
    assert cycles(taken(queue, 0)) == list(range(10))


def test_rows_with_and_without_a_cycle() -> None:
    queue = new_queue()
    for cycle, position in ((0, 1.0), (104, 2.0), (0, 3.0), (250, 4.0)):
        queue.arrive("x", row(cycle, position))
    assert taken(queue, 100) == [row(100, 1.0), row(104, 2.0), row(105, 3.0)]
    assert taken(queue, 250) == [row(250, 4.0)]


# horizon


def test_a_row_of_a_topic_more_than_60_s_ahead_is_none() -> None:
    queue = new_queue()
    WARNINGS.clear()
    queue.arrive("x", row(1000 + HORIZON))
    queue.arrive("x", row(1001 + HORIZON))
    queue.arrive("x", row(10**12))
    assert taken(queue, 1000) == [] and queue
    assert cycles(taken(queue, 1000 + HORIZON)) == [1000 + HORIZON]
    assert not queue
    assert [(cycle, number) for cycle, number, _ in WARNINGS] == [(1000, 23032), (1000, 23032)]
    assert WARNINGS[0][2] == (
        "axis x: external setpoint for cycle 61001 dropped: it lies more than 60 s ahead of cycle 1000"
    )


def test_rows_of_a_scenario_may_lie_as_far_ahead_as_they_like() -> None:
    queue = new_queue()
    queue.add("x", [row(10**7)])
    assert taken(queue, 0) == [] and queue
    assert cycles(taken(queue, 10**7)) == [10**7]


# ends


@pytest.mark.parametrize("end", [0, 155])
def test_an_end_takes_back_the_rows_after_it(end: int) -> None:
    """Those of its cycle and later; what came before it stays. Without a cycle it ends in the next block."""
    queue = new_queue()
    for cycle in (155, 190, 140, 160, 103):
        queue.arrive("x", row(cycle))
    queue.arrive("y", row(190))
    assert cycles(taken(queue, 100)) == [103]
    queue.arrive("x", row(end, direction=0))
    out = [taken(queue, first_cycle) for first_cycle in range(110, 210, 10)]
    left = [each for block in out for each in block]
    assert left == ([row(110, direction=0)] if end == 0 else [row(140), row(155, direction=0)])


def test_rows_that_come_after_an_end_begin_anew() -> None:
    queue = new_queue()
    for each in (row(120), row(115, direction=0), row(118)):
        queue.arrive("x", each)
    assert taken(queue, 110) == [row(115, direction=0), row(118)]
    assert taken(queue, 120) == []


def test_clear_leaves_nothing() -> None:
    queue = new_queue()
    queue.add("x", [row(5)])
    queue.arrive("x", row(0))
    assert queue
    queue.clear()
    assert not queue and taken(queue, 0) == []


def test_what_waits_is_dropped_when_external_setpoints_end() -> None:
    queue = new_queue()
    bench = axis_bench()
    queue.add("x", [row(0), row(1000)])
    bench.run(10)
    queue.watch({"x": bench.last})
    assert cycles(taken(queue, 0)) == [0] and queue  # not yet enabled: rows may come before
    bench.accepted("external_enable", mode="absolute")
    bench.run(10)
    queue.watch({"x": bench.last})
    assert queue
    bench.accepted("external_disable")
    bench.run(10)
    queue.watch({"x": bench.last})
    assert not queue
    queue.add("x", [row(1000)])  # for the next enable
    queue.watch({"x": bench.last})
    assert queue


def test_an_axis_that_is_lost_has_ended_too() -> None:
    queue = new_queue()
    bench = axis_bench()
    bench.accepted("external_enable", mode="absolute")
    bench.run(10)
    queue.watch({"x": bench.last})
    queue.add("x", [row(1000)])
    queue.watch({})
    assert not queue


# in the machine


def constant(first: int, count: int, velocity: float = 100.0) -> list[SetpointRow]:
    return [[first + k, velocity * k * CYCLE_TIME, velocity, 0.0, 1] for k in range(count)]


def external_machine() -> MachineBench:
    bench = MachineBench(machine=PTP, end_when_idle=False).run(0.01)
    assert bench.give("x", "external_enable", mode="absolute").accepted
    return bench.run(0.01)


def test_what_waited_moves_nothing_after_the_next_enable() -> None:
    """Rows for a second; the axis is stopped after 0.3 s and enabled again after 0.6 s."""
    bench = external_machine()
    bench.units["plc"].setpoints.add("x", constant(30, 1000))  # type: ignore[attr-defined]
    bench.run(0.28)
    assert bench.give("x", "stop").accepted
    bench.run(0.3)
    here = bench.position("x")
    assert here > 20.0 and bench.give("x", "external_enable", mode="absolute").accepted
    bench.run(1.0)
    assert bench.position("x") == here and bench.errors() == []


def test_rows_in_any_order_move_the_axis_as_in_order() -> None:
    runs = []
    for seed in (None, 7):
        bench = external_machine()
        rows = constant(40, 200)
        queue = bench.units["plc"].setpoints  # type: ignore[attr-defined]
        for each in rows if seed is None else random.Random(seed).sample(rows, len(rows)):
            queue.arrive("x", each)
        queue.arrive("x", [240, 20.0, 0.0, 0.0, 0])
        bench.run(0.5)
        assert bench.errors() == [] and bench.position("x") == 20.0
        runs.append(bench.column("x", "set_position"))
    assert runs[0] == runs[1]


def test_one_late_row_costs_no_others() -> None:
    bench, twin = external_machine(), external_machine()
    for each in (bench, twin):
        each.units["plc"].setpoints.add("x", [*constant(30, 300), [330, 30.0, 0.0, 0.0, 0]])  # type: ignore[attr-defined]
        each.run(0.1)
    bench.units["plc"].setpoints.arrive("x", [90, 1.0, 100.0, 0.0, 1])  # type: ignore[attr-defined]
    for each in (bench, twin):
        each.run(0.4)
    (text,) = bench.refusals()
    assert text == (
        "P-ERR-23032 axis x: external_setpoints refused: setpoint of cycle 90: comes after cycle 119; "
        "cycles must ascend; nothing was changed"
    )
    assert bench.column("x", "set_position") == twin.column("x", "set_position")
