"""The promise: the same program, parameters and commands give the same bits, in a second run and in a replay."""

from __future__ import annotations

from functools import cache
from typing import Any

import pytest
from machine_support import MILL, PTP, ROOT, MachineBench
from replay_support import bits, replay

from cnc_ptp.protocol.blocks import Command, CommandRecord

BRACKET = (ROOT / "examples" / "bracket.nc").read_text(encoding="utf-8")

RICH = """
- {at: 0.05, to: channel, do: set_override, percent: 80}
- {at: 0.5, to: x, do: set_override, percent: 50}
- {at: 1.0, to: channel, do: feed_hold, enabled: on}
- {at: 1.4, to: channel, do: feed_hold, enabled: off}
- {at: 1.5, to: x, do: move_absolute, target: 5}
- {at: 1.6, to: s, do: set_override, percent: 70}
- {at: 2.0, to: channel, do: set_override, percent: 133.3333333333}
- {at: 2.2, to: s, do: set_override, percent: 120}
- {at: 3.0, to: plc, do: auto_acknowledge, enabled: off}
- {at: 5.0, to: plc, do: auto_acknowledge, enabled: on}
- {at: 6.0, to: channel, do: start}
- {at: 9.0, to: y, do: power, enabled: off}
- {at: 9.02, to: channel, do: reset}
- {at: 9.5, to: y, do: power, enabled: on}
- {at: 9.6, to: y, do: reset}
- {at: 9.6, to: channel, do: reset}
- {at: 10.0, to: z, do: move_absolute, target: 80, velocity: 100}
- {at: 10.1, to: z, do: set_override, percent: 25.5}
- {at: 10.3, to: z, do: set_override, percent: 0}
- {at: 10.6, to: z, do: set_override, percent: 100}
- {at: 10.7, to: z, do: stop}
- {at: 12.0, to: channel, do: mdi, text: "G90 G01 X20 Y20 F5000"}
- {at: 12.2, to: channel, do: single_block, enabled: on}
- {at: 13.0, to: channel, do: start}
- {at: 13.5, to: channel, do: start}
- {at: 14.0, to: channel, do: reset}
- {at: 15.0, to: s, do: start, direction: ccw, speed_rpm: 300}
- {at: 15.5, to: plc, do: set_life_sign, enabled: off}
- {at: 16.0, to: plc, do: set_life_sign, enabled: on}
- {at: 16.5, to: x, do: reset}
- {at: 16.5, to: y, do: reset}
- {at: 16.5, to: s, do: reset}
- {at: 16.5, to: channel, do: reset}
- {at: 16.6, to: channel, do: mdi, text: "G02 X40 Y20 I10 J0 F3000 M03 S500"}
- {at: 17.5, to: plc, do: stop_all}
"""


def service_calls(bench: MachineBench) -> None:
    """Commands from services, refused ones and watchdogs among them, between the blocks of a running bench."""
    calls: list[tuple[float, str, str, dict[str, Any]]] = [
        (0.33, "x", "move_absolute", {"target": float("nan")}),
        (0.2, "z", "set_override", {"percent": 1e-5}),
        (1.0, "channel", "set_override", {"percent": 61}),
        (0.5, "s", "start", {"direction": "cw", "speed_rpm": -1}),
        (3.0, "channel", "acknowledge", {"id": 99}),
    ]
    for seconds, unit, command, arguments in calls:
        bench.run(seconds)
        bench.give(unit, command, **arguments)


@cache
def rich_run(number: int = 1) -> MachineBench:
    """The same run for each number, made once."""
    bench = MachineBench(BRACKET, RICH)
    service_calls(bench)
    return bench.run()


@cache
def rich_bits() -> dict[str, list[str]]:
    return bits(rich_run())


def test_two_runs_are_bit_identical() -> None:
    first, second = rich_run(), rich_run(2)
    assert rich_bits() == bits(second)
    assert first.records == second.records and first.events == second.events


