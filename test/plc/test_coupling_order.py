"""Several couplings in one block end as the same commands one block after the other: a refused one leaves no trace."""

from __future__ import annotations

import json
import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from error_support import refused
from long_support import long
from machine_support import PTP, ROOT, MachineBench
from slave_support import SlaveBench, axes_named

from cnc_ptp.commands.run.replay import replay_blocks
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.plc.scenario import parse_scenario
from cnc_ptp.protocol.blocks import CommandRecord, CycleTick
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.verify import verify
from cnc_ptp.recording.writer import Recording

Given = tuple[str, str, dict[str, Any]]
TABLE = [[0.0, 0.0], [50.0, 30.0], [100.0, 0.0]]
NAMES = ("a", "b", "c", "d")


def couple(slave: str, master: str, factor: float = 1.0) -> Given:
    return slave, "couple", {"master": master, "factor": factor}


def answers(bench: SlaveBench, commands: list[Given]) -> list[tuple[bool, int, str]]:
    return [(record.accepted, record.error_id, record.message) for record in bench.send_all(commands)]


def masters(bench: SlaveBench) -> dict[str, str]:
    bench.tick()
    return {name: bench.last(name).master for name in NAMES}


@pytest.mark.parametrize(
    ("refused", "number"),
    [
        (couple("x", "y", 0.0), 23043),
        (couple("x", "y", 1e9), 23043),
        (("x", "couple_gantry", {"master": "y", "difference_limit": 0.0}), 23054),
        (("x", "couple_cam", {"master": "y", "table": [[0.0, 0.0]]}), 23052),
    ],
    ids=["factor 0", "factor too large", "gantry", "cam"],
)
def test_a_coupling_refused_for_its_values_does_not_stand_in_the_way(refused: Given, number: int) -> None:
    bench = SlaveBench()
    assert [answer[:2] for answer in answers(bench, [refused, couple("y", "x", 0.5)])] == [(False, number), (True, 0)]
    assert bench.last("y").master == "x" and bench.last("x").master == ""


def test_a_coupling_refused_for_its_axis_does_not_stand_in_the_way() -> None:
    """x has no enable, 23044; that is nothing to y, which changes its master."""
    bench = SlaveBench()
    bench.do("y", "couple", master="z", factor=1.0)
    bench.do("x", "power", enabled=False)
    given = [couple("x", "y"), ("y", "decouple", {}), couple("y", "x")]
    assert [answer[:2] for answer in answers(bench, given)] == [(False, 23044), (True, 0), (True, 0)]
    assert bench.last("y").master == "x"


def test_in_a_scenario() -> None:
    bench = MachineBench(
        scenario="""
- {at: 0.1, to: x, do: couple, master: y, factor: 0}
- {at: 0.1, to: y, do: couple, master: x, factor: 0.5}
- {at: 0.2, to: x, do: move_absolute, target: 100}
""",
        machine=axes_named("x", "y"),
    ).run(3.0)
    assert [text[:11] for text in bench.refusals()] == ["P-ERR-23043"]
    assert bench.last("y").set_position[-1] == 50.0


def test_what_comes_after_a_coupling_that_waits_keeps_its_order() -> None:
    """x starts after it has become a master, also where its coupling had to wait for a block: y does not lag."""
    bench = SlaveBench()
    given = [couple("x", "y", 0.0), couple("y", "x"), ("x", "move_absolute", {"target": 10.0}), ("y", "decouple", {})]
    records = bench.send_all(given)
    assert [(record.accepted, record.cycle) for record in records] == [(False, 0), (True, 10), (True, 10), (True, 10)]


def test_a_stop_does_not_wait_with_the_coupling() -> None:
    bench = SlaveBench()
    bench.do("x", "move_absolute", target=5000.0)
    bench.run(0.3)
    cycle = bench.cycle
    records = bench.send_all([couple("x", "y", 0.0), couple("y", "x"), ("x", "stop", {})])
    assert [record.cycle - cycle for record in records] == [0, 10, 0]


CIRCLE = [couple("y", "x", 0.0), couple("x", "y")]
"""The second one waits for what becomes of the first."""


@pytest.mark.parametrize(
    ("command", "arguments"),
    [
        ("emergency_stop", {"deceleration": 20_000.0, "jerk": 500_000.0}),
        ("stop", {}),
        ("halt", {}),
        ("jog", {"velocity": 0.0}),
        ("power", {"enabled": False}),
        ("group_error", {"source": "z", "error": 23010}),
        ("set_feed_release", {"forward": False, "backward": True}),
        ("set_override", {"percent": 0.0}),
    ],
)
def test_a_stop_of_the_axis_whose_coupling_waits_goes_out_at_once(command: str, arguments: dict[str, Any]) -> None:
    bench = SlaveBench()
    bench.do("x", "jog", velocity=500.0)
    bench.run(0.5)
    cycle = bench.cycle
    records = bench.send_all([*CIRCLE, ("x", command, arguments)])
    assert [record.cycle - cycle for record in records] == [0, 10, 0]
    assert [record.accepted for record in records] == [False, False, True]
    assert bench.values("x", "set_velocity")[cycle + 9] < 500.0
    bench.settle()


def test_the_end_of_a_jog_is_no_start() -> None:
    """A slave may be coupled to the axis in the same block."""
    bench = SlaveBench()
    records = bench.send_all([("x", "jog", {"velocity": 0.0}), couple("y", "x")])
    assert [record.accepted for record in records] == [True, True]


