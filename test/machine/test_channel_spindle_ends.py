"""After an abort, a reset or the end of a program no spindle turns that the channel has set in motion (2.4.3, 2.8.3)."""

from __future__ import annotations

from dataclasses import replace

import pytest
from channel_spindle_support import (
    MANUAL,
    MOS,
    MVS_SVS,
    channel_spindle,
    machine_of,
    requests,
    run,
    three,
    told,
    two_channels,
)
from machine_support import MILL, MachineBench
from spindle_support import RPM, two_gears

from cnc_ptp.machine.blocks import AxisStateCode as S

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
    """The override comes back when no program lives any more."""
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
    """P-CHAN-00069: only the PLC knows whether the spindle stands."""
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
    """M05 above the control limit homes; a reset only stops, and a spindle that stands stays where it is."""
    unit = replace(two_gears(), gears={1: replace(two_gears().gears[1], control_limit=60.0 * RPM)})
    machine = machine_of(channel_spindle("S", "s", 4, MOS), units={"s": unit})
    bench = run("M3 S500\nG04 20", machine, override + "- {at: 3, to: channel, do: reset}")
    assert S.HOMING not in bench.column("s", "state") and stands(bench, "s")
    assert not override or rests_from(bench, "s", 2000)


# couplings


def notes(bench: MachineBench) -> list[str]:
    return [event.text for event in bench.events if event.error_id == 22025]


def test_a_slave_that_others_have_decoupled_gets_its_functions_itself() -> None:
    machine = machine_of(*three(MOS)[:2])
    bench = run(f"{LINK}M3 S600\nG04 2\nM5\nG04 1", machine, "- {at: 1, to: t, do: decouple}")
    given = [command for command, _ in told(bench, "t") if command != "coupling_answer"]
    assert given == ["couple", "decouple", "stop"]
    assert stands(bench, "s", "t") and notes(bench) == [
        "channel channel: spindle t does not follow s any more, others have decoupled it; the program goes on"
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
    assert "spindle t: decouple without effect, it was not 'second' who has coupled it" in refusals
    assert bench.column("t", "set_speed_rpm")[1900] == 600.0 and stands(bench, "s", "t")


def test_a_decoupled_slave_belongs_to_who_has_coupled_it() -> None:
    """Another channel has set its master turning, and stops only that."""
    bench = two(f"{LINK}G04 2", "G04 0.5\nM3 S600\nG04 3\nM5")
    assert bench.column("t", "set_speed_rpm")[5900] == 600.0 and bench.column("s", "set_speed_rpm")[5900] == 0.0
    assert stands(bench, "s", "t") and bench.errors() == []


def test_an_abort_stops_a_slave_whose_master_another_channel_turns() -> None:
    bench = two(f"{LINK}G04 2\nM19 S.POS300000\nG04 2", "G04 0.5\nM3 S600\nG04 4")
    assert "24006" in bench.errors()[0]
    assert bench.column("t", "set_speed_rpm")[3000] == 0.0 and bench.column("s", "set_speed_rpm")[3000] == 600.0


@pytest.mark.parametrize("own", [False, True])
def test_stop_at_program_end_stops_the_slaves_too(own: bool) -> None:
    """The couplings have ended before; a coupling that the program has ended itself is none any more."""
    scenario = "- {at: 0, to: s, do: stop_at_program_end, on: on}"
    end = "#DISABLE AX LINK[1]\nG04 0.1" if own else ""
    bench = MachineBench(
        f"%P\n{LINK}M3 S600\nG04 1\n{end}\nM30", scenario, machine=machine_of(*three(MOS)[:2]), end_when_idle=False
    )
    bench.run(3.0)
    assert stands(bench, "s") and bench.last("t").set_speed_rpm[-1] == (600.0 if own else 0.0)


@pytest.mark.parametrize("ratio", [(1e308, 1e-308), (1e-308, 1e308), (1.0, 1e-7)])
def test_a_ratio_that_is_no_ratio(ratio: tuple[float, float]) -> None:
    bench = MachineBench(None, machine=machine_of(*three(MOS)[:2]))
    shown = {1e308: "inf", 1e-308: "0", 1.0: "1e+07"}[ratio[0]]
    assert bench.refused("t", "couple", master="s", factor_num=ratio[0], factor_den=ratio[1]) == (
        f"P-ERR-24021 spindle t: couple refused: factor_num / factor_den = {shown} is not within ±1e-06 ... ±1e+06; "
        "nothing was changed"
    )
