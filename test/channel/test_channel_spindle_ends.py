"""After an abort, a reset or the end of a program no spindle turns that the channel has set in motion (2.4.3, 2.8.3)."""

from __future__ import annotations

from dataclasses import replace

import pytest
from channel_spindle_support import (
    MANUAL,
    MOS,
    MVS_SLM,
    MVS_SLP,
    MVS_SNS,
    MVS_SVS,
    channel_spindle,
    machine_of,
    requests,
    run,
    three,
    told,
    two_channels,
)
from long_support import long
from machine_support import MILL, MachineBench
from spindle_support import RPM, two_gears

from cnc_ptp.parameters import Synchronisation
from cnc_ptp.protocol.axis_states import AxisStateCode as S

DIGITAL = replace(MILL.spindles["s"], automatic_homing=False)
"""Homes from standstill only."""
GEAR_RANGES = ((50.0, 560.0), (400.0, 800.0))
LINK = "#SET AX LINK[1, S2=S]\n#ENABLE AX LINK[1]\n"


def stands(bench: MachineBench, *units: str) -> bool:
    """At the end of the run, with nothing that could set it in motion again."""
    return all(
        bench.last(unit).set_speed_rpm[-1] == 0.0 and bench.last(unit).state[-1] == S.STANDSTILL for unit in units
    )


def rests_from(bench: MachineBench, unit: str, cycle: int) -> bool:
    return not any(bench.column(unit, "set_speed_rpm")[cycle:])


# what was refused or withdrawn


@pytest.fixture
def unchecked_positions(monkeypatch: pytest.MonkeyPatch) -> None:
    """Programs pass the check with positions that spindles refuse: a refusal in the midst of a run."""
    monkeypatch.setattr("cnc_ptp.nc.spindles.LARGEST_POSITION", float("inf"))


@pytest.mark.parametrize(
    ("words", "refusal"),
    [
        (
            "M19 S100 S.POS=300000",
            "P-ERR-24006 spindle s: orient refused: position 300000.0 deg is not within ±214748.3647 deg; "
            "nothing was changed",
        ),
        (
            "G74 S1",
            "P-ERR-24009 spindle s: home refused: the drive homes the spindle from standstill only (P-AXIS-00015 0x100); "
            "stop it first; nothing was changed",
        ),
    ],
)
@pytest.mark.usefixtures("unchecked_positions")
@pytest.mark.parametrize("after", ["\nG04 1", ""])
def test_a_refused_positioning_stops_the_rotation_of_before(words: str, refusal: str, after: str) -> None:
    """Also when it is the last function of the program."""
    machine = machine_of(channel_spindle("S", "s", 4, MOS), units={"s": DIGITAL})
    bench = run(f"M3 S300\nG04 0.2\n{words}{after}", machine)
    assert bench.errors() == [
        f"P-ERR-22018 channel channel: s has refused a command, {refusal}; the path stops on its ramp and the program "
        "is aborted"
    ]
    assert told(bench) == [("start", {"direction": "cw", "speed_rpm": 300.0}), ("stop", {})] and stands(bench, "s")


def test_a_reset_before_the_positioning_has_gone_out() -> None:
    """It is withdrawn; what turns has turned before."""
    program = "M3 S1000\nG04 0.5\nM19 S100 S.POS=90\nG04 10"
    machine = machine_of(channel_spindle("S", "s", 4, MOS))
    first = run(program, machine)
    sent = next(record.cycle for record in first.records if record.command == "orient")
    bench = run(program, machine, f"- {{at: {(sent - 10) / 1000}, to: channel, do: reset}}")
    assert [command for command, _ in told(bench)] == ["start", "stop"] and stands(bench, "s")


# what is on its way


@pytest.mark.parametrize(
    ("program", "units"),
    [
        ("M19 S10 S.POS350 M3\nG01 X10 F600", {}),
        ("G74 S1\nG04 10", {}),
        ("M41\nM3 S500", {"s": two_gears(change_position=90.0)}),
    ],
)
def test_a_reset_ends_what_override_0_holds(program: str, units: dict[str, object]) -> None:
    """The override comes back when no program is active any longer."""
    spindle = channel_spindle("S", "s", 4, MVS_SVS, ranges=GEAR_RANGES)
    machine = machine_of(spindle, units=units, gear_change=bool(units))
    scenario = (
        MANUAL
        + """
- {at: 0, to: s, do: set_override, percent: 0}
- {at: 1, to: channel, do: reset}
- {at: 2, to: s, do: set_override, percent: 100}
"""
    )
    bench = run(program, machine, scenario)
    assert ("stop", {}) in told(bench) and rests_from(bench, "s", 1500) and stands(bench, "s")


