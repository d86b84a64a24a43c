"""Every control unit of the HLI: what acts while a PLC serves it, what others ask for meanwhile, what acts afterwards."""

from __future__ import annotations

from typing import Any

import pytest
from hli_support import HliBench
from machine_support import MachineBench, axis_parameters, position_after, seven_phases

from cnc_ptp.errors import CncError
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.channel_states import ChannelStateCode as C
from cnc_ptp.protocol.control_units import CONTROL_UNITS

ON, OFF = {"enabled": True}, {"enabled": False}

# kind, control unit, at the start, what others ask for (command, arguments), what that is, what the PLC commands
LEVELS: list[tuple[str, str, float, str, dict[str, Any], float, float]] = [
    ("axis", "feed_hold", 0, "feed_hold", ON, 1, 0),
    ("axis", "override", 100, "set_override", {"percent": 80.0}, 80, 50),
    ("axis", "controller_enable", 1, "power", OFF, 0, 1),
    ("axis", "feed_enable_forward", 1, "set_feed_release", {"forward": False, "backward": True}, 0, 1),
    ("axis", "feed_enable_backward", 1, "set_feed_release", {"forward": True, "backward": False}, 0, 1),
    ("spindle", "feed_hold", 0, "feed_hold", ON, 1, 0),
    ("spindle", "override", 100, "set_override", {"percent": 80.0}, 80, 50),
    ("spindle", "controller_enable", 1, "power", OFF, 0, 1),
    ("spindle", "stop_at_program_end", 0, "stop_at_program_end", ON, 1, 0),
    ("channel", "feed_hold", 0, "feed_hold", ON, 1, 0),
    ("channel", "override", 100, "set_override", {"percent": 80.0}, 80, 50),
    ("channel", "single_block", 0, "single_block", {"enabled": True, "mode": "motion"}, 2, 1),
    ("channel", "optional_stop", 0, "optional_stop", ON, 1, 0),
    ("channel", "block_skip", 0, "block_skip", {"enabled": True, "level": 3}, 4, 513),
]
OF_THE_PLC = [(kind, name) for kind in ("axis", "spindle") for name in ("override_valid", "drive_ready")]
OF_THE_PLC.append(("channel", "override_valid"))
EDGES = [
    ("axis", "reset"), ("spindle", "reset"), ("spindle", "gear_changed"),
    ("channel", "reset"), ("channel", "start"), ("channel", "measuring_event"),
]  # fmt: skip
EITHER = [(kind, "emergency_stop") for kind in ("axis", "spindle", "channel")]


def test_the_cases_below_are_all_control_units() -> None:
    cases = [row[:2] for row in LEVELS] + OF_THE_PLC + EDGES + EITHER
    table = [(kind, unit.name) for kind, units in CONTROL_UNITS.items() for unit in units]
    assert sorted(cases) == sorted(table)
    assert sorted(EDGES) == sorted((kind, u.name) for kind, units in CONTROL_UNITS.items() for u in units if u.edge)


# ---------------------------------------------------------------- levels


@pytest.mark.parametrize(("kind", "unit", "start", "command", "arguments", "asked", "plc"), LEVELS)
def test_the_plc_takes_a_value_over_and_gives_it_back(
    kind: str, unit: str, start: float, command: str, arguments: dict[str, Any], asked: float, plc: float
) -> None:
    bench = HliBench(kind)
    assert bench.state(unit) == (False, start, start)
    assert bench.serve(unit, plc).accepted
    assert bench.state(unit) == (True, start, plc)
    record = bench.ask(command, **arguments)
    text = (
        f"P-WARN-26160 {kind} {bench.name}: {command} waits: the PLC 'p1' serves {unit} and commands {plc:g}; what is "
        f"asked for acts when it gives {unit} back"
    )
    assert (record.accepted, record.message) == (True, text)
    assert bench.state(unit) == (True, asked, plc)
    assert bench.give_back(unit).accepted
    assert bench.state(unit) == (False, asked, asked)


