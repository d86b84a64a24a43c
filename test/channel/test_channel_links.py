"""Synchronous operation of spindles from a program: slaves do what their masters are commanded, the path waits for all."""

from __future__ import annotations

from dataclasses import replace

import pytest
from channel_spindle_support import (
    MVS_SVS,
    PLC_INFO,
    machine_of,
    moves,
    reported,
    requests,
    run,
    three,
    told,
    told_at,
    two_channels,
)
from machine_support import MILL, MachineBench
from spindle_support import two_gears

from cnc_ptp.parameters import MachineParameters

ENABLE = "#SET AX LINK[1, S2=S, S3=S]\n#ENABLE AX LINK[1]\n"
SLOW = replace(MILL.spindles["s"], name="t", gears={1: replace(MILL.spindles["s"].gears[1], acceleration=6000.0)})
"""A spindle that needs six times as long as the others."""


def linked(**main: object) -> MachineParameters:
    return machine_of(*three(**main), units={"t": SLOW})


def test_slaves_start_with_their_master_and_the_path_waits_for_the_slowest() -> None:
    bench = run(ENABLE + "M3 S3000\nG01 X1 F3000\nM5", linked())
    assert bench.errors() == []
    assert [command for command, _ in told(bench)][:1] == ["start"]
    assert [command for command, _ in told(bench, "t")] == ["couple", "coupling_answer", "decouple"]
    for unit in "stu":
        assert max(bench.column(unit, "set_speed_rpm")) > 2700.0  # M5 comes when all are within 10 %
        assert bench.last(unit).set_speed_rpm[-1] == 0.0
    start = told_at(bench, "start")
    for unit in "stu":
        speed = bench.column(unit, "set_speed_rpm")
        assert speed[start] == 0.0 and speed[start + 1] > 0.0
    assert moves(bench)[0][0] == reported(bench, "t", "speed_reached", start) + 1


def test_the_program_goes_on_when_the_coupling_stands() -> None:
    bench = run(ENABLE + "G01 X1 F3000", linked())
    coupled = [block.first_cycle for block in bench.blocks["t"] if block.master == "s"]
    assert told_at(bench, "couple", "t") == 10 and moves(bench)[0][0] == coupled[0] + 11
    assert coupled[-1] < told_at(bench, "decouple", "t") <= moves(bench)[0][1] + 20


def test_positioning_and_homing_are_done_by_the_slaves_too() -> None:
    bench = run(ENABLE + "M19 S100 S.POS=90\nG01 X1 F3000\nS[G74]", linked())
    assert bench.errors() == []
    for unit in "stu":
        assert bench.column(unit, "actual_position_deg")[moves(bench)[0][0]] == pytest.approx(90.0, abs=0.2)
    assert bench.last("t").referenced[-1]


def test_the_plc_hears_of_the_master_only() -> None:
    bench = run(ENABLE + "M3 S300", machine_of(*three(MVS_SVS | PLC_INFO)))
    assert [(request.number, request.spindle) for request in requests(bench)] == [(3, "s")]


def test_after_the_coupling_a_slave_has_a_life_of_its_own() -> None:
    bench = run(ENABLE + "M3 S3000\n#DISABLE AX LINK\nM5\nS2[M4]\nG04 1", linked())
    assert bench.errors() == [] and told(bench, "t")[-2:] == [
        ("start", {"direction": "ccw", "speed_rpm": 3000.0}),
        ("stop", {}),
    ]
    assert max(bench.column("u", "set_speed_rpm")[-1000:]) == pytest.approx(3000.0)


def test_default_coupling_pairs() -> None:
    """Coupling group 0 of P-CHAN-00037, 00038 is there without a definition."""
    bench = run("#ENABLE AX LINK[0]\nM3 S600", machine_of(*three(), coupled=(("S3", "S"),)))
    assert max(bench.column("u", "set_speed_rpm")) == pytest.approx(600.0)
    assert max(bench.column("t", "set_speed_rpm")) == 0.0


def test_the_speed_has_to_suit_the_slaves() -> None:
    bench = MachineBench(f"%P\n{ENABLE}M3 S12500\nM30", machine=linked(), end_when_idle=False).run(0.1)
    assert bench.refusals() == [
        "P-ERR-22010 test.nc line 4 column 4 'M3 S12500': spindle S: 12500 rpm is above the maximum 12000 rpm "
        "(P-AXIS-00212); nothing was started"
    ]
    weak = replace(SLOW, gears={1: replace(SLOW.gears[1], max_speed=6000.0)})
    machine = machine_of(*three(), units={"t": weak})
    bench = MachineBench(f"%P\n{ENABLE}M3 S1500\nM30", machine=machine, end_when_idle=False).run(0.1)
    assert bench.refusals() == [
        "P-ERR-22010 test.nc line 4 column 4 'M3 S1500': spindle S2: 1500 rpm is above the maximum 1000 rpm "
        "(P-AXIS-00212); nothing was started"
    ]