def test_a_factor_and_a_decoupling_do_not_overtake_the_coupling_that_waits() -> None:
    bench = SlaveBench()
    factor = ("x", "set_coupling_factor", {"factor": 2.0})
    records = bench.send_all([*CIRCLE, factor, ("x", "decouple", {})])
    assert [record.cycle for record in records] == [0, 10, 10, 10]
    assert [record.accepted for record in records] == [False, True, True, True]


def test_a_stop_does_not_overtake_what_waits_for_its_axis() -> None:
    bench = SlaveBench()
    start = ("x", "move_absolute", {"target": 5000.0})
    records = bench.send_all([couple("x", "y", 0.0), couple("y", "x"), start, ("x", "stop", {})])
    assert [record.cycle for record in records] == [0, 10, 10, 10]
    assert not any(bench.settle(1.0).values("x"))


@pytest.mark.parametrize("seed", [*range(10), *long(range(10, 30))])
def test_one_block_is_like_many(seed: int) -> None:
    """Couplings and decouplings of standing axes, some of them refused: the same answers, the same masters."""
    choice = random.Random(seed)
    given: list[Given] = []
    for _ in range(choice.randint(3, 9)):
        axis = choice.choice(NAMES)
        if choice.random() < 0.6:
            given.append(couple(axis, choice.choice(NAMES), choice.choice([0.0, 1.0, -0.5])))
        else:
            given.append((axis, "decouple", choice.choice([{}, {"target": 5.0}, {"target": 1e9}])))
    machine = axes_named(*NAMES)
    together, apart = SlaveBench(machine=machine), SlaveBench(machine=machine)
    expected = []
    for command in given:
        expected += answers(apart, [command])
        apart.tick()
    assert answers(together, given) == expected
    assert masters(together) == masters(apart)


# what commands look like in a recording


def test_a_record_has_what_was_given_and_nothing_that_the_plc_filled_in() -> None:
    bench = SlaveBench()
    bench.do("y", "couple", master="z", factor=0.5)
    record = bench.send("x", "couple", master="y", factor=2.0)
    assert record.accepted and json.loads(record.arguments_json) == {"master": "y", "factor": 2.0}
    refused = bench.send("z", "couple", master="x", factor=1.0)
    assert refused.error_id == 23046 and json.loads(refused.arguments_json) == {"master": "x", "factor": 1.0}


def test_an_axis_takes_a_table_or_a_file() -> None:
    bench = SlaveBench()
    bench.do("y", "couple_cam", master="x", table=TABLE)
    bench.do("y", "decouple")
    text = "'table' and 'file' are both given; nothing was changed. Give one"
    assert bench.denied("y", "couple_cam", master="x", table=TABLE, file="a.csv") == (
        f"P-ERR-22001 axis y: couple_cam refused: {text}"
    )
    assert bench.denial("y", "couple_cam", master="x", file="a.csv") == refused(22001, argument="table")


def test_the_points_of_a_file_take_its_place() -> None:
    entry = "- {at: 0, to: y, do: couple_cam, master: x, file: a.csv}"
    text = "master,slave\n0,0\n50,30\n100,0\n"
    (command,) = [each.command for each in parse_scenario(entry, "s.yaml", unit_kinds(PTP), lambda *_: text)]
    assert command.arguments == {"master": "x", "table": TABLE}


@pytest.mark.parametrize("former", [False, True], ids=["as recorded today", "as recorded before"])
def test_replay_of_couplings_that_were_refused(former: bool, tmp_path: Path) -> None:
    """In a circle, with a moving master, with factor 0; and (before) with what the PLC had filled in, and both names."""
    scenario = """
- {at: 0.0, to: x, do: couple, master: y, factor: 0}
- {at: 0.0, to: y, do: couple, master: x, factor: 0.5}
- {at: 0.1, to: x, do: couple, master: y, factor: 1}
- {at: 0.1, to: c, do: couple_cam, master: x, table: [[0, 0], [50, 30], [100, 0]]}
- {at: 0.2, to: x, do: move_absolute, target: 500}
- {at: 0.3, to: z, do: couple, master: x, factor: 1}
"""
    bench = MachineBench(scenario=scenario, machine=PTP).run()
    assert sorted(text[:11] for text in bench.refusals()) == ["P-ERR-23043", "P-ERR-23045", "P-ERR-23046"]
    records = [before(record) if former else record for record in bench.records]
    path = tmp_path / "run.mcap"
    with Recording(path, (ROOT / "config" / "ptp.yaml").read_text()) as recording:
        for blocks in zip(*bench.blocks.values(), strict=True):
            recording.tick(CycleTick(blocks[0].first_cycle, blocks[0].count))
            for name, block in zip(bench.blocks, blocks, strict=True):
                recording.block(name, block)
        for record in records:
            recording.command(record)
    result = verify(read_recording(path), replay_blocks)
    assert result.equal, result.text()


def before(record: CommandRecord) -> CommandRecord:
    """As an older version has recorded it."""
    arguments = json.loads(record.arguments_json)
    if "master" in arguments:
        arguments |= {"above": ["y", "x"] if record.error_id == 23046 else [], "master_lost": False}
        arguments["master_stands"] = record.error_id != 23045
    if "table" in arguments:
        arguments["file"] = "cam.csv"
    return replace(record, arguments=json.dumps(arguments))