@pytest.mark.parametrize(("kind", "unit", "start", "command", "arguments", "asked", "plc"), LEVELS)
def test_a_value_of_a_silent_plc_is_taken_back_by_others_but_not_what_holds_back(
    kind: str, unit: str, start: float, command: str, arguments: dict[str, Any], asked: float, plc: float
) -> None:
    """In both directions: the value of the PLC above, and the one that others ask for, which the PLC had commanded."""
    holds_back = {"feed_hold": 1.0}.get(unit, 0.0 if "enable" in unit else None)
    for value in (plc, asked):
        bench = HliBench(kind)
        bench.serve(unit, value)
        bench.serve(unit, value, silent=True)
        assert bench.state(unit) == (True, start, value)
        message = bench.ask(command, **arguments).message
        if value == holds_back:
            text = (
                f"P-WARN-26160 {kind} {bench.name}: {command} waits: the PLC 'p1' serves {unit} and commands {value:g}; "
                f"what is asked for acts when it gives {unit} back, or another PLC serves it: it is silent, and only a "
                "PLC takes back what holds back"
            )
            assert (message, bench.state(unit)) == (text, (True, asked, value))
        else:
            taken = f"takes {unit} back from the PLC 'p1', which had commanded {value:g} and is silent"
            assert f"P-WARN-26180 {kind} {bench.name}: {command} {taken}" in message
            assert bench.state(unit) == (False, asked, asked)


def test_others_take_back_what_only_a_plc_gives_of_the_same_command() -> None:
    """Without `override_valid` the override would not act; a drive that is not ready keeps the power off."""
    bench = HliBench("axis")
    bench.serve("override_valid", 0.0, silent=True)
    bench.serve("drive_ready", 0.0, silent=True)
    assert "takes override_valid back" in bench.ask("set_override", percent=30.0).message
    assert bench.bench.last.override_percent[-1] == 30.0
    bench.ask("power", enabled=True)
    assert bench.bench.state == S.DISABLED
    bench.serve("drive_ready", 1.0, holder="p2")
    assert bench.bench.state == S.STANDSTILL and bench.known["drive_ready"].holder == "p2"


@pytest.mark.interpreted
def test_a_refused_command_takes_nothing_back_from_a_silent_plc() -> None:
    bench = HliBench("spindle")
    bench.serve("override", 50.0, silent=True)
    assert not bench.ask("set_override", percent=1e6).accepted
    bench.bench.unit.carry_out = refuse  # type: ignore[method-assign]
    assert not bench.ask("set_override", percent=30.0).accepted
    assert bench.state("override") == (True, 100.0, 50.0) and bench.bench.unit.overlay.is_silent("override")


def refuse(command: str, cycle: int) -> str | None:
    raise CncError(24006, "no", "nothing was changed")


@pytest.mark.parametrize(("kind", "unit", "start", "command", "arguments", "asked", "plc"), LEVELS)
def test_what_nobody_serves_acts_as_ever(
    kind: str, unit: str, start: float, command: str, arguments: dict[str, Any], asked: float, plc: float
) -> None:
    bench = HliBench(kind)
    assert not bench.ask(command, **arguments).message.startswith("P-WARN-26160")
    assert bench.state(unit) == (False, asked, asked)


@pytest.mark.parametrize(("kind", "unit"), OF_THE_PLC)
def test_what_only_the_plc_gives(kind: str, unit: str) -> None:
    bench = HliBench(kind)
    assert bench.state(unit) == (False, 1.0, 1.0)
    bench.serve(unit, 0.0)
    assert bench.state(unit) == (True, 1.0, 0.0)
    bench.give_back(unit)
    assert bench.state(unit) == (False, 1.0, 1.0)


def test_without_override_valid_the_override_is_100_percent() -> None:
    bench = HliBench("axis")
    bench.ask("set_override", percent=30.0)
    bench.serve("override_valid", 0.0)
    assert bench.bench.last.override_percent[-1] == 100.0
    bench.serve("override_valid", 1.0)
    assert bench.bench.last.override_percent[-1] == 30.0


@pytest.mark.parametrize("kind", ["axis", "spindle"])
def test_the_power_is_the_controller_enable_of_a_drive_that_is_ready(kind: str) -> None:
    bench = HliBench(kind)
    powered = []
    for enable, ready in ((1, 0), (1, 1), (0, 1), (0, 0)):
        bench.serve("controller_enable", enable)
        bench.serve("drive_ready", ready)
        powered.append(bench.bench.state != S.DISABLED)
    assert powered == [False, True, False, False]


def test_half_a_command_may_be_served() -> None:
    """Forward waits for the PLC, backward acts."""
    bench = HliBench("axis")
    bench.serve("feed_enable_forward", 1.0)
    record = bench.ask("set_feed_release", forward=False, backward=False)
    assert record.message.startswith(
        "P-WARN-26160 axis x: set_feed_release waits: the PLC 'p1' serves feed_enable_forward"
    )
    assert [bench.state(f"feed_enable_{side}")[2] for side in ("forward", "backward")] == [1.0, 0.0]
    assert bench.ask("move_absolute", target=1.0).accepted
    bench.run(2000)
    assert bench.bench.last.set_position[-1] == 1.0
    bench.ask("move_absolute", target=0.0)
    bench.run(100)
    assert bench.bench.last.set_position[-1] == 1.0


