"""Runs with two channels, shared spindles, gears, couplings and handshakes are the same bits again, and in a replay."""

from __future__ import annotations

from dataclasses import replace

import pytest
from channel_spindle_support import MVS_SLM, MVS_SLP, machine_of, three
from machine_support import MILL, MachineBench
from replay_support import bits, replay

from cnc_ptp.parameters import MachineParameters, Tool, ToolLimits, ToolTable

RANGES = ((50.0, 560.0), (400.0, 800.0), (700.0, 3500.0))
FIRST = r"""%FIRST
N10 T5 D5 S650 M03
N20 G01 X5 F3000 M08
N30 S950 X10
N40 #SET AX LINK[1, S2=S]
N50 #ENABLE AX LINK[1]
N60 M19 S300 S.POS=90
N70 M3 S800 X15
N80 #EXPL SYN
N90 #DISABLE AX LINK
N100 G167 S900 X20
N110 S[M5 M9] S2[M4 REV100]
N120 G74 S1
N130 M30"""
SCENARIO = """
- {at: 0, to: plc, do: auto_acknowledge, enabled: off}
- {at: 0.7, to: s, do: gear_changed}
- {at: 0.9, to: plc, do: auto_acknowledge, enabled: on}
- {at: 1.0, to: s, do: set_override, percent: 80}
- {at: 0.2, to: second, do: mdi, text: "S3[M3 REV1000] G01 Y1 F3000"}
- {at: 1.5, to: second, do: mdi, text: "S[M3 REV100] G01 Y2 F3000"}
- {at: 2.5, to: second, do: reset}
- {at: 3.0, to: second, do: mdi, text: "S3[M5] G01 Y3 F3000"}
- {at: 3.2, to: t, do: start, direction: cw, speed_rpm: 60, source: plc}
"""


def machine() -> MachineParameters:
    spindles = three(ranges=RANGES, automatic=True, m3=MVS_SLM)
    spindles = (spindles[0], spindles[1]._replace(m3=MVS_SLP), spindles[2])
    unit = MILL.spindles["s"]
    geared = replace(unit, gears={stage: replace(unit.gears[1], stage=stage) for stage in (1, 2, 3)})
    both = machine_of(
        *spindles, units={"s": geared}, gear_change=True, tools={5: ToolLimits("s", None, 3000.0, 20000.0)}
    )
    first = both.channels["channel"]
    table = ToolTable({5: Tool(number=5)}, present=True)
    one = replace(first, axes=first.axes[:1], tool_table=table)
    second = replace(first, name="second", axes=first.axes[1:2])
    return replace(both, channels={"channel": one, "second": second})


def rich_run() -> MachineBench:
    return MachineBench(FIRST, SCENARIO, machine=machine()).run()


@pytest.mark.long
def test_two_runs_are_bit_identical() -> None:
    first, second = rich_run(), rich_run()
    assert bits(first) == bits(second) and first.records == second.records and first.events == second.events


def test_the_recorded_commands_reproduce_the_run_bit_for_bit() -> None:
    bench = rich_run()
    commands = {(record.target, record.command) for record in bench.records if record.accepted}
    assert {("s", "select_gear"), ("t", "couple"), ("t", "decouple"), ("s", "orient"), ("s", "home")} <= commands
    assert {("s", "suppress_override"), ("s", "set_limits"), ("second", "mdi")} <= commands
    texts, expected = replay(bench.machine, bench.records, len(bench.blocks["x"])), bits(bench)
    for name in ("channel", "second", "s", "t", "u", "x", "y"):
        assert texts[name] == expected[name], name