def test_what_has_come_to_its_end_is_not_told_to_stop() -> None:
    """A spindle in position stays in position."""
    machine = machine_of(channel_spindle("S", "s", 4, MVS_SVS))
    bench = run("M19 S100 S.POS90\nG04 10", machine, "- {at: 4, to: channel, do: reset}")
    assert [command for command, _ in told(bench)] == ["orient"] and bench.last("s").in_position[-1]


def test_the_plc_hears_of_the_end_of_a_positioning_that_it_has_not_acknowledged() -> None:
    """P-CHAN-00069: only the PLC knows whether the spindle is at a standstill."""
    spindle = channel_spindle("S", "", 99, MVS_SVS)
    scenario = MANUAL + "- {at: 0.1, to: plc, do: acknowledge, id: 1}\n- {at: 1, to: channel, do: reset}"
    bench = run("M3 S1000\nM19 S.POS90", machine_of(spindle), scenario)
    assert [(request.number, request.acknowledge_needed) for request in requests(bench)] == [
        (3, True),
        (19, True),
        (5, False),
    ]


@pytest.mark.parametrize("override", ["", "- {at: 1, to: s, do: set_override, percent: 0}\n"])
def test_a_reset_homes_nothing(override: str) -> None:
    """M05 above the control limit homes; a reset only stops, and a spindle at a standstill stays where it is."""
    unit = replace(two_gears(), gears={1: replace(two_gears().gears[1], control_limit=60.0 * RPM)})
    machine = machine_of(channel_spindle("S", "s", 4, MOS), units={"s": unit})
    bench = run("M3 S500\nG04 20", machine, override + "- {at: 3, to: channel, do: reset}")
    assert S.HOMING not in bench.column("s", "state") and stands(bench, "s")
    assert not override or rests_from(bench, "s", 2000)


@pytest.mark.parametrize("end", ["reset", "M5", "M30"])
@pytest.mark.parametrize("at", [1.05, 1.9], ids=["on the way", "at the change position"])
def test_a_gear_change_of_the_plc_does_not_take_the_rotation_from_the_channel(end: str, at: float) -> None:
    """The interrupted rotation would continue after it; but its owner has stopped it meanwhile."""
    machine = machine_of(channel_spindle("S", "s", 4, MOS), units={"s": two_gears(change_position=90.0)})
    words = {"reset": "G04 10", "M5": f"G04 {at}\nM5\nG04 10", "M30": f"G04 {at}"}[end]
    scenario = (
        MANUAL
        + """
- {at: 0, to: s, do: stop_at_program_end, enabled: on}
- {at: 1, to: s, do: select_gear, stage: 2, source: plc}
- {at: 2.5, to: s, do: gear_changed}
"""
        + (f"- {{at: {at}, to: channel, do: reset}}\n" if end == "reset" else "")
    )
    bench = MachineBench(f"%P\nM3 S400\n{words}\nM30", scenario, machine=machine, end_when_idle=False).run(4.0)
    assert rests_from(bench, "s", 2500) and "stop" in dict(told(bench))


@pytest.mark.parametrize("kind", [MOS, MVS_SVS])
@pytest.mark.parametrize("at", [1.01, *long([1.0, 1.02, 1.03])])
def test_the_plc_hears_of_an_m5_that_a_reset_overtakes(kind: Synchronisation, at: float) -> None:
    machine = machine_of(channel_spindle("S", "", 99, kind))
    bench = run("M3 S1000\nG04 1\nM5\nG04 10", machine, f"- {{at: {at}, to: channel, do: reset}}")
    assert {request.number for request in requests(bench)} == {3, 5}


def test_a_position_that_the_plc_has_acknowledged_is_kept() -> None:
    machine = machine_of(channel_spindle("S", "", 99, MVS_SVS))
    bench = run("M19 S.POS90\nG04 10", machine, "- {at: 1, to: channel, do: reset}")
    assert [request.number for request in requests(bench)] == [19]


@pytest.mark.parametrize("resume", ["on", "off"])
def test_a_scenario_says_whether_the_rotation_goes_on_after_its_gear_change(resume: str) -> None:
    machine = machine_of(channel_spindle("S", "s", 4, MOS), units={"s": two_gears(change_position=90.0)})
    scenario = f"- {{at: 1, to: s, do: select_gear, stage: 2, resume: {resume}}}"
    bench = MachineBench("%P\nM3 S400\nM30", scenario, machine=machine, end_when_idle=False).run(4.0)
    assert bench.last("s").gear[-1] == 2
    assert bench.last("s").set_speed_rpm[-1] == (400.0 if resume == "on" else 0.0)


# the next program