def test_a_feed_hold_of_an_axis_stops_its_motion_and_lets_it_go_on() -> None:
    """Closed form: the motion is the textbook one until the hold; then a ramp; at the end the target."""
    p = axis_parameters()
    bench = HliBench("axis")
    bench.bench.accepted("move_absolute", target=1000.0, velocity=500.0)
    bench.run(500)
    expected = position_after(seven_phases(1000.0, 500.0, p.acceleration, p.deceleration, p.jerk), 0.5)
    assert bench.bench.last.set_position[-1] == pytest.approx(expected[0] - expected[1] * 0.001, abs=1e-6)
    bench.serve("feed_hold", 1.0)
    bench.run(600)
    ramp = 500.0**2 / (2.0 * p.deceleration) + 500.0 * p.deceleration / (2.0 * p.jerk)
    assert bench.bench.last.set_velocity[-1] == 0.0
    assert bench.bench.last.set_position[-1] == pytest.approx(expected[0] + ramp, abs=1e-6)
    bench.give_back("feed_hold")
    bench.run(3000)
    assert bench.bench.last.set_position[-1] == 1000.0


def test_a_feed_hold_of_an_axis_on_a_path_holds_the_path() -> None:
    bench = MachineBench("%P\nG01 X20 Y20 F3000\nM30", end_when_idle=False).run(0.2)
    assert bench.give("x", "feed_hold", enabled=True).accepted
    bench.run(1.0)
    held = bench.position("x")
    assert 0.0 < held < 20.0 and bench.last("channel").state[-1] == C.HOLD
    bench.give("x", "feed_hold", enabled=False)
    bench.run(2.0)
    assert bench.position("x") == bench.position("y") == 20.0


def test_a_feed_hold_of_a_spindle_stops_it_and_lets_it_turn_again_with_g167_too() -> None:
    bench = HliBench("spindle")
    bench.bench.accepted("start", direction="cw", speed_rpm=600.0)
    bench.bench.accepted("suppress_override", enabled=True)
    bench.run(500)
    assert bench.bench.last.set_speed_rpm[-1] == 600.0
    bench.serve("feed_hold", 1.0)
    bench.run(500)
    assert bench.bench.last.set_speed_rpm[-1] == 0.0 and bench.bench.state == S.CONTINUOUS_MOTION
    assert bench.ask("feed_hold", enabled=False).accepted
    bench.give_back("feed_hold")
    bench.run(500)
    assert bench.bench.last.set_speed_rpm[-1] == 600.0


def test_what_is_beyond_the_limits_is_refused_whoever_serves_the_value() -> None:
    bench = HliBench("channel")
    too_much = "percent = 500.0 is not within 0 ... 200 (P-CHAN-00056); nothing was changed"
    limit = bench.bench.unit._parameters.max_override_percent  # type: ignore[attr-defined]
    too_much = too_much.replace("200", f"{limit:g}")
    assert bench.ask("set_override", percent=500.0).message == f"channel channel: set_override refused: {too_much}"
    bench.serve("override", 50.0)
    assert bench.ask("set_override", percent=500.0).message == f"channel channel: set_override refused: {too_much}"
    assert bench.serve("override", 500.0).message == f"channel channel: overlay refused: {too_much}"
    assert bench.state("override") == (True, 100.0, 50.0)
    assert not bench.ask("block_skip", enabled=True, level=11).accepted


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (
            {"control_unit": "single_blok", "enabled": True, "value": 1.0},
            "unknown control unit 'single_blok'; did you mean single_block?; nothing was changed. Known: feed_hold, "
            "override, override_valid, single_block, optional_stop, block_skip, emergency_stop, reset, start, "
            "measuring_event",
        ),
        ({"control_unit": "feed_hold", "enabled": True}, "argument 'value' is missing; nothing was changed"),
        (
            {"control_unit": "single_block", "enabled": True, "value": 3.0},
            "value = 3 of single_block is not a whole number within 0 ... 2; nothing was changed",
        ),
        (
            {"control_unit": "optional_stop", "enabled": True, "value": 0.5},
            "value = 0.5 of optional_stop is not a whole number within 0 ... 1; nothing was changed",
        ),
    ],
)
def test_an_overlay_that_cannot_be(arguments: dict[str, Any], reason: str) -> None:
    record = HliBench("channel").ask("overlay", **arguments)
    assert (record.error_id, record.message) == (22001, f"channel channel: overlay refused: {reason}")


