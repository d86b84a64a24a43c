"""Late synchronisation, measuring event, positioning, time limit of the handshake (TF5200 spindle 2.5)."""

from __future__ import annotations

from dataclasses import replace

import pytest
from channel_spindle_support import (
    MANUAL,
    MNE_SNS,
    MNS_SNS,
    MOS,
    MVS_SLM,
    MVS_SLP,
    MVS_SNS,
    MVS_SVS,
    NO_SYNCH,
    PLC_INFO,
    channel_spindle,
    machine_of,
    moves,
    reported,
    requests,
    run,
    told,
    told_at,
)
from long_support import long
from machine_support import MILL, MachineBench

from cnc_ptp.parameters import MachineParameters, Synchronisation
from cnc_ptp.protocol.channel_states import ChannelStateCode as C


def mill(**types: Synchronisation) -> MachineParameters:
    """One spindle with these types; what is not named is MOS."""
    return machine_of(channel_spindle("S", "s", 4, MOS, **types))


def with_m(machine: MachineParameters = MILL, **types: Synchronisation) -> MachineParameters:
    """The machine with M functions of these types (m6=…)."""
    channel = machine.channels["channel"]
    known = {**channel.m_functions, **{int(name[1:]): value for name, value in types.items()}}
    return replace(machine, channels={"channel": replace(channel, m_functions=known)})


# ---------------------------------------------------------------- all types


def with_h(number: int, kind: Synchronisation) -> MachineParameters:
    """The mill, with an H function of this type."""
    channel = MILL.channels["channel"]
    return replace(MILL, channels={"channel": replace(channel, h_functions={number: kind})})


@pytest.mark.parametrize("acknowledged_at", [0.953, *long([0.95, 1.2])])
@pytest.mark.parametrize("function", ["M03 S600", "H5"])
@pytest.mark.parametrize(
    ("kind", "first_held"),
    [(NO_SYNCH, 4), (MOS, 4), (MVS_SVS, 0), (MVS_SNS, 1), (MNS_SNS, 1), (MNE_SNS, 1), (MVS_SLM, 2), (MVS_SLP, 3)],
)
def test_the_path_moves_in_the_block_after_the_acknowledgement(
    kind: Synchronisation, first_held: int, function: str, acknowledged_at: float
) -> None:
    """Of four motions of 10 mm, two in rapid traverse, one machining and one after #EXPL SYN, which is the first that
    waits for a PLC that acknowledges late; the ones before are finished, and no setpoint moves until then.
    """
    bench = MachineBench(
        f"%P\nG00 X10 {function}\nX20\nG01 X30 F9000\n#EXPL SYN\nG00 X40\nM30",
        MANUAL + f"- {{at: {acknowledged_at}, to: plc, do: acknowledge, id: 1}}",
        machine=with_h(5, kind) if function == "H5" else mill(m3=kind | PLC_INFO),
    ).run()
    acknowledgement = told_at(bench, "acknowledge", "plc" if first_held == 4 else "channel")
    x = bench.column("x", "set_position")
    assert x[-1] == pytest.approx(40.0) and not bench.errors()
    if first_held == 4:
        assert x[acknowledgement] == pytest.approx(40.0)
        return
    still = first_held * 10.0
    begin = x.index(x[acknowledgement])
    assert x[begin] == pytest.approx(still) and begin <= acknowledgement - 100 * (first_held > 0)
    assert set(x[begin : acknowledgement + 1]) == {x[begin]}
    assert x[acknowledgement + 1] > x[acknowledgement]


@pytest.mark.parametrize(("kind", "sent"), [(NO_SYNCH, [6]), (MOS, [5, 6]), (MVS_SVS, [5, 6])])
def test_what_an_h_function_sends(kind: Synchronisation, sent: list[int]) -> None:
    """One without an entry is sent, and the path does not wait for it."""
    bench = run("H5=7\nG01 X1 F3000 H6\nM30", with_h(5, kind))
    assert bench.errors() == [] and bench.position("x") == 1.0
    assert [(each.kind, each.number) for each in requests(bench)] == [("H", number) for number in sent]
    assert [each.acknowledge_needed for each in requests(bench)] == [kind is MVS_SVS] * (len(sent) - 1) + [False]