@pytest.mark.parametrize("speed", [MOS, MVS_SVS])
@pytest.mark.parametrize(
    ("program", "before"),
    [
        ("G01 X50 F600 M3 S300", "{at: 0, to: s, do: power, enabled: off}\n- {at: 3, to: s, do: power, enabled: on}"),
        ("M3 S300\nG01 X50 F600", "{at: 0.01, to: channel, do: reset}"),
        ("M3 S300\nG01 X5 F600", "{at: 2, to: s, do: stop}"),
    ],
    ids=["refused", "withdrawn", "stopped by people"],
)
def test_after_a_reset_the_channel_knows_that_nothing_turns(program: str, before: str, speed: Synchronisation) -> None:
    """S alone commands nothing then, nobody waits for it, and nobody is warned."""
    scenario = f"""
- {before}
- {{at: 3, to: channel, do: reset}}
- {{at: 3.1, to: channel, do: mdi, text: "S500\\nG01 X1 F600"}}
"""
    machine = machine_of(channel_spindle("S", "s", 4, MOS, s=speed))
    bench = MachineBench(f"%P\n{program}\nM30", scenario, machine=machine, end_when_idle=False).run(6.0)
    late = [event.text for event in bench.events if event.cycle >= 3050]
    assert late == [] and "set_speed" not in dict(told(bench)) and bench.position("x") == 1.0


def test_a_fault_of_an_idle_channel_stops_what_its_program_has_left_turning() -> None:
    bench = MachineBench("%P\nM3 S300\nM30", machine=machine_of(channel_spindle("S", "s", 4, MOS)), end_when_idle=False)
    bench.run(1.0)
    assert bench.last("s").set_speed_rpm[-1] == 300.0
    assert bench.give("channel", "upstream_lost", source="x").accepted
    bench.run(1.0)
    assert stands(bench, "s") and bench.errors() == [
        "P-ERR-26101 channel channel: no block of 'x' came within the watchdog time; its spindles stop"
    ]


@pytest.mark.parametrize("late", [MVS_SLM, MVS_SVS, MVS_SLP, MVS_SNS])
@pytest.mark.parametrize("program", ["M3 S1000\nG04 2\nS500", "M3 S1000\nG04 2\nS500 M30", "M3 S1000\nS500"])
def test_a_program_ends_after_a_speed_that_renews_a_late_wait(program: str, late: Synchronisation) -> None:
    bench = run(program, machine_of(channel_spindle("S", "s", 4, late)))
    assert bench.errors() == [] and len(bench.blocks["plc"]) < 500


def test_the_stop_at_the_end_of_a_program_homes_as_m5_does() -> None:
    """The control limit was exceeded; the reference comes back (2.7)."""
    unit = replace(two_gears(), gears={1: replace(two_gears().gears[1], control_limit=60.0 * RPM)})
    machine = machine_of(channel_spindle("S", "s", 4, MOS), units={"s": unit})
    scenario = "- {at: 0, to: s, do: stop_at_program_end, enabled: on}"
    bench = MachineBench("%P\nM3 S500\nG04 2\nM30", scenario, machine=machine, end_when_idle=False).run(12.0)
    assert S.HOMING in bench.column("s", "state") and bench.last("s").referenced[-1] and stands(bench, "s")


# couplings


def notes(bench: MachineBench) -> list[str]:
    return [event.text for event in bench.events if event.error_id == 22025]


def test_a_slave_that_others_have_decoupled_gets_its_functions_itself() -> None:
    machine = machine_of(*three(MOS)[:2])
    bench = run(f"{LINK}M3 S600\nG04 2\nM5\nG04 1", machine, "- {at: 1, to: t, do: decouple}")
    given = [command for command, _ in told(bench, "t") if command != "coupling_answer"]
    assert given == ["couple", "decouple", "stop"]
    assert stands(bench, "s", "t") and notes(bench) == [
        "channel channel: spindle t no longer follows s, others have decoupled it; the program continues"
    ]


def two(first: str, second: str) -> MachineBench:
    """Programs of two channels at once, with resets of both in the end."""
    scenario = "- {at: 6, to: channel, do: reset}\n- {at: 6, to: second, do: reset}"
    bench = MachineBench(f"%P\n{first}\nM30", scenario, machine=two_channels())
    for command, arguments in (("load", {"program": "q.nc", "text": f"%Q\n{second}\nM30"}), ("start", {})):
        assert bench.give("second", command, **arguments).accepted
    return bench.run(8.0)


def test_a_coupling_belongs_to_the_channel_that_was_first() -> None:
    """The other program ends, and does not take the coupling from the first."""
    bench = two(f"{LINK}M3 S600\nG04 2\nM5", f"G04 0.5\n{LINK}M5\nG04 1")
    assert bench.errors() == [
        "P-ERR-22018 channel second: t has refused a command, P-ERR-24027 spindle t: couple refused: the spindle is a "
        "slave of s; decouple it first; nothing was changed; the path stops on its ramp and the program is aborted"
    ]
    couplings = [(cycle, block.master) for block in bench.blocks["t"] for cycle in [block.first_cycle]]
    assert {master for cycle, master in couplings if 100 < cycle < 2000} == {"s"} and couplings[-1][1] == ""
    refusals = [record.message for record in bench.records if record.command == "decouple"]
    assert "spindle t: decouple without effect, it was not coupled by 'second'" in refusals
    assert bench.column("t", "set_speed_rpm")[1900] == 600.0 and stands(bench, "s", "t")


