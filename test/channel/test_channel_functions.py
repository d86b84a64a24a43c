"""M, S and T functions of a program: when they go out, what the path waits for, the handshake with the PLC."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from machine_support import CYCLE_TIME, MILL, MachineBench, machine

from cnc_ptp.parameters import ChannelSpindle, MachineParameters, Synchronisation
from cnc_ptp.protocol.blocks import HandshakeRequest
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

MOS, MVS_SVS, MVS_SNS, MNS_SNS, PLC_INFO = (
    Synchronisation.MOS,
    Synchronisation.MVS_SVS,
    Synchronisation.MVS_SNS,
    Synchronisation.MNS_SNS,
    Synchronisation.PLC_INFO,
)
SPINUP = 1200.0 * 6.0 / 36_000.0
"""s to 1200 rpm"""


def with_spindle(**types: Synchronisation) -> MachineParameters:
    """The mill with other synchronisation types of its spindle (m3, m4, m5, s)."""
    spindle = MILL.channels["channel"].spindles[0]._replace(**types)
    return machine(channel={"spindles": (spindle,)})


def with_m(**types: Synchronisation) -> MachineParameters:
    """The mill with other synchronisation types of M functions (m6=…)."""
    known = {**MILL.channels["channel"].m_functions, **{int(name[1:]): value for name, value in types.items()}}
    return machine(channel={"m_functions": known})


def requests(bench: MachineBench) -> list[HandshakeRequest]:
    return [request for block in bench.blocks["channel"] for request in block.requests]


def first_motion(bench: MachineBench) -> int:
    """First cycle whose path velocity is not 0."""
    return next(cycle for cycle, v in enumerate(bench.column("channel", "path_velocity")) if v)


def last_motion(bench: MachineBench) -> int:
    velocity = bench.column("channel", "path_velocity")
    return max(cycle for cycle, v in enumerate(velocity) if v)


def commands(bench: MachineBench, unit: str = "s") -> list[tuple[int, str, str]]:
    """Cycle, command and arguments of what the unit was commanded; motion commands come from the channel.

    Without the reset of feedforward at the program start.
    """
    of_unit = [r for r in bench.records if r.target == unit and r.command != "reset_feedforward"]
    told = [(r.cycle, r.command, json.loads(r.arguments_json)) for r in of_unit]
    assert all(arguments.pop("source", "channel") == "channel" for _, _, arguments in told)
    return [(cycle, command, json.dumps(arguments, sort_keys=True)) for cycle, command, arguments in told]


# ---------------------------------------------------------------- spindle


def test_mvs_svs_waits_for_the_speed_and_moves_in_the_block_after_the_report() -> None:
    bench = MachineBench("%P\nM03 S1200\nG01 X20 F3000\nM05\nM30").run()
    assert bench.errors() == []
    begin = commands(bench)[0][0]
    assert commands(bench)[0] == (begin, "start", '{"direction": "cw", "speed_rpm": 1200.0}')
    reports = [n for n, block in enumerate(bench.blocks["s"]) if block.first_cycle >= begin and block.speed_reached[-1]]
    channel = bench.blocks["channel"][reports[0] + 1]
    assert first_motion(bench) == channel.first_cycle + 1  # its first cycle is the old standstill
    assert channel.first_cycle * CYCLE_TIME == pytest.approx(begin * CYCLE_TIME + 0.9 * SPINUP, abs=0.05)
    waiting = bench.column("channel", "state")
    assert set(waiting[2 : channel.first_cycle]) == {C.WAITING}
    assert set(bench.column("channel", "line")[1 : channel.first_cycle]) == {2}


def test_m05_waits_for_standstill() -> None:
    bench = MachineBench("%P\nM03 S1200\nM05\nG01 X20 F3000\nM30").run()
    stop = next(cycle for cycle, command, _ in commands(bench) if command == "stop")
    zero = [n for n, b in enumerate(bench.blocks["s"]) if b.first_cycle >= stop and b.speed_zero[-1]]
    assert first_motion(bench) == bench.blocks["channel"][zero[0] + 1].first_cycle + 1
    assert bench.errors() == []


def test_mos_does_not_wait() -> None:
    bench = MachineBench("%P\nM03 S1200\nG01 X20 F3000\nM30", machine=with_spindle(m3=MOS)).run()
    assert first_motion(bench) == 1
    assert commands(bench)[0][:2] == (10, "start")  # functions go out with the next block
    assert C.WAITING not in bench.states("channel")


def test_mvs_sns_moves_at_once_and_waits_at_the_end_of_its_block() -> None:
    bench = MachineBench("%P\nG01 X5 F3000 M03 S1200\nG01 X10\nM30", machine=with_spindle(m3=MVS_SNS)).run()
    assert first_motion(bench) == 1 and commands(bench)[0][:2] == (10, "start")
    state, x = bench.column("channel", "state"), bench.column("x", "set_position")
    waiting = [cycle for cycle, s in enumerate(state) if s == C.WAITING]
    assert {x[cycle] for cycle in waiting} == {5.0}
    reached = next(b.first_cycle for b in bench.blocks["s"] if b.first_cycle >= 10 and b.speed_reached[-1])
    assert waiting[-1] == reached + 10


def test_mns_sns_goes_out_after_the_motion_and_waits_there() -> None:
    bench = MachineBench("%P\nG01 X5 F3000 M03 S1200\nG01 X10\nM30", machine=with_spindle(m3=MNS_SNS)).run()
    state, x = bench.column("channel", "state"), bench.column("x", "set_position")
    sent = commands(bench)[0][0]
    waiting = [cycle for cycle, s in enumerate(state) if s == C.WAITING]
    assert {x[cycle] for cycle in waiting} == {5.0}
    end_of_motion = next(cycle for cycle, value in enumerate(x) if value == 5.0)
    assert sent == -(-end_of_motion // 10) * 10 and waiting[-1] > sent + 150


def test_the_type_of_m3_rules_over_that_of_s_in_one_block() -> None:
    """TF5200 2.5.2: s MVS_SVS, m3 MOS: M3 S1200 does not wait, a later S alone does."""
    rules = with_spindle(m3=MOS, s=MVS_SVS)
    bench = MachineBench("%P\nM03 S1200\nG01 X5 F3000\nS3000\nG01 X10\nM30", machine=rules).run()
    state, x, line = (
        bench.column("channel", "state"),
        bench.column("x", "set_position"),
        bench.column("channel", "line"),
    )
    waiting = [cycle for cycle, s in enumerate(state) if s == C.WAITING]
    assert {line[cycle] for cycle in waiting} == {4} and {x[cycle] for cycle in waiting} == {5.0}
    assert [c[1:] for c in commands(bench)[:2]] == [
        ("start", '{"direction": "cw", "speed_rpm": 1200.0}'),
        ("set_speed", '{"speed_rpm": 3000.0}'),
    ]


def test_s_alone_counts_for_the_next_m3_while_the_spindle_stands() -> None:
    bench = MachineBench("%P\nS1200\nG01 X2 F3000\nM04\nM05\nS500\nM30").run()
    assert [c[1:] for c in commands(bench)] == [
        ("start", '{"direction": "ccw", "speed_rpm": 1200.0}'),
        ("stop", "{}"),
    ]


def test_a_speed_in_the_opposite_direction_keeps_waiting_through_zero() -> None:
    bench = MachineBench("%P\nM03 S1200\nM04\nG01 X5 F3000\nM30").run()
    speed = bench.column("s", "actual_speed_rpm")
    assert speed[first_motion(bench) - 2] == pytest.approx(-1200.0 * 0.9, abs=60.0)
    assert bench.errors() == []


def test_no_synch_gives_the_command_and_waits_for_nothing() -> None:
    none = Synchronisation.NO_SYNCH
    bench = MachineBench("%P\nM03 S1200\nG01 X5 F3000\nM30", machine=with_spindle(m3=none)).run()
    assert commands(bench)[0][1] == "start" and first_motion(bench) == 1 and requests(bench) == []


def test_a_second_spindle_by_name() -> None:
    second = ChannelSpindle("S2", "t", MOS, MOS, MOS, MOS, MOS)
    channel = replace(MILL.channels["channel"], spindles=(*MILL.channels["channel"].spindles, second))
    spindles = {**MILL.spindles, "t": replace(MILL.spindles["s"], name="t")}
    two = replace(MILL, spindles=spindles, channels={"channel": channel})
    bench = MachineBench("%P\nM03 S600 S2[M04 REV300]\nG01 X5 F3000\nS2[M05]\nM30", machine=two).run()
    assert bench.errors() == []
    assert [c[1] for c in commands(bench, "t")] == ["start", "stop"]
    assert min(bench.column("t", "set_speed_rpm")) == pytest.approx(-300.0)
    assert max(bench.column("s", "set_speed_rpm")) == pytest.approx(600.0)


# ---------------------------------------------------------------- handshake


def test_m_functions_are_acknowledged_automatically() -> None:
    bench = MachineBench("%P\nG01 X5 F3000 M08\nG01 X10 M09\nT3 D2\nM30").run()
    assert bench.errors() == []
    described = [(r.kind, r.number, r.line, r.acknowledge_needed, r.channel, r.spindle) for r in requests(bench)]
    assert described == [
        ("M", 8, 2, True, "channel", ""),
        ("M", 9, 3, True, "channel", ""),
        ("T", 3, 4, False, "channel", ""),
        ("D", 2, 4, False, "channel", ""),
    ]
    assert [request.id for request in requests(bench)] == [1, 2, 3, 4]
    for block in bench.blocks["channel"]:
        assert all(request.cycle == block.first_cycle for request in block.requests)
    assert [(r.cycle, r.command) for r in bench.records if r.target == "channel"][2:] == [
        (requests(bench)[0].cycle + 10, "acknowledge"),
        (requests(bench)[1].cycle + 10, "acknowledge"),
    ]
    x = bench.column("x", "set_position")
    assert first_motion(bench) == requests(bench)[0].cycle + 10 + 1  # M08 waits before the motion
    assert x[requests(bench)[1].cycle] == 10.0  # M09 goes out after it


def test_without_acknowledgement_the_channel_waits() -> None:
    bench = MachineBench(
        "%P\nM08\nG01 X5 F3000\nM30", "- {at: 0, to: plc, do: auto_acknowledge, enabled: off}", end_when_idle=False
    ).run(2.0)
    assert bench.states("channel") == [C.RUNNING, C.WAITING]
    assert bench.position("x") == 0.0
    assert bench.refused("plc", "acknowledge", id=2) == (
        "P-ERR-22013 plc plc: acknowledge refused: no request 2 waits; nothing was changed. Waiting: 1"
    )
    assert bench.refused("channel", "acknowledge", id=7) == (
        "P-ERR-22007 channel channel: acknowledge refused: no request 7 waits (waiting: 1); nothing was changed"
    )
    assert bench.give("plc", "acknowledge", id=1).accepted
    bench.run(1.0)
    assert bench.position("x") == 5.0
    assert bench.refused("plc", "acknowledge", id=1) == (
        "P-ERR-22013 plc plc: acknowledge refused: no request 1 waits; nothing was changed. Waiting: none"
    )
    assert bench.refused("channel", "acknowledge", id=1) == (
        "P-ERR-22007 channel channel: acknowledge refused: no request 1 waits (waiting: none); nothing was changed"
    )


def test_auto_acknowledge_answers_what_already_waits() -> None:
    bench = MachineBench(
        "%P\nM08\nG01 X5 F3000\nM30",
        "- {at: 0, to: plc, do: auto_acknowledge, enabled: off}\n- {at: 1, to: plc, do: auto_acknowledge, enabled: on}",
    ).run()
    assert first_motion(bench) == 1001 and bench.errors() == []


def test_mvs_sns_of_an_m_function_moves_and_waits_at_the_end() -> None:
    bench = MachineBench(
        "%P\nG01 X5 F3000 M07\nG01 X10\nM30",
        "- {at: 0, to: plc, do: auto_acknowledge, enabled: off}\n- {at: 1.5, to: plc, do: acknowledge, id: 1}",
        machine=with_m(m7=MVS_SNS),
    ).run()
    x = bench.column("x", "set_position")
    assert first_motion(bench) == 1 and x[1500] == 5.0 and x[1502] > 5.0 and bench.position("x") == 10.0


@pytest.mark.parametrize("acknowledge_first", [True, False])
def test_plc_info_waits_for_speed_and_acknowledgement(acknowledge_first: bool) -> None:
    at = 0.05 if acknowledge_first else 1.5
    bench = MachineBench(
        "%P\nM03 S1200\nG01 X5 F3000\nM30",
        f"- {{at: 0, to: plc, do: auto_acknowledge, enabled: off}}\n- {{at: {at}, to: plc, do: acknowledge, id: 1}}",
        machine=with_spindle(m3=MVS_SVS | PLC_INFO),
    ).run()
    request = requests(bench)[0]
    assert (request.kind, request.number, request.spindle, request.value) == ("M", 3, "s", 1200.0)
    assert request.acknowledge_needed
    expected = 1500 if not acknowledge_first else 10 + round((0.9 * SPINUP + 0.04) / CYCLE_TIME)
    assert first_motion(bench) == pytest.approx(expected, abs=25)


def test_a_request_names_its_synchronisation_type() -> None:
    """What tells a PLC whether the path stands while it works, also in a recording."""
    types = with_m(m50=Synchronisation.MVS_SNS, m51=Synchronisation.MNS_SNS, m52=Synchronisation.MOS)
    bench = MachineBench("%P\nM50\nM51\nM52 T7\nM03 S1000\nM30", machine=types).run()
    told = {(each.kind, each.number): (each.synchronisation, each.acknowledge_needed) for each in requests(bench)}
    assert told[("M", 50)] == ("MVS_SNS", True) and told[("M", 51)] == ("MNS_SNS", True)
    assert told[("M", 52)] == ("MOS", False) and told[("T", 7)] == ("MOS", False)
    both = Synchronisation.MVS_SVS | Synchronisation.PLC_INFO
    assert both.constants == "MVS_SVS | PLC_INFO" and Synchronisation.NO_SYNCH.constants == ""


def test_plc_info_of_a_speed_without_waiting() -> None:
    bench = MachineBench(
        "%P\nM03 S600\nS900\nG01 X5 F3000\nM30", machine=with_spindle(m3=MOS | PLC_INFO, s=MOS | PLC_INFO)
    ).run()
    assert [(r.kind, r.number, r.value, r.acknowledge_needed) for r in requests(bench)] == [
        ("M", 3, 600.0, False),
        ("S", 0, 900.0, False),
    ]
    assert first_motion(bench) == 1


def test_m_functions_without_output() -> None:
    bench = MachineBench("%P\nM08\nG01 X5 F3000\nM30", machine=with_m(m8=Synchronisation.NO_SYNCH)).run()
    assert requests(bench) == [] and first_motion(bench) == 1


def test_an_aborted_program_withdraws_its_requests() -> None:
    """The number that waited is void for the PLC too; the next program gets new ones."""
    bench = MachineBench(
        "%P\nM08\nG01 X5 F3000\nM30", "- {at: 0, to: plc, do: auto_acknowledge, enabled: off}", end_when_idle=False
    ).run(0.5)
    bench.give("channel", "reset")
    bench.run(0.05)
    assert "Waiting: none" in bench.refused("plc", "acknowledge", id=1)
    bench.give("channel", "start")
    bench.run(0.1)
    assert [request.id for request in requests(bench)] == [1, 2]
    bench.give("plc", "acknowledge", id=2)
    bench.run(1.0)
    assert bench.position("x") == 5.0


def test_two_channels_never_share_a_request_number() -> None:
    channel = MILL.channels["channel"]
    first = replace(channel, axes=channel.axes[:2], spindles=())
    second = replace(channel, name="second", axes=channel.axes[2:], spindles=())
    two = replace(MILL, channels={"channel": first, "second": second})
    scenario = "- {at: 0, to: second, do: mdi, text: M08 M07}\n- {at: 0, to: channel, do: mdi, text: M07 M08}\n"
    off = "- {at: 0, to: plc, do: auto_acknowledge, enabled: off}\n"
    bench = MachineBench(None, off + scenario, machine=two, end_when_idle=False).run(0.1)
    numbers = {
        name: [request.id for block in bench.blocks[name] for request in block.requests] for name in two.channels
    }
    assert numbers == {"channel": [1, 3], "second": [2, 4]}
    for number in (1, 2, 3, 4):
        assert bench.give("plc", "acknowledge", id=number).accepted
    bench.run(0.1)
    assert bench.last("channel").done and bench.last("second").done and bench.refusals() == []


# ---------------------------------------------------------------- stops of the program


def test_m00_stops_until_start() -> None:
    bench = MachineBench("%P\nG01 X5 F3000 M00\nG01 X10\nM30", end_when_idle=False).run(1.0)
    assert bench.states("channel") == [C.RUNNING, C.STOPPED] and bench.position("x") == 5.0
    assert bench.give("channel", "start").accepted
    bench.run(1.0)
    assert bench.states("channel") == [C.RUNNING, C.STOPPED, C.RUNNING, C.READY] and bench.position("x") == 10.0


@pytest.mark.parametrize("optional", [True, False])
def test_m01_stops_when_optional_stop_is_on(optional: bool) -> None:
    bench = MachineBench(
        "%P\nG01 X5 F3000\nM01\nG01 X10\nM30",
        f"- {{at: 0, to: channel, do: optional_stop, enabled: {'on' if optional else 'off'}}}",
        end_when_idle=False,
    ).run(2.0)
    assert (C.STOPPED in bench.states("channel")) is optional
    assert bench.position("x") == (5.0 if optional else 10.0)


def test_single_block_stops_after_each_block() -> None:
    bench = MachineBench(
        "%P\nG01 X5 F3000\nM08\nG01 X10\nM30",
        "- {at: 0, to: channel, do: single_block, enabled: true}",
        end_when_idle=False,
    )
    positions = []
    for _ in range(4):
        bench.run(0.6)
        positions.append((bench.position("x"), bench.last("channel").line[-1], bench.last("channel").state[-1]))
        bench.give("channel", "start")
    assert positions == [(5.0, 2, C.STOPPED), (5.0, 3, C.STOPPED), (10.0, 4, C.STOPPED), (10.0, 5, C.READY)]
    assert bench.refusals() == []


def test_single_block_does_not_stop_behind_the_last_block() -> None:
    """Manual blocks have no M30: what comes after them is not waited for."""
    bench = MachineBench(None, "- {at: 0, to: channel, do: single_block, enabled: true}", end_when_idle=False).run(0.02)
    bench.give("channel", "mdi", text="G01 X5 F3000\nX6")
    bench.run(1.0)
    assert bench.last("channel").state[-1] == C.STOPPED and bench.position("x") == 5.0
    bench.give("channel", "start")
    bench.run(1.0)
    assert bench.last("channel").done and bench.position("x") == 6.0


def test_single_block_off_runs_on_at_the_next_start() -> None:
    bench = MachineBench(
        "%P\nG01 X5 F3000\nG01 X10\nG01 X15\nM30",
        "- {at: 0, to: channel, do: single_block, enabled: true}\n- {at: 1, to: channel, do: single_block, enabled: false}\n"
        "- {at: 1, to: channel, do: start}",
    ).run()
    assert bench.position("x") == 15.0 and bench.states("channel").count(C.STOPPED) == 1


@pytest.mark.parametrize("end", ["M02", "M30"])
def test_program_ends(end: str) -> None:
    bench = MachineBench(f"%P\nN10 G01 X5 F3000\nN20 {end}").run()
    block = bench.last("channel")
    assert block.done and (block.blocks_done, block.blocks_total) == (2, 2)
    assert (block.line[-1], block.block_number[-1]) == (3, 20)


def test_the_program_may_be_started_again() -> None:
    bench = MachineBench("%P\nG91 G01 X5 F3000\nM30", "- {at: 1, to: channel, do: start}").run()
    assert bench.position("x") == 10.0


def test_spindle_keeps_turning_at_the_end_of_the_program_and_stops_with_the_run() -> None:
    bench = MachineBench("%P\nM03 S600\nG01 X5 F3000\nM30").run()
    end = next(b.first_cycle for b in bench.blocks["channel"] if b.first_cycle and b.done)
    stop = commands(bench)[-1]
    assert stop[1] == "stop" and stop[0] >= end + 200
    assert bench.last("s").set_speed_rpm[-1] == 0.0 and not bench.failed