def test_an_h_function_that_is_never_acknowledged_aborts_the_program() -> None:
    bench = MachineBench(
        "%P\nG00 X1\nH5\nX2\nM30",
        MANUAL,
        machine=replace(with_h(5, MVS_SVS), handshake_timeout_ms=500),
        end_when_idle=False,
    ).run(3.0)
    assert bench.errors() == [
        "P-ERR-22016 channel channel: the PLC has not acknowledged request 1 (H5 in line 3) within 0.5 s "
        "(P-MACH-00060); the path stops on its ramp and the program is aborted"
    ]
    assert bench.position("x") == 1.0


# ---------------------------------------------------------------- late synchronisation


def test_mvs_slm_waits_before_the_next_machining_motion() -> None:
    bench = run("G00 X1 M03 S6000\nX2\nG01 X3 F3000", mill(m3=MVS_SLM))
    rapid, cut = moves(bench)
    start = told_at(bench, "start")
    assert rapid[0] == 1 and rapid[1] < reported(bench, "s", "speed_reached", start)
    assert cut[0] == reported(bench, "s", "speed_reached", start) + 1


def test_mvs_slm_waits_before_the_machining_motion_of_its_own_block() -> None:
    bench = run("G01 X3 F3000 M03 S6000", mill(m3=MVS_SLM))
    assert moves(bench)[0][0] == reported(bench, "s", "speed_reached", told_at(bench, "start")) + 1


def test_mvs_slm_waits_before_an_arc_and_no_longer_after_it() -> None:
    bench = run("G00 X1 M03 S6000\nG02 X2 Y1 R1 F3000\nG01 X3", mill(m3=MVS_SLM))
    state = bench.column("channel", "state")
    waiting = [cycle for cycle, code in enumerate(state) if code == C.WAITING]
    assert len(moves(bench)) == 2 and waiting[-1] < moves(bench)[1][0]


def test_mvs_slp_waits_at_expl_syn_only() -> None:
    bench = run("G01 X1 F3000 M03 S6000\nG01 X2\n#EXPL SYN\nG00 X3", mill(m3=MVS_SLP))
    cut, rapid = moves(bench)
    assert cut[0] == 1
    assert rapid[0] == reported(bench, "s", "speed_reached", told_at(bench, "start")) + 1


def test_expl_syn_with_nothing_to_wait_for_costs_no_cycle() -> None:
    one = run("G01 X1 F3000\n#EXPL SYN\nG01 X2", mill())
    other = run("G01 X1 F3000\nG01 X2", mill())
    assert one.column("x", "set_position") == other.column("x", "set_position")


def test_late_functions_for_the_plc() -> None:
    """The acknowledgement is waited for there, not the output: M07 is SLP, M08 is SLM."""
    bench = MachineBench(
        "%P\nG00 X1 M07 M08\nX2\nG01 X3 F3000\n#EXPL SYN\nX4\nM30",
        MANUAL + "- {at: 1, to: plc, do: acknowledge, id: 2}\n- {at: 2, to: plc, do: acknowledge, id: 1}",
        machine=with_m(m7=MVS_SLP, m8=MVS_SLM),
    ).run()
    assert [(request.number, request.cycle, request.acknowledge_needed) for request in requests(bench)] == [
        (7, 10, True),
        (8, 10, True),
    ]
    first, cut, last = moves(bench)
    assert (first[0], cut[0], last[0]) == (1, 1001, 2001)


@pytest.mark.parametrize("kind", [MVS_SLM, MVS_SLP])
def test_the_program_ends_when_late_functions_are_done(kind: Synchronisation) -> None:
    bench = run("G00 X1 M03 S6000", mill(m3=kind))
    reached = reported(bench, "s", "speed_reached", told_at(bench, "start"))
    state = bench.column("channel", "state")
    assert state[reached - 1] == C.WAITING and state[reached + 1] == C.READY


