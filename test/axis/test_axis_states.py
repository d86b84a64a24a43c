"""All commands of an axis in all its situations: what is refused or has no effect, and the state that follows."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import pytest
from axis_states_support import COMMANDS, STATES, follow_path
from machine_support import UnitBench, axis_bench

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit, state_name

PTP_MOTION = ("moving", "braking", "held", "returning", "halting", "adding", "compensating", "external_beside")
STOPPED = ("stopping", "waiting", "powered_off_in_motion")
IN_ERROR = ("error_ramp", "error_stop")
AT_REST = ("disabled", "standing")
JOGGING = ("jogging", "jog_ended")
ADDING = ("adding", "only_adding")
FREE = (*PTP_MOTION[:-2], *JOGGING, "velocity", "only_adding")
"""In motion, and nothing else keeps another motion from aborting it."""
EXTERNAL = ("external", "external_beside")
NAME = {state: state_name(code) for state, (_, code) in STATES.items()}
"""The PLCopen name of each situation's state."""

MOVES = ("move_absolute", "move_relative", "move_modulo", "move_velocity")
MODES = ("move_absolute aborting", "move_absolute buffered", "move_velocity aborting")
REDIRECTIONS = ("new_target", "new_velocity_and_target")
STOPS = ("stop", "halt", "emergency_stop")
ENABLES = ("external_enable absolute", "external_enable relative")

Texts = dict[tuple[str, str], str]


def refused(number: int, commands: tuple[str, ...], states: tuple[str, ...], reason: str) -> Texts:
    """The same reason for these commands in these situations; {state} stands for the name of the state."""
    return {
        (command, state): (
            f"P-ERR-{number} axis x: {command.split()[0]} refused: {reason.format(state=NAME[state])}; "
            "nothing was changed"
        )
        for command in commands
        for state in states
    }


def warned(commands: tuple[str, ...], states: tuple[str, ...], text: str, number: str = "") -> Texts:
    return {
        (command, state): f"{number}axis x: " + text.format(command=command.split()[0], state=NAME[state])
        for command in commands
        for state in states
    }


