"""A path that waits for a spindle which somebody else commands, too: it never starts on one that does something else."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from channel_spindle_support import (
    MANUAL,
    MOS,
    MVS_SLM,
    MVS_SLP,
    MVS_SVS,
    PLC_INFO,
    channel_spindle,
    machine_of,
    moves,
    run,
    three,
    told,
    told_at,
    two_channels,
)
from long_support import long
from machine_support import MachineBench
from spindle_support import RPM, UP, StuckDrive, two_gears

from cnc_ptp.parameters import MachineParameters, Synchronisation
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

LINK = "#SET AX LINK[1, S2=S]\n#ENABLE AX LINK[1]\n"
GEAR_RANGES = ((50.0, 560.0), (400.0, 800.0))


def mill(**types: Synchronisation) -> MachineParameters:
    """One spindle with two gears and these types; what is not named is MOS."""
    return machine_of(channel_spindle("S", "s", 4, MOS, **types), units={"s": two_gears()})


def aborted(bench: MachineBench, does: str, line: int, text: str) -> None:
    """The program was aborted because spindle s `does`; the path has not moved."""
    assert bench.errors() == [
        f"P-ERR-22021 channel channel: spindle s does not {does}; the path waited for it in test.nc line {line} '{text}'; "
        "the path stops on its ramp and the program is aborted"
    ]
    assert moves(bench) == [] and bench.last("channel").state[-1] == C.ERROR


def speed_at_the_move(bench: MachineBench, unit: str = "s", move: int = 0) -> float:
    return float(bench.column(unit, "actual_speed_rpm")[moves(bench)[move][0]])


# ---------------------------------------------------------------- in place of what the channel has commanded


@pytest.mark.parametrize(
    ("command", "does"),
    [
        ("do: stop", "it is in Stopping"),
        ("do: reset", "it is in Stopping"),
        ("do: start, direction: cw, speed_rpm: 300", "it was commanded to 300 rpm"),
        ("do: start, direction: ccw, speed_rpm: 10000", "it was commanded to -10000 rpm"),
        ("do: orient, position_deg: 10", "it is in DiscreteMotion"),
        ("do: home", "it is in Homing"),
    ],
)
def test_another_command_while_the_path_waits_for_a_speed(command: str, does: str) -> None:
    bench = run("M3 S10000\nG01 X20 F6000\nM5", mill(m3=MVS_SVS), f"- {{at: 0.1, to: s, {command}}}")
    aborted(bench, f"turn at 10000 rpm as commanded, {does}", 2, "M3 S10000")


@pytest.mark.parametrize(
    ("command", "does"),
    [
        ("do: stop", "it is in Standstill"),
        ("do: orient, position_deg: 200", "it was commanded to -160 deg"),
        ("do: start, direction: ccw, speed_rpm: 500", "it was commanded to -500 rpm"),
    ],
)
def test_another_command_while_the_path_waits_for_a_position(command: str, does: str) -> None:
    bench = run("M19 S50 S.POS=300\nG01 X20 F6000", mill(m19=MVS_SVS), f"- {{at: 0.05, to: s, {command}}}")
    aborted(bench, f"go to 300 deg as commanded, {does}", 2, "M19 S50 S.POS=300")


def test_another_command_while_the_path_waits_for_standstill() -> None:
    bench = run(
        "M3 S10000\nG04 X2\nM5\nG01 X20 F6000",
        mill(m5=MVS_SVS),
        "- {at: 2.1, to: s, do: start, direction: cw, speed_rpm: 300}",
    )
    aborted(bench, "stop as commanded, it was commanded to 300 rpm", 4, "M5")


@pytest.mark.parametrize("at", [2.05, *long([2.3])])
def test_the_plc_positions_a_spindle_that_was_to_stop(at: float) -> None:
    """Its command waits until M5 is finished, or comes after it; the path continues when the spindle is at a standstill."""
    scenario = f"- {{at: {at}, to: s, do: orient, position_deg: 90, speed_rpm: 5, source: plc}}"
    bench = run("M3 S10000\nG04 X2\nM5\nG01 X20 F6000", mill(m5=MVS_SVS), scenario)
    assert bench.errors() == [] and bench.column("s", "state")[moves(bench)[0][0]] == S.STANDSTILL
    assert bench.last("s").plc_acknowledged == 1


def test_a_gear_change_that_somebody_gives_up() -> None:
    machine = machine_of(
        *three(ranges=GEAR_RANGES, automatic=False), units={"s": two_gears(change_position=180.0)}, gear_change=True
    )
    bench = run("M41 S600 M3\nG01 X20 F6000", machine, "- {at: 0.1, to: s, do: stop}")
    aborted(bench, "change to gear 2 as commanded, it is in Stopping", 2, "M41 S600 M3")


@pytest.mark.parametrize(("command", "by"), [("do: stop", "stop"), ("do: power, enabled: off", "power off")])
def test_a_gear_change_that_is_overtaken_while_the_plc_changes(command: str, by: str) -> None:
    """The speed of the same block does not come: the spindle stays at rest, with power again too."""
    machine = machine_of(*three(ranges=GEAR_RANGES, automatic=False), units={"s": two_gears()}, gear_change=True)
    scenario = MANUAL + f"- {{at: 0.5, to: s, {command}}}\n- {{at: 0.8, to: s, do: power, enabled: on}}\n"
    bench = run("M41 S600 M3\nG01 X20 F6000", machine, scenario + "- {at: 1, to: s, do: gear_changed}")
    overtaken = f"spindle s: {by} while the PLC changes the gear for 'channel'; the spindle stays at rest"
    assert bench.errors() == [
        f"P-ERR-22018 channel channel: s has refused a command, P-ERR-24017 {overtaken}; the path stops on its ramp and "
        "the program is aborted"
    ]
    assert moves(bench) == [] and not any(bench.column("s", "set_speed_rpm")[500:])


def test_a_stop_while_the_plc_has_not_acknowledged() -> None:
    scenario = MANUAL + "- {at: 0.1, to: s, do: stop}\n"
    bench = run("M3 S1000\nG01 X20 F6000", mill(m3=MVS_SVS | PLC_INFO), scenario)
    aborted(bench, "turn at 1000 rpm as commanded, it is in Stopping", 2, "M3 S1000")


@pytest.mark.parametrize(
    ("kind", "line", "text"), [(MVS_SLM, 4, "G01 X20 F6000"), (MVS_SLP, 4, "#EXPL SYN"), (MVS_SLP, 5, "M30")]
)
def test_a_stop_before_a_late_synchronisation(kind: Synchronisation, line: int, text: str) -> None:
    """The path comes to the place where it would wait long after the stop."""
    program = (
        "M3 S1000\nG04 X1\n" + {"G01 X20 F6000": text, "#EXPL SYN": f"{text}\nG01 X20 F6000", "M30": "G04 X0.1"}[text]
    )
    bench = run(program, mill(m3=kind), "- {at: 0.5, to: s, do: stop}")
    aborted(bench, "turn at 1000 rpm as commanded, it is in Standstill", line, text)


def test_a_slave_that_somebody_stops() -> None:
    bench = run(LINK + "M3 S10000\nG01 X20 F6000", machine_of(*three()), "- {at: 0.2, to: t, do: stop}")
    assert bench.errors() == [
        "P-ERR-22021 channel channel: spindle t does not turn at 10000 rpm as commanded, it is in Stopping; the path "
        "waited for it in test.nc line 4 'M3 S10000'; the path stops on its ramp and the program is aborted"
    ]
    assert moves(bench) == []


def test_a_slave_without_power() -> None:
    scenario = "- {at: 0.1, to: t, do: power, enabled: off}"
    bench = run(LINK + "G04 X0.3\nM3 S1000\nG01 X20 F6000", machine_of(*three()), scenario)
    text = (
        "P-ERR-24025 spindle t: cannot carry out 'start' of its master s: the spindle is in Disabled; power it on; "
        "nothing was changed"
    )
    assert bench.errors() == [
        text,
        f"P-ERR-22018 channel channel: t has refused a command, {text}; the path stops on its ramp and the program is "
        "aborted",
    ]
    assert moves(bench) == [] and bench.last("s").set_speed_rpm[-1] == 0.0


# ---------------------------------------------------------------- the path waits until it is the command's turn


def test_m3_behind_a_gear_change_of_somebody_else() -> None:
    scenario = MANUAL + "- {at: 0.3, to: s, do: select_gear, stage: 2}\n- {at: 3, to: s, do: gear_changed}"
    bench = run("G04 X0.5\nM3 S1000\nG01 X20 F6000", mill(m3=MVS_SVS), scenario)
    assert bench.errors() == [] and moves(bench)[0][0] > told_at(bench, "gear_changed") == 3000
    assert speed_at_the_move(bench) == pytest.approx(1000.0, rel=0.1)


def test_a_gear_change_of_somebody_else_while_the_spindle_runs_up() -> None:
    """Afterwards the spindle continues at the speed of the channel."""
    scenario = MANUAL + "- {at: 0.1, to: s, do: select_gear, stage: 2}\n- {at: 3, to: s, do: gear_changed}"
    bench = run("M3 S10000\nG01 X20 F6000", mill(m3=MVS_SVS), scenario)
    assert bench.errors() == [] and moves(bench)[0][0] > 3000
    assert speed_at_the_move(bench) == pytest.approx(10000.0, rel=0.1)


def test_m19_behind_a_gear_change_of_somebody_else() -> None:
    """At the change position the spindle is not in position for the channel."""
    scenario = MANUAL + "- {at: 0.3, to: s, do: select_gear, stage: 2}\n- {at: 3, to: s, do: gear_changed}"
    bench = run("G04 X0.5\nM19 S100 S.POS=90\nG01 X20 F6000", mill(m19=MVS_SVS), scenario)
    assert bench.errors() == [] and moves(bench)[0][0] > 3000
    assert bench.column("s", "actual_position_deg")[moves(bench)[0][0]] % 360.0 == pytest.approx(90.0, abs=0.2)


def test_m3_behind_a_gear_change_and_commands_of_the_plc() -> None:
    scenario = MANUAL + (
        "- {at: 0.3, to: s, do: select_gear, stage: 2}\n"
        "- {at: 0.4, to: s, do: start, direction: ccw, speed_rpm: 1000, source: plc}\n"
        "- {at: 0.4, to: s, do: orient, position_deg: 90, source: plc}\n"
        "- {at: 2, to: s, do: gear_changed}\n"
    )
    bench = run("G04 X0.5\nM3 S1000\nG01 X20 F6000", mill(m3=MVS_SVS), scenario)
    assert bench.errors() == [] and speed_at_the_move(bench) == pytest.approx(1000.0, rel=0.1)
    assert bench.last("s").plc_acknowledged == 2


def test_a_slave_in_a_gear_change_of_its_own() -> None:
    machine = machine_of(*three(), units={"t": replace(two_gears(), name="t")})
    scenario = MANUAL + "- {at: 0.02, to: t, do: select_gear, stage: 2}\n- {at: 2, to: t, do: gear_changed}"
    bench = run(LINK + "G04 X0.3\nM3 S1000\nG01 X20 F6000", machine, scenario)
    assert bench.errors() == [] and moves(bench)[0][0] > 2000
    assert [speed_at_the_move(bench, unit) for unit in "st"] == [pytest.approx(1000.0, rel=0.1)] * 2


def test_override_0_makes_the_path_wait() -> None:
    scenario = "- {at: 0.1, to: s, do: set_override, percent: 0}\n- {at: 2, to: s, do: set_override, percent: 100}"
    bench = run("M3 S10000\nG01 X20 F6000", mill(m3=MVS_SVS), scenario)
    assert bench.errors() == [] and moves(bench)[0][0] > 2000
    assert speed_at_the_move(bench) == pytest.approx(10000.0, rel=0.1)


@pytest.mark.interpreted
def test_a_speed_that_never_comes_ends_in_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """A drive that makes 400 rpm at most; 5 s (P-MACH-00050) after the setpoint has got to 1000 rpm."""
    drive = StuckDrive(stuck=False, limit=400.0 * RPM)
    monkeypatch.setattr("cnc_ptp.spindle.spindle_unit.make_drive", lambda *_: drive)
    bench = run("M3 S1000\nG01 X20 F6000", machine_of(channel_spindle("S", "s", 4, MVS_SVS)))
    text = "spindle s: speed 1000 rpm was not reached 5 s after the setpoint (P-AXIS-00217, P-MACH-00050)"
    assert bench.errors() == [
        f"P-ERR-24013 {text}; the spindle stops on its ramp (ErrorStop)",
        "P-ERR-22012 channel channel: s is in error P-ERR-24013; the path stops on its ramp and the program is aborted",
    ]
    up = 1000.0 * RPM / UP
    assert bench.events[0].cycle == math.ceil(10 + (up + 5.0) * 1000.0 - 1e-6) and moves(bench) == []


# ---------------------------------------------------------------- what the channel itself commands anew


def test_a_new_speed_is_what_a_late_synchronisation_waits_for() -> None:
    """m3 is MVS_SLP, s is MOS."""
    bench = run("M3 S1000\nG04 X1\nS9000\n#EXPL SYN\nG01 X20 F6000", mill(m3=MVS_SLP))
    assert bench.errors() == [] and speed_at_the_move(bench) == pytest.approx(9000.0, rel=0.1)


@pytest.mark.parametrize("newer", ["M5", "M19 S.POS=0", "G74 S1"])
def test_after_another_function_nobody_waits_for_the_speed(newer: str) -> None:
    bench = run(f"M3 S1000\nG04 X1\n{newer}\n#EXPL SYN\nG01 X20 F6000", mill(m3=MVS_SLP))
    assert bench.errors() == [] and moves(bench)[0][0] < 1030


def test_a_gear_change_of_the_channel_before_a_late_synchronisation() -> None:
    spindles = three(m3=MVS_SLP, s=MOS, ranges=((50.0, 800.0), (400.0, 800.0)), automatic=False)
    machine = machine_of(*spindles, units={"s": two_gears()}, gear_change=True)
    bench = run("M40 S600 M3\nG04 X0.1\nM41\n#EXPL SYN\nG01 X20 F6000", machine)
    assert bench.errors() == [] and [command for command, _ in told(bench)].count("select_gear") == 1
    assert speed_at_the_move(bench) == pytest.approx(600.0, rel=0.1)


# ---------------------------------------------------------------- who has commanded the spindle last


def two(scenario: str) -> MachineBench:
    """Manual blocks of two channels for the same spindles: {at: s, to: channel or second, do: mdi, text: ...}."""
    return MachineBench(None, scenario, machine=two_channels(), end_when_idle=False)


def notes(bench: MachineBench) -> list[str]:
    """Warnings of channels, and with what commands of spindles were carried out."""
    events = [f"P-WARN-{event.error_id} {event.text}, line {event.line}" for event in bench.events]
    return events + [record.message for record in bench.records if record.target in "stu" and record.message]


TAKEN = """
- {at: 0, to: channel, do: mdi, text: "M3 S1000"}
- {at: 0.5, to: second, do: mdi, text: "M4 S2000"}
- {at: 1, to: second, do: mdi, text: "G1 Y50 F600"}
"""


def test_a_reset_does_not_stop_what_another_channel_has_taken_over() -> None:
    bench = two(TAKEN + "- {at: 1.5, to: channel, do: reset}").run(3.0)
    assert bench.column("s", "set_speed_rpm")[-1] == -2000.0 and bench.errors() == []
    assert notes(bench) == [
        "spindle s: stop of 'channel' without effect, 'second' has commanded the spindle since",
    ]


def test_what_the_reset_channel_has_waiting_is_forgotten() -> None:
    """The second channel changes the gear; the order of the first one waits when that is reset."""
    machine = mill(m3=MVS_SVS)
    second = replace(machine.channels["channel"], name="second", axes=())
    bench = MachineBench(
        None,
        MANUAL
        + """