def test_the_recorded_commands_reproduce_a_rich_run_bit_for_bit() -> None:
    """Axes, spindle and channel; the PLC's own blocks need its scenario, which is not part of a recording."""
    bench = rich_run()
    commands = {(record.target, record.command) for record in bench.records}
    assert {("channel", "upstream_lost"), ("x", "upstream_lost"), ("z", "stop"), ("s", "start")} <= commands
    assert sum(not record.accepted for record in bench.records) >= 5
    assert {event.error_id for event in bench.events} >= {23010, 22012, 26101}
    texts = replay(MILL, bench.records, len(bench.blocks["x"]))
    for name in ("channel", "s", "x", "y", "z"):
        assert texts[name] == rich_bits()[name], name


def test_a_replay_without_one_command_differs() -> None:
    bench = rich_run()
    without = [r for r in bench.records if not (r.target == "channel" and r.command == "set_override")]
    texts = replay(MILL, without, len(bench.blocks["x"]))
    assert texts["x"] != rich_bits()["x"]


def test_replay_of_a_run_in_which_sources_were_lost() -> None:
    """In the replay the lost units live; the others must not listen to them."""
    bench = MachineBench("%P\nG01 X100 Y50 F6000\nM30", end_when_idle=False).run(0.5)
    bench.give("x", "upstream_lost", source="channel")
    bench.give("channel", "upstream_lost", source="y")
    bench.run(0.5)
    for name in ("x", "channel"):
        bench.give(name, "reset")
    bench.run(0.2)
    bench.give("channel", "start")
    bench.run(0.5)
    texts, expected = replay(MILL, bench.records, len(bench.blocks["x"])), bits(bench)
    for name in ("channel", "s", "x", "y", "z"):
        assert texts[name] == expected[name], name


def test_ptp_machine_replay() -> None:
    scenario = (
        "- {at: 0, to: x, do: set_override, percent: 20}\n"
        "- {at: 0, to: x, do: move_absolute, target: 5000.0, velocity: 2000.0, acceleration: 5000, jerk: 50000.0}\n"
        "- {at: 2, to: x, do: set_override, percent: 100}\n- {at: 2.5, to: c, do: move_relative, distance: 0.1}\n"
        "- {at: 3, to: x, do: stop}\n"
    )
    bench = MachineBench(None, scenario, machine=PTP).run()
    texts, expected = replay(PTP, bench.records, len(bench.blocks["x"])), bits(bench)
    for name in ("x", "y", "z", "c"):
        assert texts[name] == expected[name]


@pytest.mark.parametrize("arguments", [{"a": 0.1 + 0.2, "b": 1e-300, "c": -0.0, "d": 10**20, "e": "ü\n", "f": True}])
def test_arguments_survive_json(arguments: dict[str, Any]) -> None:
    record = CommandRecord(0, "x", "stop", Command("x", "stop", arguments).arguments_json, True, 0, "")
    assert repr(Command.from_record(record).arguments) == repr(dict(sorted(arguments.items())))


def test_arguments_that_are_no_json_are_recorded_all_the_same() -> None:
    bench = MachineBench(end_when_idle=False).run(0.01)
    assert bench.refused("x", "move_absolute", target={1, 2}) == (
        "P-ERR-22001 axis x: move_absolute refused: target = {1, 2} is not a number; nothing was changed"
    )
    bench.run(0.01)
    assert bench.records[-1].arguments_json == '{"target": "{1, 2}"}'


def test_a_prepared_program_changes_nothing_but_the_time_of_its_start() -> None:
    """Interpreting before the run (what the channel's node does with --program) gives the same bits."""
    plain, prepared = MachineBench(BRACKET), MachineBench(BRACKET)
    channel = prepared.units["channel"]
    channel.prepare("test.nc", BRACKET)
    assert plain.run(3.0).column("x", "set_position") == prepared.run(3.0).column("x", "set_position")