REFUSALS: Texts = {
    **refused(
        23005,
        MOVES,
        tuple(state for state in STATES if state not in ("standing", *EXTERNAL)),
        "the axis is in {state}, it must be in Standstill",
    ),
    **refused(
        23005,
        MODES,
        ("disabled", *STOPPED, "on_path", *IN_ERROR),
        "the axis is in {state}, it must be in Standstill, DiscreteMotion or ContinuousMotion",
    ),
    **refused(23015, (MODES[0], MODES[2]), ("compensating",), "a position compensation is active"),
    **refused(23005, ("move_superimposed",), ("disabled", *STOPPED, *IN_ERROR), "the axis is in {state}"),
    **refused(23015, ("move_superimposed",), ("compensating",), "a position compensation is active"),
    **refused(23027, ("move_superimposed",), EXTERNAL, "external setpoints are enabled"),
    **refused(
        23059,
        ("compensation_start", "external_enable relative"),
        ADDING,
        "a superimposed motion is active",
    ),
    **refused(23005, ("set_position",), ("on_path",), "the axis is in {state}"),
    **refused(23027, ("set_position",), EXTERNAL, "external setpoints are enabled; disable them"),
    **refused(
        23005,
        ("jog",),
        tuple(state for state in STATES if state not in ("standing", "jogging", "jog_ended", *EXTERNAL)),
        "the axis is in {state}, it must be in Standstill or jogging",
    ),
    **refused(
        23027,
        (*MOVES, *MODES, "jog"),
        EXTERNAL,
        "external setpoints are enabled; a PTP start is not permitted at the same time",
    ),
    **refused(23005, STOPS, ("on_path",), "the channel path moves the axis; use feed_hold or reset of the channel"),
    **refused(
        23017,
        ("emergency_stop",),
        ("braking",),
        "the axis is in its brake phase",
    ),
    **refused(
        23014,
        REDIRECTIONS,
        (*AT_REST, "external", "only_adding", "on_path", *IN_ERROR),
        "no positioning is active (the axis is in {state}); start one",
    ),
    **refused(23005, REDIRECTIONS, ("powered_off_in_motion",), "the enable was removed"),
    **refused(23015, REDIRECTIONS, ("compensating",), "a position compensation is active"),
    **refused(
        23021,
        ("compensation_start",),
        (*AT_REST, "external", "on_path", *IN_ERROR),
        "no basic motion is active (the axis is in {state})",
    ),
    **refused(
        23020,
        ("compensation_start",),
        ("braking", "halting", "jog_ended", *STOPPED),
        "the axis is stopping or in its brake phase",
    ),
    **refused(23020, ("compensation_start",), ("returning",), "the axis stops in order to return to its target"),
    **refused(
        23019,
        ("compensation_start",),
        ("compensating",),
        "a position compensation is active; it cannot be started again",
    ),
    **refused(  # the motion leads to the limit, and the compensation would lead beyond
        120002,
        ("compensation_start",),
        ("jogging", "velocity"),
        "target 100005.0 mm lies beyond the positive soft limit 100000.0 mm (P-AXIS-00178)",
    ),
    **refused(23028, ENABLES, ("disabled", "powered_off_in_motion"), "the axis is not enabled; power it on"),
    **refused(23029, ENABLES, IN_ERROR, "the axis has error 26101; reset it"),
    **refused(
        23026,
        ENABLES[:1],
        ("on_path",),
        "absolute setpoints are not permitted on the path of a channel; use relative",
    ),
    **refused(23005, ENABLES, ("stopping", "waiting"), "the axis is in {state}"),
    **refused(
        23026,
        ENABLES[:1],
        (*PTP_MOTION[:-1], *JOGGING, "velocity", "only_adding"),
        "absolute setpoints are not permitted during a PTP motion; use relative",
    ),
    **refused(
        23025,
        ENABLES[:1],
        ("external_beside",),
        "external setpoints are enabled as relative; absolute does not match",
    ),
    **refused(23025, ENABLES[1:], ("external",), "external setpoints are enabled as absolute; relative does not match"),
    **refused(23008, ("reset",), ("error_ramp",), "the axis still moves on its error ramp; wait for standstill"),
}
OVERRIDE_IDLE = "override 60.0 % does not change the active motion"
IGNORED = "P-WARN-23031 axis x: external_setpoints ignored: external setpoints are not enabled"
WARNINGS: Texts = {
    **warned(
        ("power on",),
        tuple(state for state in STATES if state not in ("disabled", "powered_off_in_motion")),
        "power is on already",
    ),
    **warned(("power off",), ("disabled", "powered_off_in_motion"), "power is off already"),
    **warned(STOPS, (*AT_REST, *IN_ERROR), "{command} without effect in {state}", "P-WARN-23073 "),
    **warned(STOPS[:2], ("stopping", "powered_off_in_motion"), "{command} without effect in {state}", "P-WARN-23073 "),
    **warned(STOPS, ("waiting",), "{command} cancels the waiting new target; the axis stops"),
    **warned(("set_override",), ("halting", "jog_ended", *STOPPED), f"{OVERRIDE_IDLE} (the axis stops)"),
    **warned(("set_override",), ("braking",), f"{OVERRIDE_IDLE} (brake phase or level out of reach)"),
    **warned(REDIRECTIONS, ("stopping", "waiting"), "{command} waits for the end of the stop"),
    **warned(
        ("compensation_stop",),
        tuple(state for state in STATES if state != "compensating"),
        "{command} without effect: no compensation is active",
    ),
    **warned(
        ("halt_superimposed",),
        tuple(state for state in STATES if state not in ADDING),
        "{command} without effect: no superimposed motion is active",
    ),
    **warned(
        ("external_disable",),
        tuple(state for state in STATES if state not in EXTERNAL),
        "{command} without effect: external setpoints are not enabled",
    ),
    **{("external_setpoints", state): IGNORED for state in STATES if state not in EXTERNAL},
}
ACTING = {
    *((command, state) for command in REDIRECTIONS for state in ("stopping", "waiting")),
    *((command, "waiting") for command in (*STOPS, "set_override")),
}
"""Warnings about a later effect, or take one back."""


def led_to(state: S, commands: tuple[str, ...], situations: tuple[str, ...]) -> dict[tuple[str, str], S]:
    return {(command, situation): state for command in commands for situation in situations}