def test_manual_blocks_wait_for_late_functions_too() -> None:
    bench = MachineBench(None, machine=mill(m3=MVS_SLP), end_when_idle=False).run(0.02)
    bench.give("channel", "mdi", text="M03 S6000")
    bench.run(2.0)
    reached = reported(bench, "s", "speed_reached", told_at(bench, "start"))
    done = next(block.first_cycle for block in bench.blocks["channel"][3:] if block.done)
    assert reached - 10 <= done <= reached


def test_a_newer_function_of_the_spindle_takes_the_place_of_a_late_one() -> None:
    """M05 follows immediately: the speed of M03 is no longer awaited, only for its acknowledgement."""
    bench = run(
        "M03 S6000\nM05\n#EXPL SYN\nG01 X1 F3000",
        mill(m3=MVS_SLP | PLC_INFO, m5=MOS),
        MANUAL + "- {at: 1, to: plc, do: acknowledge, id: 1}",
    )
    assert moves(bench)[0][0] == 1001
    bench = run("M03 S6000\nM05\n#EXPL SYN\nG01 X1 F3000", mill(m3=MVS_SLP, m5=MOS))
    assert moves(bench)[0][0] <= 31


# ---------------------------------------------------------------- measuring event


def test_mne_sns_goes_out_with_the_measuring_event_and_is_waited_for_at_the_end() -> None:
    bench = MachineBench(
        "%P\nG01 X20 F3000 M03 S1200\nG01 X21\nM30",
        "- {at: 0.2, to: channel, do: measuring_event}",
        machine=mill(m3=MNE_SNS),
    ).run()
    assert told_at(bench, "start") == 200 and told(bench)[0] == ("start", {"direction": "cw", "speed_rpm": 1200.0})
    assert bench.errors() == [] and bench.refusals() == []
    assert moves(bench)[0][1] > 300


def test_mne_sns_for_the_plc() -> None:
    bench = MachineBench(
        "%P\nG01 X20 F3000 M08\nG01 X21\nM30",
        MANUAL + "- {at: 0.2, to: channel, do: measuring_event}\n- {at: 2, to: plc, do: acknowledge, id: 1}",
        machine=with_m(m8=MNE_SNS),
    ).run()
    assert [request.cycle for request in requests(bench)] == [200]
    assert [first for first, _ in moves(bench)] == [1, 2001]


def test_without_a_measuring_event_the_function_goes_out_after_the_motion() -> None:
    bench = run("G01 X5 F3000 M03 S1200", mill(m3=MNE_SNS))
    assert [f"{event.error_id} {event.text} {event.line}" for event in bench.events] == [
        "22017 channel channel: no measuring event has come in the block; its functions go out after the motion 2"
    ]
    end = moves(bench)[0][1]
    assert end < told_at(bench, "start") <= end + 20


def test_a_measuring_event_that_nobody_waits_for_is_refused() -> None:
    bench = MachineBench("%P\nG01 X20 F3000 M03 S1200\nM30", machine=mill(m3=MNE_SNS), end_when_idle=False).run(0.1)
    assert bench.give("channel", "measuring_event").accepted
    assert bench.refused("channel", "measuring_event") == (
        "P-ERR-22020 channel channel: measuring_event refused: nothing in the running block waits for one; "
        "nothing was changed"
    )


@pytest.mark.parametrize(("word", "activity"), [("M05", "m5"), ("S500", "s"), ("M04 S500", "m4")])
def test_a_measuring_event_does_not_end_the_wait_that_holds_the_path(word: str, activity: str) -> None:
    """The event comes while G01 waits for the speed of M03: it must not start with a spindle that does something else."""
    bench = MachineBench(
        f"%P\nM03 S3000\nG01 X10 F3000 {word}\nM30",
        "- {at: 0.05, to: channel, do: measuring_event}",
        machine=mill(m3=MVS_SLM, **{activity: MNE_SNS}),
    ).run()
    assert [event.error_id for event in bench.events if event.source == "channel"] == [22021]
    assert not any(bench.column("x", "set_velocity"))


