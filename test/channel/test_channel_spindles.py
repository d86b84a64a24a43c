"""Spindles of one and of two channels: main spindle, PLC spindles, tools, program end, two that want the same one."""

from __future__ import annotations

from dataclasses import replace

import pytest
from channel_spindle_support import (
    MANUAL,
    MOS,
    MVS_SVS,
    NO_SYNCH,
    machine_of,
    moves,
    requests,
    run,
    three,
    told,
    told_at,
    two_channels,
)
from machine_support import MILL, MachineBench

from cnc_ptp.parameters import MachineParameters, Tool, ToolLimits, ToolTable
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

# ---------------------------------------------------------------- several spindles of one channel


def test_din_words_go_to_the_main_spindle_whichever_it_is() -> None:
    """The vendor's example of #MAIN SPINDLE: S1, S2, S3 are nodes s, t, u."""
    text = """N10 S100 M3 S2[REV200 M3] S3[REV300 M4]
N20 #MAIN SPINDLE [S2]
N30 S110 M3 S1[REV210 M3] S3[REV310 M4]
N40 #MAIN SPINDLE [30]
N50 S120 M3 S1[REV220 M3] S2[REV320 M4]
N60 #MAIN SPINDLE
N70 S150 M3 S2[REV250 M3] S3[REV350 M4]
N80 M5 S2[M5] S3[M5]"""
    bench = run(text, machine_of(*three()))
    speeds = {
        unit: [
            (words.get("direction"), words.get("speed_rpm"))
            for command, words in told(bench, unit)
            if command == "start"
        ]
        for unit in "stu"
    }
    assert speeds == {
        "s": [("cw", 100.0), ("cw", 210.0), ("cw", 220.0), ("cw", 150.0)],
        "t": [("cw", 200.0), ("cw", 110.0), ("ccw", 320.0), ("cw", 250.0)],
        "u": [("ccw", 300.0), ("ccw", 310.0), ("cw", 120.0), ("ccw", 350.0)],
    }
    assert bench.errors() == [] and all(told(bench, unit)[-1] == ("stop", {}) for unit in "stu")


def test_spindles_of_one_block_start_together_and_all_are_waited_for() -> None:
    bench = run("M3 S1000 S2[M4 REV6000] S3[M3 REV100]\nG01 X1 F3000", machine_of(*three()))
    assert {told_at(bench, "start", unit) for unit in "stu"} == {10}
    slowest = bench.column("t", "speed_reached")
    assert moves(bench)[0][0] > slowest.index(True, 10)


def test_each_spindle_has_its_own_synchronisation() -> None:
    spindles = (three(MOS)[0], three(MVS_SVS)[1])
    quick = run("M3 S6000\nG01 X1 F3000", machine_of(*spindles))
    slow = run("S2[M3 REV6000]\nG01 X1 F3000", machine_of(*spindles))
    assert moves(quick)[0][0] == 1 and moves(slow)[0][0] > 500


# ---------------------------------------------------------------- two channels


def both(first: str, second: str, machine: MachineParameters | None = None, at: float = 0.0) -> MachineBench:
    """Manual blocks for both channels, the second ones `at` s."""
    bench = MachineBench(None, machine=machine or two_channels(), end_when_idle=False).run(0.01)
    bench.give("channel", "mdi", text=first)
    if at:
        bench.run(at)
    bench.give("second", "mdi", text=second)
    return bench.run(3.0)


def test_two_channels_use_different_spindles_at_once() -> None:
    bench = both("M3 S1000\nG01 X1 F3000", "S2[M4 REV500]\nG01 Y1 F3000")
    assert bench.errors() == []
    assert bench.last("s").set_speed_rpm[-1] == pytest.approx(1000.0)
    assert bench.last("t").set_speed_rpm[-1] == pytest.approx(-500.0)
    assert bench.position("x") == bench.position("y") == 1.0


def test_two_channels_that_command_one_spindle_at_once() -> None:
    """The first one gets it; the second one's program is aborted, its axes have not moved."""
    bench = both("M3 S6000\nG01 X1 F3000", "M4 S500\nG01 Y1 F3000")
    assert bench.errors() == [
        "P-ERR-22018 channel second: s has refused a command, P-ERR-24012 spindle s: start refused: the spindle "
        "works for 'channel', 'second' must wait until that is finished; nothing was changed; the path stops on its ramp "
        "and the program is aborted"
    ]
    assert bench.last("second").state[-1] == C.ERROR and bench.position("y") == 0.0
    assert bench.last("s").set_speed_rpm[-1] == pytest.approx(6000.0) and bench.position("x") == 1.0


def test_one_channel_after_the_other_commands_a_spindle() -> None:
    bench = both("M3 S6000\nG01 X1 F3000", "M4 S500\nG01 Y1 F3000", at=2.0)
    assert bench.errors() == [] and bench.last("s").set_speed_rpm[-1] == pytest.approx(-500.0)
    assert bench.position("x") == bench.position("y") == 1.0