AFTER: dict[tuple[str, str], S] = {
    **led_to(S.DISCRETE_MOTION, (*MOVES[:3], *MODES[:2], "move_superimposed"), ("standing",)),
    **led_to(S.CONTINUOUS_MOTION, ("move_velocity", "move_velocity aborting"), ("standing",)),
    **led_to(S.CONTINUOUS_MOTION, ("move_velocity aborting",), FREE),
    **led_to(S.DISCRETE_MOTION, MODES[:2], ("jogging", "velocity")),
    **led_to(S.CONTINUOUS_MOTION, ENABLES, ("standing",)),
    **led_to(S.CONTINUOUS_MOTION, ("jog",), ("standing", "jog_ended")),
    **led_to(S.DISCRETE_MOTION, ("jog 0", "halt", *REDIRECTIONS), ("jogging",)),
    **led_to(S.DISCRETE_MOTION, ("halt", *REDIRECTIONS), ("velocity",)),
    **led_to(S.STOPPING, ("stop", "reset", "power off"), (*JOGGING, "velocity", *ADDING)),
    **led_to(S.STOPPING, ("emergency_stop",), ("jogging", "velocity", *ADDING)),
    **led_to(S.STANDSTILL, ("power on",), ("disabled",)),
    **led_to(S.STANDSTILL, ("reset",), ("error_stop",)),
    **led_to(S.STANDSTILL, (*STOPS, "reset"), ("held", "external")),
    **led_to(S.STANDSTILL, ("external_disable",), ("external",)),
    **led_to(S.DISABLED, ("power off",), ("standing", "held", "external")),
    **led_to(
        S.STOPPING,
        ("stop", "reset"),
        ("moving", "braking", "returning", "halting", "compensating", "external_beside"),
    ),
    **led_to(
        S.STOPPING,
        ("emergency_stop",),
        ("moving", "returning", "halting", "jog_ended", "compensating", "external_beside"),
    ),
    **led_to(
        S.STOPPING,
        ("power off",),
        ("moving", "braking", "returning", "halting", "compensating", "external_beside"),
    ),
    **led_to(S.ERROR_STOP, ("power off", "lost channel"), ("on_path",)),
    **led_to(
        S.ERROR_STOP,
        ("lost plc", "lost clock"),
        tuple(state for state in STATES if state not in ("disabled", *IN_ERROR)),
    ),
}
"""State in the first cycle after the command where it differs from the one before."""


def prepared(state: str) -> UnitBench:
    bench = axis_bench(count=100, modulo=True, modulo_high=360.0)
    STATES[state][0](bench)
    return bench


def test_the_table_names_nothing_that_does_not_exist() -> None:
    for command, state in (*REFUSALS, *WARNINGS, *AFTER):
        assert command in COMMANDS and state in STATES
    assert not REFUSALS.keys() & WARNINGS.keys() and not REFUSALS.keys() & AFTER.keys()


@lru_cache(maxsize=4)
def undisturbed(state: str, after: S) -> dict[str, list[Any]]:
    """What the axis does in this situation without a command."""
    bench = prepared(state)
    go_on(bench, after)
    return bench.columns()


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("state", STATES)
def test_every_command_in_every_state(command: str, state: str) -> None:
    """Refused commands leave the motion bit-identical; the others lead to the state of the table."""
    expected = STATES[state][1]
    name, arguments = COMMANDS[command]
    bench = prepared(state)
    if bench.blocks:
        assert bench.state == expected
    begin = bench.cycle
    record = bench.give(name, **arguments)
    after = AFTER.get((command, state), expected)
    assert record.accepted is ((command, state) not in REFUSALS), record.message
    if record.accepted:
        assert record.message == WARNINGS.get((command, state), "")
    else:
        assert f"P-ERR-{record.error_id} {record.message}" == REFUSALS[command, state]
        assert [(event.severity, event.text) for event in bench.unit.take_events()] == [(1, record.message)]
    go_on(bench, after)
    assert bench.column("state")[begin] == after
    if not record.accepted or (record.message and (command, state) not in ACTING):
        ours, theirs = bench.columns(), dict(undisturbed(state, after))
        if name == "set_override":
            assert ours.pop("override_percent")[-1] == 60.0 and theirs.pop("override_percent")[-1] == 100.0
        assert ours == theirs


@pytest.mark.parametrize("state", [*PTP_MOTION, "external"])
def test_the_reset_of_a_motion_is_a_stop(state: str) -> None:
    reset, stopped = prepared(state), prepared(state)
    reset.accepted("reset")
    stopped.accepted("stop")
    for bench in (reset, stopped):
        bench.run(3000)
    assert reset.columns() == stopped.columns()
    assert reset.column("status_bits")[-1] & StatusBit.HAS_BEEN_STOPPED


def go_on(bench: UnitBench, state: S) -> None:
    """To standstill, or on along the path."""
    if state == S.SYNCHRONIZED_MOTION:
        follow_path(bench, begin=0.3 * bench.count)
        return
    bench.run(3000)
    if bench.column("set_velocity")[-1]:  # a jog has no end
        bench.accepted("stop")
        bench.run(3000)
    assert bench.column("set_velocity")[-1] == 0.0


@pytest.mark.parametrize("state", S)
def test_state_names_are_those_of_plcopen(state: S) -> None:
    assert state_name(state) in (
        "Disabled",
        "Standstill",
        "Homing",
        "DiscreteMotion",
        "ContinuousMotion",
        "SynchronizedMotion",
        "Stopping",
        "ErrorStop",
    )


def test_units_show_their_names() -> None:
    assert repr(axis_bench().unit) == "<axis x>"