- {at: 0.1, to: s, do: select_gear, stage: 2, source: second}
- {at: 0.5, to: channel, do: mdi, text: "M3 S1000"}
- {at: 1, to: channel, do: reset}
- {at: 1.5, to: s, do: gear_changed}
""",
        machine=replace(machine, channels={**machine.channels, "second": second}),
        end_when_idle=False,
    ).run(3.0)
    assert bench.last("s").gear[-1] == 2 and set(bench.column("s", "set_speed_rpm")[1000:]) == {0.0}


def test_the_program_end_does_not_stop_what_another_channel_has_taken_over() -> None:
    scenario = """
- {at: 0, to: s, do: stop_at_program_end, enabled: on}
- {at: 0, to: channel, do: mdi, text: "M3 S1000"}
- {at: 0.5, to: second, do: mdi, text: "M4 S2000"}
- {at: 1, to: channel, do: mdi, text: "G04 X0.1 M30"}
"""
    bench = two(scenario).run(3.0)
    assert bench.column("s", "set_speed_rpm")[-1] == -2000.0 and bench.errors() == []


def test_m5_of_another_channel_counts_and_its_user_hears_of_it() -> None:
    """The other channel is notified of what has happened to its M3 when its next block begins."""
    bench = two(TAKEN + '- {at: 1.5, to: channel, do: mdi, text: "M5"}').run(3.0)
    assert bench.column("s", "set_speed_rpm")[-1] == 0.0 and bench.errors() == []
    assert notes(bench) == [
        "P-WARN-22022 channel channel: spindle s does not turn at 1000 rpm as commanded, it was commanded to -2000 rpm; "
        "the program continues, line 1",
        "P-WARN-22022 channel second: spindle s does not turn at -2000 rpm as commanded, it is in Stopping; "
        "the program continues, line 1",
    ]


def test_the_user_of_a_slave_hears_what_another_channel_tells_its_master() -> None:
    """A reset of the channel that has coupled the slave, and commanded it last, stops it."""
    scenario = """