def test_a_decoupled_slave_belongs_to_who_has_coupled_it() -> None:
    """Another channel has set its master turning, and stops only that."""
    bench = two(f"{LINK}G04 2", "G04 0.5\nM3 S600\nG04 3\nM5")
    assert bench.column("t", "set_speed_rpm")[5900] == 600.0 and bench.column("s", "set_speed_rpm")[5900] == 0.0
    assert stands(bench, "s", "t") and bench.errors() == []


@pytest.mark.usefixtures("unchecked_positions")
def test_an_abort_stops_a_slave_whose_master_another_channel_turns() -> None:
    bench = two(f"{LINK}G04 2\nM19 S.POS300000\nG04 2", "G04 0.5\nM3 S600\nG04 4")
    assert "24006" in bench.errors()[0]
    assert bench.column("t", "set_speed_rpm")[3000] == 0.0 and bench.column("s", "set_speed_rpm")[3000] == 600.0


def test_a_refused_couple_stops_nobody() -> None:
    """The slave stays with the channel that was first, whoever turns its master."""
    bench = MachineBench(
        f"%P\n{LINK}G04 10\nM30",
        "- {at: 1, to: s, do: start, direction: cw, speed_rpm: 600}",
        machine=two_channels(),
        end_when_idle=False,
    )
    assert bench.give("second", "load", program="q.nc", text=f"%Q\nG04 2\n{LINK}G04 1\nM30").accepted
    assert bench.give("second", "start").accepted
    bench.run(5.0)
    assert "24027" in bench.errors()[0] and not rests_from(bench, "t", 4990) and bench.last("t").master == "s"


@pytest.mark.parametrize("at", [1.01, *long([1.0, 1.02, 1.03])])
def test_a_slave_does_not_start_while_the_reset_decouples_it(at: float) -> None:
    scenario = f"- {{at: 1, to: s, do: start, direction: cw, speed_rpm: 600}}\n- {{at: {at}, to: channel, do: reset}}"
    bench = run(f"{LINK}G04 10", machine_of(*three(MOS)[:2]), scenario)
    assert rests_from(bench, "t", 2000) and bench.last("t").master == ""


@pytest.mark.parametrize("again", ["master: s", "master: u"])
@pytest.mark.parametrize("at", [1.0, *long([1.1])])
@pytest.mark.parametrize("end", ["", "#DISABLE AX LINK[1]"])
def test_a_coupling_of_people_is_none_of_the_program(again: str, at: float, end: str) -> None:
    """They have ended that of the program and made their own; the program does not wait for its end."""
    scenario = f"- {{at: 1, to: t, do: decouple}}\n- {{at: {at}, to: t, do: couple, {again}}}"
    machine = machine_of(*three(MOS))
    bench = MachineBench(f"%P\n{LINK}G04 2\n{end}\nM30", scenario, machine=machine, end_when_idle=False).run(4.0)
    assert bench.last("channel").done and bench.last("t").master == again[-1] and bench.errors() == []


@pytest.mark.parametrize("own", [False, True])
def test_stop_at_program_end_stops_the_slaves_too(own: bool) -> None:
    """The couplings have ended before; a coupling that the program has ended itself no longer counts."""
    scenario = "- {at: 0, to: s, do: stop_at_program_end, enabled: on}"
    end = "#DISABLE AX LINK[1]\nG04 0.1" if own else ""
    bench = MachineBench(
        f"%P\n{LINK}M3 S600\nG04 1\n{end}\nM30", scenario, machine=machine_of(*three(MOS)[:2]), end_when_idle=False
    )
    bench.run(3.0)
    assert stands(bench, "s") and bench.last("t").set_speed_rpm[-1] == (600.0 if own else 0.0)


@pytest.mark.interpreted
@pytest.mark.parametrize("ratio", [(1e308, 1e-308), (1e-308, 1e308), (1.0, 1e-7)])
def test_a_ratio_that_is_no_ratio(ratio: tuple[float, float]) -> None:
    bench = MachineBench(None, machine=machine_of(*three(MOS)[:2]))
    shown = {1e308: "inf", 1e-308: "0", 1.0: "1e+07"}[ratio[0]]
    assert bench.refused("t", "couple", master="s", factor_num=ratio[0], factor_den=ratio[1]) == (
        f"P-ERR-24021 spindle t: couple refused: factor_num / factor_den = {shown} is not within ±1e-06 ... ±1e+06; "
        "nothing was changed"
    )