# ---------------------------------------------------------------- positioning


def test_m19_waits_for_the_position() -> None:
    bench = run("M19 S100 S.POS=90\nG01 X1 F3000", mill(m19=MVS_SVS))
    assert told(bench)[0] == ("orient", {"position_deg": 90.0, "speed_rpm": 100.0})
    assert moves(bench)[0][0] == reported(bench, "s", "in_position", told_at(bench, "orient")) + 1
    assert bench.column("s", "actual_position_deg")[moves(bench)[0][0]] == pytest.approx(90.0, abs=0.2)


def test_m19_with_direction_and_without_speed() -> None:
    bench = run("S[M19 POS90 M4]\nM19", mill(m19=MVS_SVS))
    assert told(bench)[:2] == [
        ("orient", {"position_deg": 90.0, "direction": "ccw"}),
        ("orient", {"position_deg": 90.0}),
    ]
    assert bench.column("s", "set_position_deg")[-1] == -270.0


def test_the_type_of_m19_rules_over_that_of_its_direction() -> None:
    """M19 > M3 > S: M3 beside M19 says the direction only."""
    bench = run("G01 X1 F3000 M19 M3 S600 S.POS=180", mill(m19=MVS_SNS, m3=MVS_SVS, s=MVS_SVS))
    assert moves(bench)[0][0] == 1
    state, x = bench.column("channel", "state"), bench.column("x", "set_position")
    assert {x[cycle] for cycle, code in enumerate(state) if code == C.WAITING} == {1.0}


def test_no_synch_positions_and_waits_for_nothing() -> None:
    bench = run("M19 S100 S.POS=90\nG01 X1 F3000", mill(m19=NO_SYNCH))
    assert moves(bench)[0][0] == 1 and requests(bench) == []


def test_plc_info_of_m19_tells_position_and_direction() -> None:
    bench = run("M19 S100 S.POS=90 M3", mill(m19=MVS_SVS | PLC_INFO))
    request = requests(bench)[0]
    assert (request.kind, request.number, request.spindle) == ("M", 19, "s")
    assert (request.value, request.position, request.direction) == (100.0, 90.0, "cw")


# ---------------------------------------------------------------- G167, G74, free functions


def test_g167_holds_for_what_its_block_commands() -> None:
    bench = run(
        "M3 S1000\nG04 1\nG167 S1000\nG04 1\nS3000\nG04 1", mill(), "- {at: 0, to: s, do: set_override, percent: 50}"
    )
    assert told(bench)[1:] == [
        ("start", {"direction": "cw", "speed_rpm": 1000.0}),
        ("suppress_override", {"enabled": True}),
        ("set_speed", {"speed_rpm": 1000.0}),
        ("suppress_override", {"enabled": False}),
        ("set_speed", {"speed_rpm": 3000.0}),
        ("stop", {}),
    ]
    speed = bench.column("s", "set_speed_rpm")
    assert [round(speed[cycle]) for cycle in (900, 1900, 2900)] == [500, 1000, 1500]


def test_g167_alone_lets_the_programmed_speed_come() -> None:
    """TF5200 spindle 2.4.1: S2[G167] beside a speed of 50 %."""
    bench = run(
        "S[M3 REV1000]\nG04 1\nS[G167]\nG04 1\nS[REV3000]\nG04 1",
        mill(),
        "- {at: 0, to: s, do: set_override, percent: 50}",
    )
    speed = bench.column("s", "set_speed_rpm")
    assert [round(speed[cycle]) for cycle in (900, 1900, 2900)] == [500, 1000, 1500]


def test_the_program_goes_on_while_the_spindle_homes() -> None:
    bench = run("G74 S1\nG01 X1 F3000", mill())
    assert told(bench)[0] == ("home", {}) and moves(bench)[0][0] == 1


def test_free_functions_of_a_spindle_name_it() -> None:
    bench = run("S[M8 M9]\nM8", MILL)
    assert [(r.kind, r.number, r.spindle, r.acknowledge_needed) for r in requests(bench)] == [
        ("M", 8, "s", True),
        ("M", 9, "s", True),
        ("M", 8, "", True),
    ]
    assert told(bench) == []