- {at: 0, to: second, do: mdi, text: "S2[M3 REV2000]"}
- {at: 0.5, to: second, do: mdi, text: "G1 Y50 F600"}
- {at: 1, to: channel, do: mdi, text: "#SET AX LINK[1,S2=S]"}
- {at: 1.1, to: channel, do: mdi, text: "#ENABLE AX LINK[1]"}
- {at: 1.2, to: channel, do: mdi, text: "M3 S500"}
- {at: 2, to: channel, do: reset}
"""
    bench = two(scenario).run(3.0)
    assert notes(bench) == [
        "P-WARN-22022 channel second: spindle t does not turn at 2000 rpm as commanded, it was commanded to 500 rpm; "
        "the program continues, line 1"
    ]
    assert bench.column("t", "set_speed_rpm")[1990] == 500.0 and bench.last("t").set_speed_rpm[-1] == 0.0


def test_a_reset_leaves_a_slave_alone_that_it_has_not_commanded() -> None:
    scenario = """
- {at: 0, to: second, do: mdi, text: "S2[M3 REV2000]"}
- {at: 1, to: channel, do: mdi, text: "#SET AX LINK[1,S2=S]"}
- {at: 1.1, to: channel, do: mdi, text: "#ENABLE AX LINK[1]"}
- {at: 2, to: channel, do: reset}
"""
    bench = two(scenario).run(3.0)
    assert bench.last("t").set_speed_rpm[-1] == 2000.0 and bench.last("t").master == ""
    assert notes(bench) == [
        "spindle t: stop of 'channel' without effect, 'second' has commanded the spindle since",
    ]


def test_a_stop_of_the_plc_is_told_to_a_program_that_does_not_wait() -> None:
    program = "M3 S1000\nG04 X1\nG01 X20 F6000\nM5"
    bench = run(program, mill(m3=MVS_SVS), "- {at: 0.5, to: s, do: stop}")
    assert bench.errors() == [] and bench.position("x") == 20.0
    assert notes(bench) == [
        "P-WARN-22022 channel channel: spindle s does not turn at 1000 rpm as commanded, it is in Stopping; "
        "the program continues, line 3"
    ]


def another_gear(at: float, source: str = "plc") -> str:
    """Gear 2 from `at` (s) on, acknowledged at 2.5 s; without `source` it comes from people."""
    whose = f", source: {source}" if source else ""
    change = f"- {{at: {at}, to: s, do: select_gear, stage: 2{whose}}}"
    return f"{MANUAL}{change}\n- {{at: 2.5, to: s, do: gear_changed}}\n"


def warned(bench: MachineBench) -> list[tuple[int, str]]:
    """(cycle, text) of all events: of a loss with what the spindle does instead."""
    before, after = "channel channel: spindle s does not turn at 1000 rpm as commanded, ", "; the program continues"
    texts = [f"P-WARN-{event.error_id} {event.text.removeprefix(before).removesuffix(after)}" for event in bench.events]
    return [(event.cycle, text) for event, text in zip(bench.events, texts, strict=True)]


@pytest.mark.parametrize("kind", [MOS, MVS_SVS])
def test_a_gear_change_of_the_plc_is_told_to_a_moving_path_at_once(kind: Synchronisation) -> None:
    """For 2 s the spindle is at a standstill while the path cuts; then it turns again, without another message."""
    bench = run("M3 S1000\nG1 X80 F1500\nM5", mill(m3=kind), another_gear(0.5))
    assert [(event.cycle, event.text) for event in bench.events] == [
        (
            510,
            "channel channel: spindle s does not turn at 1000 rpm as commanded, its gear is being changed; "
            "the program continues",
        )
    ]
    assert bench.column("s", "set_speed_rpm")[1500] == 0.0 != bench.column("channel", "path_velocity")[1500]
    assert bench.column("s", "set_speed_rpm")[3000] == 1000.0 and bench.position("x") == 80.0


def test_m3_that_waits_for_a_gear_is_not_lost_until_it_was_carried_out() -> None:
    """M3 waits in the spindle from 0.3 s on and begins at 2.5 s; the stop at 2.7 s takes from it what it has."""
    scenario = another_gear(0.1, "") + "- {at: 2.7, to: s, do: stop}"
    bench = run("G04 X0.3\nM3 S1000\nG1 X100 F1500\nM5", mill(m3=MOS), scenario)
    assert told_at(bench, "start") < 400 and warned(bench) == [(2710, "P-WARN-22022 it is in Stopping")]


def test_commands_of_the_plc_that_wait_for_each_other() -> None:
    """The first of them takes the spindle from a path that moves; the last one turns it as before."""
    scenario = """