def test_another_plc_that_serves_it_is_named() -> None:
    bench = HliBench("axis")
    bench.serve("override", 50.0)
    bench.serve("override", 60.0, holder="p2")
    assert "the PLC 'p2' serves override and commands 60;" in bench.ask("set_override", percent=1.0).message
    assert bench.known["override"].holder == "p2"


def test_all_control_units_are_in_the_first_block_and_later_only_changes() -> None:
    bench = HliBench("axis")
    names = [unit.name for unit in CONTROL_UNITS["axis"]]
    assert [state.name for state in bench.bench.blocks[0].control_units] == names
    assert bench.run().control_units == []
    bench.serve("override", 50.0)
    assert [state.name for state in bench.bench.last.control_units] == ["override"]


# ---------------------------------------------------------------- edges


@pytest.mark.parametrize(("kind", "unit"), EDGES)
def test_an_edge_that_the_plc_serves_is_refused_to_others_and_shown(kind: str, unit: str) -> None:
    bench = HliBench(kind)
    assert bench.state(unit) == (False, 0.0, 0.0)
    bench.serve(unit)
    record = bench.ask(unit)
    text = f"the PLC 'p1' serves {unit}; it is shown what was asked for; nothing was changed"
    assert (record.error_id, record.message) == (26161, f"{kind} {bench.name}: {unit} refused: {text}")
    assert bench.state(unit) == (True, 1.0, 0.0)
    bench.give_back(unit)
    assert bench.state(unit) == (False, 0.0, 0.0)
    assert bench.ask(unit).error_id != 26161


def test_the_plc_carries_an_edge_out() -> None:
    bench = HliBench("axis")
    bench.bench.accepted("upstream_lost", source="clock")
    bench.run()
    assert bench.bench.state == S.ERROR_STOP
    bench.serve("reset")
    assert not bench.ask("reset").accepted and bench.state("reset") == (True, 1.0, 0.0)
    assert bench.serve("reset", 1.0).accepted
    assert bench.bench.state == S.STANDSTILL and bench.state("reset") == (True, 0.0, 1.0)


def test_an_edge_that_the_unit_refuses_changes_nothing() -> None:
    bench = HliBench("spindle")
    record = bench.serve("gear_changed", 1.0)
    text = "spindle s: gear_changed refused: no gear change waits for its acknowledgement; nothing was changed"
    assert (record.error_id, record.message) == (24015, text)
    assert bench.state("gear_changed") == (False, 0.0, 0.0)


def test_a_program_is_started_by_an_edge_and_is_a_job() -> None:
    bench = MachineBench("%P\nG01 X5 F3000\nM30", start=False)
    bench.run(0.05)
    record = bench.give("channel", "overlay", control_unit="start", enabled=True, value=1.0, holder="p1")
    bench.run()
    assert record.accepted and record.job == 1
    assert bench.position("x") == 5.0 and not bench.failed


def test_the_machine_s_own_plc_stops_everything_although_the_reset_is_served() -> None:
    bench = MachineBench("%P\nG01 X100 F300\nM30", "- {at: 0.5, to: plc, do: stop_all}")
    bench.run(0.1)
    bench.give("channel", "overlay", control_unit="reset", enabled=True, value=0.0, holder="p1")
    assert "serves reset" in bench.refused("channel", "reset")
    bench.run()
    assert bench.last("channel").state[-1] == C.READY and bench.position("x") < 10.0


# ---------------------------------------------------------------- emergency stop of one object


@pytest.mark.parametrize("kind", ["axis", "spindle", "channel"])
def test_an_emergency_stop_acts_whoever_wants_it_and_no_overlay_takes_it_away(kind: str) -> None:
    bench = HliBench(kind)
    bench.serve("emergency_stop", 0.0)
    bench.ask("set_emergency_stop", enabled=True)
    assert bench.state("emergency_stop") == (True, 1.0, 1.0)
    assert bench.bench.last.error_id[-1] == 26168
    bench.serve("emergency_stop", 1.0)
    bench.ask("set_emergency_stop", enabled=False)
    assert bench.state("emergency_stop") == (True, 0.0, 1.0)
    record = bench.ask("reset")
    text = f"{kind} {bench.name}: reset refused: the emergency stop holds; release it first; nothing was changed"
    assert (record.error_id, record.message) == (26169, text)
    assert bench.serve("reset", 1.0).error_id == 26169
    bench.give_back("emergency_stop")
    assert bench.bench.last.error_id[-1] == 26168  # released, and still to be reset
    bench.run(1000)
    assert bench.ask("reset").accepted and bench.bench.last.error_id[-1] == 0
