"""G166: a motion without override; feed hold stops it all the same."""

from __future__ import annotations

import pytest
from machine_support import MachineBench

from cnc_ptp.protocol.channel_states import ChannelStateCode as C


def run(program: str, scenario: str = "") -> MachineBench:
    return MachineBench(program, scenario).run()


def fastest(bench: MachineBench, line: int) -> float:
    rows = zip(bench.column("channel", "line"), bench.column("channel", "path_velocity"), strict=True)
    return max(velocity for number, velocity in rows if number == line)


PROGRAM = "G1 X40 F3000\nG166 X80\nX120\nG166 G2 X120 I10\nG1 X80\nM30"


def test_it_counts_for_its_block() -> None:
    bench = run(PROGRAM, "- {at: 0, to: channel, do: set_override, percent: 50}\n")
    assert bench.errors() == bench.refusals() == []
    assert [fastest(bench, line) for line in range(1, 6)] == pytest.approx([25.0, 50.0, 25.0, 50.0, 25.0])


def test_an_override_in_motion_counts_from_the_next_block_on() -> None:
    bench = run("G166 G1 X40 F3000\nX80\nM30", "- {at: 0.3, to: channel, do: set_override, percent: 10}\n")
    assert bench.errors() == []
    assert (fastest(bench, 1), fastest(bench, 2)) == pytest.approx((50.0, 5.0))
    velocities = bench.column("channel", "path_velocity")
    lines = bench.column("channel", "line")
    slow = [v for v, line in zip(velocities, lines, strict=True) if line == 1 and v > 49.9]
    assert len(slow) > 500


def test_override_0_does_not_stop_it_but_the_next_block() -> None:
    scenario = "- {at: 0.1, to: channel, do: set_override, percent: 0}\n- {at: 3, to: channel, do: set_override, percent: 100}\n"
    bench = run("G166 G1 X40 F3000\nX80\nM30", scenario)
    assert bench.errors() == [] and bench.position("x") == 80.0
    assert bench.column("x", "set_position")[2500] == 40.0


def test_a_feed_hold_stops_it() -> None:
    scenario = "- {at: 0.3, to: channel, do: feed_hold, enabled: true}\n- {at: 1.3, to: channel, do: feed_hold, enabled: false}\n"
    bench = run("G166 G1 X40 F3000\nM30", "- {at: 0, to: channel, do: set_override, percent: 50}\n" + scenario)
    assert bench.errors() == [] and bench.position("x") == 40.0
    assert C.HOLD in bench.states("channel")
    assert bench.column("channel", "path_velocity")[1200] == 0.0 and fastest(bench, 1) == pytest.approx(50.0)


def test_without_it_nothing_is_different_after_a_reset() -> None:
    scenario = (
        "- {at: 0, to: channel, do: set_override, percent: 50}\n- {at: 0.3, to: channel, do: reset}\n"
        '- {at: 1, to: channel, do: mdi, text: "G1 Y20 F3000"}\n'
    )
    bench = run("G166 G1 X40 F3000\nM30", scenario)
    assert max(bench.column("y", "set_velocity")) == pytest.approx(25.0)