def test_a_free_function_of_a_spindle_has_to_exist() -> None:
    bench = MachineBench("%P\nS[M77]\nM30", end_when_idle=False).run(0.05)
    assert bench.refusals() == [
        "P-ERR-22011 test.nc line 2 column 3 'S[M77]': M77 does not exist on this machine (P-CHAN-00041). "
        "Known: M0, M1, M2, M3, M4, M5, M6, M7, M8, M9, M17, M19, M29, M30; nothing was started"
    ]


# ---------------------------------------------------------------- time limit


def test_a_plc_that_never_acknowledges_ends_in_an_error() -> None:
    bench = MachineBench(
        "%P\nM03 S1200\nG01 X5 F3000 M07\nX50\nM30",
        MANUAL,
        machine=replace(with_m(m7=MVS_SLP), handshake_timeout_ms=500),
        end_when_idle=False,
    ).run(3.0)
    assert bench.errors() == [
        "P-ERR-22016 channel channel: the PLC has not acknowledged request 1 (M07 in line 3) within 0.5 s "
        "(P-MACH-00060); the path stops on its ramp and the program is aborted"
    ]
    request = requests(bench)[0]
    error = bench.column("channel", "error_id").index(22016)
    assert error == request.cycle + 500 and 5.0 < bench.position("x") < 50.0
    assert told(bench)[-1] == ("stop", {}) and bench.last("s").speed_zero[-1]


def test_the_time_limit_names_the_spindle() -> None:
    machine = replace(mill(m3=MVS_SVS | PLC_INFO), handshake_timeout_ms=200)
    bench = MachineBench("%P\nM03 S1200\nM30", MANUAL, machine=machine, end_when_idle=False).run(0.5)
    assert bench.errors() == [
        "P-ERR-22016 channel channel: the PLC has not acknowledged request 1 (M03 of spindle s in line 2) "
        "within 0.2 s (P-MACH-00060); the path stops on its ramp and the program is aborted"
    ]


@pytest.mark.long
def test_without_a_time_limit_the_channel_waits_for_ever() -> None:
    machine = replace(with_m(), handshake_timeout_ms=0)
    bench = MachineBench("%P\nM08\nM30", MANUAL, machine=machine, end_when_idle=False).run(70.0)
    assert bench.errors() == [] and bench.last("channel").state[-1] == C.WAITING


def test_an_acknowledgement_just_in_time() -> None:
    machine = replace(with_m(), handshake_timeout_ms=500)
    bench = run("M08\nG01 X1 F3000", machine, MANUAL + "- {at: 0.5, to: plc, do: acknowledge, id: 1}")
    assert bench.errors() == [] and moves(bench)[0][0] == 501


def test_a_spindle_that_is_not_synchronised_and_one_that_is() -> None:
    """TF5200 spindle 2.5.2, figures 11 and 12: s MVS_SVS, m3 MOS."""
    machine = mill(s=MVS_SVS)
    free = run("N10 X0 Y0 G0\nN20 X40 Y40 G1 F1500 M3 S500\nN30 M3 S100 X0 Y0", machine)
    assert moves(free)[0][0] == 1 and C.WAITING not in free.states("channel")
    bound = run("N10 M3 X0 Y0 G0\nN20 X40 Y40 G1 F1500 S500\nN30 S100 X0 Y0", machine)
    first, second = moves(bound)
    up, down = (told_at_speed(bound, rpm) for rpm in (500.0, 100.0))
    assert first[0] == reported(bound, "s", "speed_reached", up) + 1
    assert second[0] == reported(bound, "s", "speed_reached", down) + 1
    assert [command for command, _ in told(bound)] == ["start", "set_speed", "set_speed", "stop"]


def told_at_speed(bench: MachineBench, rpm: float) -> int:
    """Cycle of the command for a speed."""
    return next(r.cycle for r in bench.records if r.target == "s" and f'"speed_rpm": {rpm}' in r.arguments_json)