def test_a_channel_stops_at_reset_only_what_it_has_set_turning() -> None:
    bench = both("M3 S1000\nG04 10", "S2[M3 REV500]\nG04 10")
    bench.give("second", "reset")
    bench.run(2.0)
    assert bench.last("t").set_speed_rpm[-1] == 0.0
    assert bench.last("s").set_speed_rpm[-1] == pytest.approx(1000.0)


def test_a_third_spindle_is_unknown_in_the_second_channel() -> None:
    bench = both("M3 S100", "S3[M3 REV500]")
    assert bench.refusals() == [
        "P-ERR-20180 mdi line 1 column 1 'S3[M3 REV500]': spindle S3 does not belong to this channel; "
        "its spindles are: S, S2; nothing was executed"
    ]


# ---------------------------------------------------------------- PLC spindles


def test_axis_specific_plc_spindle_is_acknowledged_by_the_plc_alone() -> None:
    """2.2.2: it gets its commands, PLC_INFO needs not be set, its speed is not waited for."""
    units = {"s": replace(MILL.spindles["s"], plc_controlled=True)}
    machine = machine_of(three(MVS_SVS)[0], units=units)
    scenario = MANUAL + "- {at: 0.1, to: plc, do: acknowledge, id: 1}\n- {at: 3, to: plc, do: acknowledge, id: 2}"
    bench = run("M3 S12000\nG01 X1 F3000\nM19 S100 S.POS=45\nX2", machine, scenario)
    assert bench.errors() == []
    first, second = requests(bench)
    assert (first.kind, first.number, first.spindle, first.value, first.acknowledge_needed) == (
        "M",
        3,
        "s",
        12000.0,
        True,
    )
    assert (second.number, second.value, second.position) == (19, 100.0, 45.0)
    assert [move[0] for move in moves(bench)] == [101, 3001]
    assert not bench.column("s", "speed_reached")[101]
    assert told(bench)[0] == ("start", {"direction": "cw", "speed_rpm": 12000.0})


def plc_machine(**types: object) -> MachineParameters:
    """The main spindle has no unit; S2 is an NC spindle."""
    return machine_of(three(**{"node": "", "number": 99, **types})[0], three()[1])


def test_channel_specific_plc_spindle_goes_through_the_channel() -> None:
    """2.2.2.2, P-CHAN-00069: everything is asked of the PLC, there is no unit."""
    scenario = MANUAL + "".join(f"- {{at: {n}, to: plc, do: acknowledge, id: {n}}}\n" for n in (1, 3, 4))
    bench = run("M3 S500\nG01 X1 F3000\nS700\nX2\nM19 S100 S.POS=45 M4\nX3\nM5\nX4", plc_machine(), scenario)
    assert bench.errors() == [] and list(bench.machine.spindles) == ["t"]
    assert [(r.kind, r.number, r.spindle, r.value, r.position, r.direction) for r in requests(bench)] == [
        ("M", 3, "S1", 500.0, 0.0, ""),
        ("S", 0, "S1", 700.0, 0.0, ""),
        ("M", 19, "S1", 100.0, 45.0, "ccw"),
        ("M", 5, "S1", 0.0, 0.0, ""),
    ]
    assert [r.acknowledge_needed for r in requests(bench)] == [True, False, True, True]
    assert moves(bench)[0][0] == 1001 and bench.position("x") == 4.0


def test_channel_specific_plc_spindle_without_synchronisation() -> None:
    bench = run("M3 S500\nG01 X1 F3000", plc_machine(m3=NO_SYNCH))
    assert [(r.kind, r.number, r.acknowledge_needed) for r in requests(bench)] == [("M", 3, False)]
    assert moves(bench)[0][0] == 1


@pytest.mark.parametrize("how", ["reset", "error", "reset of an idle channel"])
def test_the_plc_is_asked_to_stop_its_spindle_when_the_program_is_aborted(how: str) -> None:
    """Nobody waits for its acknowledgement; no command goes out without a receiver."""
    bench = MachineBench(
        "%P\nM3 S500\nG01 X100 F3000\nM30",
        machine=plc_machine(),
        start=how != "reset of an idle channel",
        end_when_idle=False,
    )
    if how == "reset of an idle channel":
        bench.run(0.02)
        bench.give("channel", "mdi", text="M3 S500")
    bench.run(0.5)
    if how == "error":
        bench.give("channel", "upstream_lost", source="x")
    else:
        bench.give("channel", "reset")
    bench.run(1.0)
    first, last = requests(bench)
    assert (first.kind, first.number, first.spindle, first.acknowledge_needed) == ("M", 3, "S1", True)
    assert (last.kind, last.number, last.spindle, last.acknowledge_needed) == ("M", 5, "S1", False)
    assert last.line == (1 if how == "reset of an idle channel" else 3) and last.cycle >= 500
    assert {command.target for block in bench.blocks["channel"] for command in block.commands} <= {"x", "y", "z", "t"}