- {at: 0.3, to: s, do: orient, position_deg: 90, speed_rpm: 50, source: plc}
- {at: 0.3, to: s, do: orient, position_deg: 180, speed_rpm: 50, source: plc}
- {at: 0.3, to: s, do: start, direction: cw, speed_rpm: 1000, source: plc}
"""
    bench = run("M3 S1000\nG1 X50 F1500\nM5", mill(m3=MVS_SVS), scenario)
    assert warned(bench) == [(310, "P-WARN-22022 it is in DiscreteMotion")]
    assert bench.last("s").plc_acknowledged == 3


def test_a_speed_of_the_plc_is_not_m3_that_waits_behind_it() -> None:
    """The PLC turns the spindle at the very speed of the channel before it positions it; M3 has its turn at last."""
    scenario = another_gear(0.1, "") + (
        "- {at: 0.2, to: s, do: start, direction: cw, speed_rpm: 1000, source: plc}\n"
        "- {at: 0.2, to: s, do: orient, position_deg: 90, speed_rpm: 50, source: plc}\n"
    )
    bench = run("G04 X0.3\nM3 S1000\nG1 X150 F1500\nM5", mill(m3=MOS), scenario)
    assert warned(bench) == [] and bench.last("s").plc_acknowledged == 2
    states = bench.column("s", "state")[2500:5500]
    assert states.index(S.CONTINUOUS_MOTION) < states.index(S.DISCRETE_MOTION)
    assert bench.column("s", "set_speed_rpm")[5500] == 1000.0


def test_a_gear_change_between_two_manual_blocks() -> None:
    scenario = another_gear(0.5) + (
        '- {at: 0, to: channel, do: mdi, text: "M3 S1000"}\n- {at: 1, to: channel, do: mdi, text: "G1 X10 F1500"}\n'
    )
    bench = MachineBench(None, scenario, machine=mill(m3=MOS), end_when_idle=False).run(3.0)
    assert warned(bench) == [(1000, "P-WARN-22022 its gear is being changed")]


def test_a_gear_change_of_the_channel_is_nothing_to_warn_of() -> None:
    spindles = three(MOS, ranges=((50.0, 800.0), (400.0, 800.0)), automatic=False)
    machine = machine_of(*spindles, units={"s": two_gears(change_position=180.0)}, gear_change=True)
    bench = run("M40 S600 M3\nG1 X5 F1500\nM41 S700 M3\nG1 X10\nM5", machine)
    assert told_at(bench, "select_gear") > 100 and warned(bench) == []


def test_a_path_goes_on_with_a_spindle_at_override_0() -> None:
    """Only a wait notices it: the spindle does what was commanded, at 0 %."""
    bench = run("M3 S1000\nG1 X20 F1500\nM5", mill(m3=MOS), "- {at: 0.3, to: s, do: set_override, percent: 0}")
    assert warned(bench) == [] and bench.position("x") == 20.0
    assert bench.column("s", "set_speed_rpm")[700] == 0.0 != bench.column("channel", "path_velocity")[700]


def test_a_spindle_that_was_stopped_between_two_programs_is_of_no_concern() -> None:
    bench = MachineBench("%P\nM3 S1000\nM30", machine=mill(m3=MVS_SVS), end_when_idle=False).run(1.0)
    bench.give("s", "stop")
    bench.run(0.5)
    bench.give("channel", "load", program="b.nc", text="%B\nG01 X1 F6000\nM30")
    assert bench.give("channel", "start").accepted
    bench.run(1.0)
    assert bench.position("x") == 1.0 and notes(bench) == []


def test_a_speed_for_what_another_channel_has_set_turning() -> None:
    scenario = """
