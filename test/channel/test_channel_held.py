"""A program that override 0 lets wait tells what it waits for: once, and in the block after."""

from __future__ import annotations

from itertools import count

import pytest
from channel_spindle_support import MOS, channel_spindle, machine_of, run, three
from machine_support import MachineBench
from spindle_support import two_gears

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

HOLD_S = "- {at: 0, to: s, do: set_override, percent: 0}\n"
RELEASE_S = "- {at: 1, to: s, do: set_override, percent: 100}\n"


def told(bench: MachineBench) -> list[tuple[int, str]]:
    """Line and text of each warning 22024."""
    return [(event.line, event.text) for event in bench.events if event.error_id == 22024]


def waits(line: int, what: str) -> tuple[int, str]:
    return line, f"channel channel: the program waits in line {line} for {what}"


def cycle_of(bench: MachineBench) -> int:
    """At which the only warning came."""
    (event,) = [event for event in bench.events if event.error_id == 22024]
    return event.cycle


def next_block(cycle: int) -> int:
    return (cycle // 10 + 1) * 10


@pytest.mark.parametrize(
    ("words", "what"),
    [
        ("M3 S1000", "the speed of spindle s"),
        ("M19 S100 S.POS=90", "the position of spindle s"),
    ],
)
def test_a_spindle_that_override_0_holds(words: str, what: str) -> None:
    bench = run(f"{words}\nG1 X5 F3000\nM5", machine_of(channel_spindle("S", "s", 4)), HOLD_S + RELEASE_S)
    assert told(bench) == [waits(2, f"{what}, which is held by override 0")] and bench.errors() == []
    moves = (S.CONTINUOUS_MOTION, S.DISCRETE_MOTION)
    first = next(cycle for cycle, state in enumerate(bench.column("s", "state")) if state in moves)
    assert cycle_of(bench) == next_block(first) and bench.position("x") == 5.0


def test_a_spindle_without_override_is_not_held() -> None:
    """G167; what is waited for is the position window."""
    bench = run("M19 G167 S100 S.POS90\nG04 0.1", machine_of(channel_spindle("S", "s", 4)), HOLD_S)
    assert told(bench) == [] and bench.errors() == []


def test_a_spindle_that_stops_on_its_way_up() -> None:
    """It is reported when the spindle has come to rest, not before."""
    scenario = "- {at: 0.1, to: s, do: set_override, percent: 0}\n" + RELEASE_S
    bench = run("M3 S10000\nG1 X5 F3000\nM5", machine_of(channel_spindle("S", "s", 4)), scenario)
    assert told(bench) == [waits(2, "the speed of spindle s, which is held by override 0")]
    speeds = bench.column("s", "set_speed_rpm")
    assert cycle_of(bench) == next_block(next(cycle for cycle in count(100) if speeds[cycle] == 0.0))


def test_a_gear_change_that_override_0_holds_on_its_way() -> None:
    machine = machine_of(channel_spindle("S", "s", 4), units={"s": two_gears()})
    scenario = "- {at: 0.1, to: s, do: set_override, percent: 0}\n- {at: 0.1, to: s, do: select_gear, stage: 2}\n"
    bench = run("G04 0.2\nM3 S100\nG1 X5 F3000\nM5", machine, scenario + RELEASE_S)
    assert told(bench) == [waits(3, "the speed of spindle s, which is held by override 0")] and bench.errors() == []


def test_each_spindle_that_is_held_is_told() -> None:
    held = HOLD_S + HOLD_S.replace("to: s", "to: t")
    bench = run(
        "M3 S1000 S2[M3 REV500]\nG1 X5 F3000\nM5 S2[M5]",
        machine_of(*three()),
        held + RELEASE_S + RELEASE_S.replace("at: 1, to: s", "at: 2, to: t"),
    )
    assert told(bench) == [waits(2, f"the speed of spindle {name}, which is held by override 0") for name in ("s", "t")]


def test_a_coupling_does_not_depend_on_the_override() -> None:
    program = "S2[M3 REV500]\n#SET AX LINK[1, S2=S]\n#ENABLE AX LINK[1]\n#DISABLE AX LINK[1]\nS2[M5]"
    scenario = "- {at: 0, to: t, do: set_override, percent: 0}\n"
    bench = run(program, machine_of(*three(MOS)), scenario)
    assert told(bench) == [] and bench.errors() == []


def test_a_path_that_override_0_holds() -> None:
    """Once each time; a feed hold takes its place without a word, and what it leaves behind is reported anew."""
    scenario = """
- {at: 0.3, to: channel, do: set_override, percent: 0}
- {at: 1, to: channel, do: feed_hold, enabled: on}
- {at: 1.5, to: channel, do: set_override, percent: 100}
- {at: 2, to: channel, do: feed_hold, enabled: off}
- {at: 2.3, to: channel, do: set_override, percent: 0}
- {at: 3, to: channel, do: set_override, percent: 100}
"""
    bench = run("G1 X50 F1200", machine_of(channel_spindle("S", "s", 4)), scenario)
    assert told(bench) == [waits(2, "a path override above 0")] * 2 and bench.errors() == []
    states = bench.column("channel", "state")
    held = [cycle for cycle, state in enumerate(states) if state == C.HOLD and states[cycle - 1] != C.HOLD]
    told_at = [event.cycle for event in bench.events if event.error_id == 22024]
    assert told_at == [-(-cycle // 10) * 10 for cycle in held] and len(held) == 2


def test_a_feed_hold_a_dwell_and_an_override_between_programs_are_no_news() -> None:
    scenario = """
- {at: 0.1, to: channel, do: feed_hold, enabled: on}
- {at: 0.5, to: channel, do: feed_hold, enabled: off}
- {at: 1.2, to: channel, do: set_override, percent: 0}
- {at: 1.4, to: channel, do: set_override, percent: 100}
"""
    bench = run("G1 X5 F3000\nG04 3", machine_of(channel_spindle("S", "s", 4)), scenario)
    assert told(bench) == [] and bench.errors() == [] and bench.position("x") == 5.0