def test_the_plc_hears_of_the_end_of_an_axis_specific_plc_spindle_too() -> None:
    units = {"s": replace(MILL.spindles["s"], plc_controlled=True)}
    bench = MachineBench("%P\nM3 S500\nG01 X100 F3000\nM30", machine=machine_of(three()[0], units=units)).run(0.5)
    bench.give("channel", "reset")
    bench.run(1.0)
    assert [(r.kind, r.number, r.spindle, r.acknowledge_needed) for r in requests(bench)] == [
        ("M", 3, "s", True),
        ("M", 5, "s", False),
    ]
    assert told(bench)[-1] == ("stop", {}) and bench.last("s").set_speed_rpm[-1] == 0.0


def test_beside_a_plc_spindle_an_nc_spindle_turns() -> None:
    bench = run("M3 S500 S2[M3 REV200]", plc_machine())
    assert told(bench, "t")[0] == ("start", {"direction": "cw", "speed_rpm": 200.0}) and bench.errors() == []


# ---------------------------------------------------------------- tools


def test_a_tool_gives_its_limits_to_the_spindle_that_carries_it() -> None:
    tools = {5: ToolLimits("s", 10.0, 500.0, 3000.0), 6: ToolLimits("t", None, 100.0, None)}
    table = ToolTable({number: Tool(number) for number in (5, 6, 7)}, complete=True)
    machine = machine_of(*three(), tools=tools, tool_table=table)
    bench = run("T5 D5\nM3 S2000\nG04 1\nT6 D6\nD0\nD7\nM5\nS[DEFAULT_DYNAMIC_DATA]", machine)
    assert told(bench)[0] == (
        "set_limits",
        {"min_speed_rpm": 10.0, "max_speed_rpm": 500.0, "max_acceleration": 3000.0},
    )
    assert told(bench, "t") == [("set_limits", {"max_speed_rpm": 100.0})]
    assert told(bench)[-1] == ("reset_limits", {})
    assert max(bench.column("s", "set_speed_rpm")) == pytest.approx(500.0)
    assert max(bench.column("s", "set_acceleration_deg_s2")) == pytest.approx(3000.0)
    assert [request.number for request in requests(bench) if request.kind == "D"] == [5, 6, 0, 7]


# ---------------------------------------------------------------- program end and errors


def test_a_turning_spindle_turns_on_at_the_program_end() -> None:
    bench = MachineBench("%P\nM3 S500\nM30", end_when_idle=False).run(2.0)
    assert bench.last("channel").done and bench.last("s").set_speed_rpm[-1] == pytest.approx(500.0)


def test_spindle_stop_at_program_end() -> None:
    """2.4.3: the flag of the HLI is one of each spindle."""
    bench = MachineBench(
        "%P\nM3 S500 S2[M3 REV600]\nG01 X1 F3000\nM30",
        "- {at: 0, to: s, do: stop_at_program_end, enabled: on}",
        machine=machine_of(*three()),
        end_when_idle=False,
    ).run(3.0)
    assert bench.last("s").set_speed_rpm[-1] == 0.0
    assert bench.last("t").set_speed_rpm[-1] == pytest.approx(600.0)
    assert told(bench)[-1] == ("stop", {}) and told_at(bench, "stop") > moves(bench)[0][1]


def test_the_flag_does_not_stop_what_another_channel_turns() -> None:
    bench = MachineBench(
        None, "- {at: 0, to: s, do: stop_at_program_end, enabled: on}", machine=two_channels(), end_when_idle=False
    ).run(0.02)
    bench.give("channel", "mdi", text="M3 S500")
    bench.run(1.0)
    bench.give("second", "mdi", text="G01 Y1 F3000 M30")
    bench.run(1.0)
    assert bench.last("s").set_speed_rpm[-1] == pytest.approx(500.0)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("M19 S.POS=5", "P-ERR-70252 test.nc line 2 column 1 'M19 S.POS=5': {} positioned; nothing was started"),
        ("G74 S1", "P-ERR-24008 test.nc line 2 column 1 'G74 S1': {} homed; nothing was started"),
    ],
)
def test_a_sensorless_spindle_is_not_positioned(text: str, reason: str) -> None:
    units = {"s": replace(MILL.spindles["s"], feedback="NONE", open_loop=True)}
    bench = MachineBench(f"%P\n{text}\nM30", machine=machine_of(three()[0], units=units), end_when_idle=False).run(0.1)
    why = "spindle S has no actual position (P-AXIS-00320, P-SIM-00050) and cannot be"
    assert bench.refusals() == [reason.format(why)]


def test_a_direction_against_the_preferred_one_aborts_the_program() -> None:
    units = {"s": replace(MILL.spindles["s"], preferred_direction=1)}
    bench = MachineBench(
        "%P\nM4 S100\nG01 X1 F3000\nM30", machine=machine_of(three()[0], units=units), end_when_idle=False
    ).run(1.0)
    assert [text.partition(":")[0] for text in bench.errors()] == [
        "P-ERR-60254 spindle s",
        "P-ERR-22012 channel channel",
    ]
    assert bench.position("x") == 0.0