- {at: 0, to: channel, do: mdi, text: "M3 S1000"}
- {at: 0.5, to: second, do: mdi, text: "S2000"}
- {at: 1, to: second, do: mdi, text: "M3"}
"""
    bench = two(scenario).run(2.0)
    assert bench.column("s", "set_speed_rpm")[990] == 1000.0 and bench.column("s", "set_speed_rpm")[-1] == 2000.0
    assert notes(bench) == [
        "P-WARN-22023 channel second: S2000 is without effect on spindle s, which this channel has not started; "
        "it counts for its next M03 or M04, line 1"
    ]


def test_a_speed_before_m3_is_nothing_to_warn_of() -> None:
    bench = run(LINK + "S1000\nM3", machine_of(*three()))
    assert notes(bench) == [] and max(bench.column("t", "set_speed_rpm")) > 900.0


def test_a_speed_for_a_slave_that_was_coupled_at_rest() -> None:
    program = f"M3 S1000\n{LINK}S2000\nG01 X10 F3000\nM3\nG01 X20\nM5"
    bench = run(program, machine_of(*three(s=MVS_SVS)))
    assert bench.errors() == [] and notes(bench) == [
        "P-WARN-22023 channel channel: S2000 is without effect on spindle t, which is at a standstill; M03 or M04 of its "
        "master s starts it, line 5"
    ]
    assert speed_at_the_move(bench, "t", 0) == 0.0
    assert speed_at_the_move(bench, "t", 1) == pytest.approx(2000.0, rel=0.1)