@pytest.mark.parametrize("how", ["reset", "error"])
def test_an_aborted_program_ends_its_couplings_and_stops_all(how: str) -> None:
    bench = MachineBench(f"%P\n{ENABLE}M3 S3000\nG04 9\nM30", machine=linked(), end_when_idle=False).run(2.0)
    if how == "reset":
        bench.give("channel", "reset")
    else:
        bench.give("channel", "upstream_lost", source="x")
    bench.run(4.0)
    assert [bench.last(unit).master for unit in "stu"] == ["", "", ""]
    assert [bench.last(unit).set_speed_rpm[-1] for unit in "stu"] == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("source", ["", ", source: plc"])
def test_an_aborted_program_lets_nothing_wait_for_the_gear_change_of_a_slave(source: str) -> None:
    """The PLC changes the gear of t, which it has begun itself, when s is no longer driven."""
    scenario = f"""
- {{at: 0.0, to: plc, do: auto_acknowledge, enabled: off}}
- {{at: 0.01, to: t, do: select_gear, stage: 2{source}}}
- {{at: 1.0, to: channel, do: reset}}
- {{at: 1.5, to: t, do: gear_changed}}
"""
    program = "#SET AX LINK[1, S2=S]\n#ENABLE AX LINK[1]\nG04 X0.3\nM3 S1000\nG01 X20 F6000"
    machine = machine_of(*three(), units={"t": replace(two_gears(), name="t")})
    bench = MachineBench(f"%P\n{program}\nM30", scenario, machine=machine, end_when_idle=False).run(3.0)
    assert bench.errors() == [] and max(bench.column("s", "set_speed_rpm")) == pytest.approx(1000.0)
    assert bench.last("t").gear[-1] == 2 and set(bench.column("t", "set_speed_rpm")) == {0.0}


def test_manual_blocks_keep_a_coupling_until_a_program_begins() -> None:
    bench = MachineBench("%P\nM3 S600\nM30", machine=linked(), start=False, end_when_idle=False).run(0.05)
    bench.give("channel", "mdi", text=ENABLE)
    bench.run(0.1)
    bench.give("channel", "mdi", text="M3 S300")
    bench.run(1.0)
    assert [bench.last(unit).set_speed_rpm[-1] for unit in "tu"] == [pytest.approx(300.0)] * 2
    assert bench.give("channel", "start").accepted
    bench.run(1.0)
    assert bench.errors() == [] and [bench.last(unit).master for unit in "tu"] == ["", ""]
    assert bench.last("s").set_speed_rpm[-1] == pytest.approx(600.0)


def test_definitions_stay_for_the_next_program() -> None:
    bench = MachineBench(f"%P\n{ENABLE}M30", machine=linked(), end_when_idle=False).run(0.5)
    bench.give("channel", "load", program="b.nc", text="%B\n#ENABLE AX LINK[1]\nM3 S300\nM30")
    assert bench.give("channel", "start").accepted
    bench.run(1.0)
    assert bench.last("u").set_speed_rpm[-1] == pytest.approx(300.0)


def test_a_coupling_that_the_plc_does_not_grant_is_an_error() -> None:
    """The second channel wants a slave of the first one as its master."""
    bench = MachineBench(None, machine=two_channels(), end_when_idle=False).run(0.01)
    bench.give("channel", "mdi", text="#SET AX LINK[1, S2=S]\n#ENABLE AX LINK[1]")
    bench.run(0.1)
    bench.give("second", "mdi", text="#MAIN SPINDLE[S2]\n#SET AX LINK[1, S1=S]\n#ENABLE AX LINK[1]")
    bench.run(0.2)
    assert bench.errors() == [
        "P-ERR-22019 channel second: spindle s was not coupled to t in mdi line 3 '#ENABLE AX LINK[1]'; "
        "the path stops on its ramp and the program is aborted"
    ]
    assert bench.last("t").master == "s" and bench.last("s").master == ""


@pytest.mark.parametrize(
    ("ratio", "speed"), [("2, 1", 600.0), ("1, 4", 75.0), ("-1, 2", -150.0), ("1.5, -0.5", -900.0)]
)
def test_a_slave_turns_by_the_ratio_of_its_coupling(ratio: str, speed: float) -> None:
    """#SET AX LINK [g, s=m, num, den]: the path waits for the speed that the slave itself has to reach."""
    define = f"#SET AX LINK[1, S2=S, {ratio}, S3=S]\n#ENABLE AX LINK[1]\n"
    bench = run(define + "M3 S300\nG01 X1 F3000\nG04 0.1\nM5", machine_of(*three()))
    assert bench.errors() == []
    begin = moves(bench)[0][0]
    assert [bench.column(unit, "set_speed_rpm")[begin + 20] for unit in "stu"] == pytest.approx([300.0, speed, 300.0])
    couple = next(arguments for command, arguments in told(bench, "t") if command == "couple")
    assert couple["factor_num"] / couple["factor_den"] == speed / 300.0


def test_a_slave_is_positioned_by_the_ratio_of_its_coupling() -> None:
    bench = run(
        "#SET AX LINK[1, S2=S, 3, 2]\n#ENABLE AX LINK[1]\nM19 S100 S.POS=90\nG01 X1 F3000", machine_of(*three())
    )
    assert bench.errors() == []
    begin = moves(bench)[0][0]
    for unit, position in (("s", 90.0), ("t", 135.0)):
        assert bench.column(unit, "actual_position_deg")[begin] % 360.0 == pytest.approx(position, abs=0.05)
