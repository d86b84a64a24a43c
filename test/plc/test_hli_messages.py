"""Control messages of the HLI: who holds an object, what counts of what comes, what goes out with a block."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import pytest
from hli_support import AXIS, SPINDLE, message

from cnc_ptp.machine.silence import patience_of
from cnc_ptp.plc.hli.external_commands import external_command
from cnc_ptp.plc.hli.messages import control_message
from cnc_ptp.plc.hli.object_control import ObjectControl
from cnc_ptp.protocol.blocks import AxisBlock, Command, CommandAnswer, JobEvent
from cnc_ptp.protocol.commands import COMMANDS
from cnc_ptp.protocol.control_units import CONTROL_UNITS
from cnc_ptp.protocol.jobs import JobStatus

TIMEOUT = 0.5
ABORTING = {"buffer_mode": "aborting"}


class Object:
    """One object with its warnings; `block` gives the commands that go out."""

    def __init__(self, kind: str = "axis", *, timeout: float = TIMEOUT) -> None:
        self.told: list[tuple[int, str]] = []
        self.kind = kind
        self.control = ObjectControl(
            "x",
            kind,
            largest_override=150.0,
            timeout=timeout,
            tell=lambda number, text: self.told.append((number, text)),
        )
        self.now = 0.0
        self._ids = 0

    def take(self, source: str = "p1", sequence: int = 0, **units: Any) -> bool:
        self.now += 0.001
        return self.control.take(message(self.kind, source, sequence, **units), self.now)

    def block(self) -> list[tuple[Any, ...]]:
        """The commands of a block, short: control unit, value, holder; or command, arguments."""
        commands = list(self.control.commands())
        for command in commands:
            self._ids += 1
            command.id = self._ids
        return [short(command) for command in commands]

    def answer(self, number: int, error_id: int = 0, job: int = 0) -> None:
        self.control.read(AxisBlock(0, 10, answers=[CommandAnswer(number, error_id, job)]))

    def report(self, active: int = 0, ended: int = 0) -> None:
        """A block in which a job has ended, or is active."""
        events = [JobEvent(ended, JobStatus.DONE, 5)] if ended else []
        self.control.read(AxisBlock(0, 10, job=active, job_events=events))


def short(command: Command) -> tuple[Any, ...]:
    given = command.arguments
    if command.command != "overlay":
        return command.command, given
    if not given["enabled"]:
        return given["control_unit"], None, None
    silent = ("silent",) if given.get("silent") else ()
    return given["control_unit"], given["value"], given["holder"], *silent


# ---------------------------------------------------------------- what goes out


def test_the_newest_value_of_a_block_counts_and_an_unchanged_one_is_no_command() -> None:
    x = Object()
    for percent in (10.0, 70.0, 30.0):
        assert x.take(override=percent)
    assert x.block() == [("override", 30.0, "p1")]
    x.take(override=30.0)
    assert x.block() == []
    x.take(feed_hold=0.0)
    assert x.block() == [("feed_hold", 0.0, "p1"), ("override", None, None)]


def test_an_edge_is_carried_out_once_for_each_rise() -> None:
    x = Object()
    rises = []
    for reset in (0.0, 1.0, 1.0, 0.0, 1.0, None, 1.0):
        x.take(feed_hold=1.0, reset=reset)
        rises.append([command for command in x.block() if command[0] == "reset"])
    assert rises == [
        [("reset", 0.0, "p1")],
        [("reset", 1.0, "p1")],
        [],
        [],
        [("reset", 1.0, "p1")],
        [("reset", None, None)],
        [("reset", 1.0, "p1")],
    ]
    assert x.control.edges["reset"].count == 3


def test_an_edge_within_a_block_is_not_lost() -> None:
    """On and off between two blocks, and the control unit given back."""
    x = Object()
    x.take(reset=1.0)
    x.take(reset=0.0)
    assert x.block() == [("reset", 1.0, "p1")]
    x.take(reset=1.0)
    x.take(reset=None)
    assert x.block() == [("reset", 1.0, "p1"), ("reset", None, None)]


def test_an_edge_that_comes_twice_within_a_block_is_carried_out_once() -> None:
    x = Object()
    for reset in (1.0, 0.0, 1.0):
        x.take(reset=reset)
    assert x.block() == [("reset", 1.0, "p1")]
    assert x.told == [(26167, "plc: HLI of x: reset comes twice within a block; it is carried out once")]


def test_answers_to_edges_and_external_commands() -> None:
    x = Object()
    x.take(reset=1.0)
    x.block()
    x.answer(1, error_id=26169)
    edge = x.control.edges["reset"]
    assert (edge.count, edge.error_id) == (1, 26169)


# ---------------------------------------------------------------- arbitration


def test_the_first_plc_holds_the_object_and_the_second_is_refused_by_name() -> None:
    x = Object()
    assert x.take("p1", override=50.0)
    for _ in range(3):
        assert not x.take("p2", override=80.0)
    assert x.block() == [("override", 50.0, "p1")]
    assert x.told == [
        (26162, "plc: HLI of x: 'p2' commands it too and is refused while 'p1' holds it; nothing was changed")
    ]
    x.take("p3")  # serves nothing, commands nothing
    x.take("p2", valid=False, override=1.0)
    assert len(x.told) == 1 and x.control.holder == "p1"


@pytest.mark.parametrize("last", [{"valid": False, "override": 50.0}, {}])
def test_a_plc_that_gives_everything_back_frees_the_object(last: dict[str, Any]) -> None:
    x = Object()
    x.take("p1", override=50.0, feed_hold=1.0)
    x.block()
    x.take("p1", **last)
    assert x.control.holder is None
    assert x.take("p2", override=80.0)
    assert x.block() == [("feed_hold", None, None), ("override", 80.0, "p2")]
    assert x.told == []


def test_a_plc_that_falls_silent_loses_the_object_and_what_it_has_commanded_holds() -> None:
    x = Object()
    x.take("p1", override=50.0, feed_hold=1.0)
    x.block()
    x.control.watch(x.now + TIMEOUT)
    assert x.control.holder == "p1"
    x.control.watch(x.now + TIMEOUT + 0.001)
    text = "no message of 'p1' for 500 ms; its values hold until others command them, and another PLC may take it"
    assert x.told == [(26165, f"plc: HLI of x: {text}")]
    left = [("feed_hold", 1.0, "p1", "silent"), ("override", 50.0, "p1", "silent")]
    assert x.control.holder is None and x.block() == left
    x.take("p2")  # a PLC that serves nothing takes nothing, and frees nothing
    assert x.control.holder is None and x.block() == []
    x.take("p2", override=60.0)
    assert x.block() == [("feed_hold", None, None), ("override", 60.0, "p2")]


@pytest.mark.parametrize("timeout", [patience_of(0), 0.0])
def test_without_a_timeout_a_plc_keeps_its_object(timeout: float) -> None:
    x = Object(timeout=timeout)
    x.take("p1", override=50.0)
    x.control.watch(1e9)
    assert x.control.holder == "p1" and x.told == []


def test_a_plc_that_comes_back_takes_its_object_again() -> None:
    x = Object()
    x.take("p1", override=50.0)
    x.block()
    x.control.watch(9.0)
    assert x.block() == [("override", 50.0, "p1", "silent")]
    assert not x.control.heard("p1", 1, 9.0)  # others may have commanded the value: the same message counts again
    x.take("p1", override=50.0)
    assert x.control.holder == "p1" and x.block() == [("override", 50.0, "p1")]
    x.control.watch(99.0)
    x.block()
    x.take("p1")
    assert x.control.holder is None and x.block() == [("override", None, None)]


def test_edges_of_a_plc_that_falls_silent_are_everybodys_again() -> None:
    x = Object()
    x.take(reset=1.0, override=50.0)
    x.control.watch(9.0)  # an edge that has not gone out is not carried out without its PLC
    assert x.block() == [("override", 50.0, "p1", "silent")]
    x.take(reset=1.0, override=50.0)
    x.block()
    x.control.watch(99.0)
    assert x.block() == [("override", 50.0, "p1", "silent"), ("reset", None, None)]
    x.take(reset=1.0)  # still on: no new edge
    assert x.block() == [("override", None, None), ("reset", 0.0, "p1")]


def test_gear_changes_of_a_spindle_whose_plc_is_silent_wait_for_somebody() -> None:
    """The machine does not say that a gear is in when it does not know: only a service, or the next PLC."""
    s = Object("spindle")
    s.take(gear_changed=0.0)
    s.block()
    s.control.watch(9.0)
    assert s.block() == [("gear_changed", None, None)] and s.control.serves_functions


def test_what_another_plc_had_on_is_no_edge_of_the_next() -> None:
    x = Object()
    x.take("p1", reset=1.0)
    x.block()
    x.take("p1", valid=False)
    x.block()
    x.take("p2", reset=1.0)
    assert x.block() == [("reset", 1.0, "p2")]


def test_an_empty_message_releases_nothing() -> None:
    x = Object()
    x.take("p1", override=50.0)
    x.block()
    x.take("", valid=False)
    x.control.watch(9.0)
    x.take("", valid=False)
    assert x.block() == [("override", 50.0, "p1", "silent")]


# ---------------------------------------------------------------- what does not count


def test_sequence_numbers_out_of_order() -> None:
    x = Object()
    x.take(sequence=7, override=50.0)
    for sequence in (7, 6, 3):
        assert not x.take(sequence=sequence, override=99.0)
    assert x.block() == [("override", 50.0, "p1")]
    assert x.told == [(26163, "plc: HLI of x: message 7 of 'p1' comes after 7; it is ignored")]
    assert x.take(sequence=8, override=60.0)
    assert not x.take(sequence=5, override=99.0)
    assert x.block() == [("override", 60.0, "p1")] and len(x.told) == 2
    assert x.take(sequence=1, override=61.0)  # a new count
    assert x.take(sequence=0, override=62.0)  # not looked at


@pytest.mark.parametrize("bad", [math.nan, math.inf, -1.0, 150.1])
def test_a_value_that_is_none_leaves_the_one_before(bad: float) -> None:
    x = Object()
    x.take(override=50.0, feed_hold=0.0)
    x.block()
    for _ in range(3):
        x.take(override=bad, feed_hold=1.0)
    assert x.block() == [("feed_hold", 1.0, "p1")]
    assert x.told == [(26164, f"plc: HLI of x: override: command {bad:g} is not within 0 ... 150; 50 holds")]
    x.take(override=60.0)
    x.take(override=bad)
    assert len(x.told) == 2


def test_a_first_value_that_is_none_takes_nothing() -> None:
    x = Object("channel")
    x.take(single_block=3.0, block_skip=0.5)
    assert x.block() == []
    assert x.told == [
        (26164, "plc: HLI of x: single_block: command 3 is not a whole number within 0 ... 2; nobody serves it"),
        (26164, "plc: HLI of x: block_skip: command 0.5 is not a whole number within 0 ... 1023; nobody serves it"),
    ]


def test_warnings_of_an_endless_row_of_clients_stay_few() -> None:
    x = Object()
    x.take("p1", override=50.0)
    for number in range(1000):
        x.take(f"q{number}", sequence=1, override=1.0)
    assert len(x.control._told) <= 16 and len(x.control._sequences) <= 17


def test_the_life_sign_holds_the_feed_of_a_plc_that_serves_it_until_its_next_message() -> None:
    x = Object("channel")
    x.take(feed_hold=0.0, override=50.0, sequence=1)
    assert x.block() == [("feed_hold", 0.0, "p1"), ("override", 50.0, "p1")]
    x.control.hold_feed()  # what others ask for, the feed hold, acts
    assert x.block() == [("feed_hold", None, None)]
    assert not x.control.heard("p1", 2, x.now)  # the same message counts again
    x.take(feed_hold=0.0, override=50.0, sequence=3)
    assert x.block() == [("feed_hold", 0.0, "p1"), ("feed_hold", {"enabled": False})]
    assert x.control.heard("p1", 4, x.now)


def test_the_life_sign_of_a_plc_that_serves_no_feed_hold_changes_nothing_of_what_it_serves() -> None:
    x = Object()
    x.take(override=50.0)
    x.block()
    x.control.hold_feed()
    x.take(override=50.0)
    assert x.block() == []


def test_the_same_message_again_is_only_heard() -> None:
    x = Object()
    x.take(sequence=1, override=50.0)
    assert x.control.heard("p1", 2, 1.0) and not x.control.heard("p1", 2, 1.0) and not x.control.heard("p2", 3, 1.0)
    x.control.watch(1.4)
    assert x.control.holder == "p1"


# ---------------------------------------------------------------- external commands


@pytest.mark.parametrize(
    ("changes", "command", "arguments"),
    [
        ({"type": 1}, "stop", {}),
        ({"type": 2}, "halt", {}),
        ({"velocity": 5.0}, "move_absolute", {"target": 12.5, "velocity": 5.0}),
        ({"type": 4, "jerk": 9.0}, "move_relative", {"distance": 12.5, "jerk": 9.0}),
        ({"type": 5}, "move_modulo", {"position": 12.5}),
        (
            {"type": 5, "velocity": 4.0, "acceleration": 3.0, "deceleration": 2.0, "jerk": 1.0},
            "move_modulo",
            {"position": 12.5, "velocity": 4.0, "acceleration": 3.0, "deceleration": 2.0, "jerk": 1.0},
        ),
        ({"type": 6, "velocity": -5.0}, "move_velocity", {"velocity": -5.0, **ABORTING}),
        (
            {"type": 6, "velocity": -5.0, "acceleration": 3.0, "deceleration": 2.0, "jerk": 1.0},
            "move_velocity",
            {"velocity": -5.0, "acceleration": 3.0, "deceleration": 2.0, "jerk": 1.0, **ABORTING},
        ),
        ({"type": 6, "acceleration": 3.0}, "halt", {}),
        ({"type": 7}, "new_target", {"target": 12.5}),
        ({"type": 8}, "home", {"position": 12.5}),
        ({"type": 8, "position": 0.0}, "home", {}),
        ({"type": 3, "buffer_mode": 2}, "move_absolute", {"target": 12.5, "buffer_mode": "buffered"}),
        ({"type": 4, "buffer_mode": 6}, "move_relative", {"distance": 12.5, "buffer_mode": "blending_high"}),
        ({"type": 6, "velocity": 5.0, "buffer_mode": 2}, "move_velocity", {"velocity": 5.0, "buffer_mode": "buffered"}),
        ({"type": 9, "velocity": 5.0}, "move_additive", {"distance": 12.5, "velocity": 5.0}),
        ({"type": 10, "velocity": 5.0}, "move_superimposed", {"distance": 12.5, "velocity_difference": 5.0}),
        ({"type": 10, "buffer_mode": 9, "jerk": 2.0}, "move_superimposed", {"distance": 12.5, "jerk": 2.0}),
        ({"type": 11}, "halt_superimposed", {}),
        (
            {"type": 12, "velocity": 5.0, "activation_position": 7.0},
            "new_velocity_and_target",
            {"target": 12.5, "velocity": 5.0, "activation_position": 7.0},
        ),
        ({"type": 13, "deceleration": 9.0}, "emergency_stop", {"deceleration": 9.0}),
        ({"type": 14}, "set_position", {"position": 12.5}),
        ({"type": 15, "factor": 0.5, "master": 2}, "couple", {"factor": 0.5, "master": "y"}),
        ({"type": 16}, "decouple", {}),
        ({"type": 17, "factor": -2.0}, "set_coupling_factor", {"factor": -2.0}),
        ({"type": 18}, "set_feedforward", {"enabled": True}),
        ({"type": 18, "weight": 80.0}, "set_feedforward", {"enabled": True, "weight_percent": 80.0}),
        ({"type": 19, "weight": 80.0}, "set_feedforward", {"enabled": False}),
        ({"type": 20}, "reset_feedforward", {}),
        ({"type": 21}, "set_friction_compensation", {"enabled": True}),
        ({"type": 22}, "set_friction_compensation", {"enabled": False}),
    ],
)
def test_external_commands_of_an_axis(changes: Mapping[str, float], command: str, arguments: Any) -> None:
    given = external_command("axis", "x", {**AXIS, **changes}, {1: "x", 2: "y"})
    assert given == Command("x", command, arguments)
    assert arguments.keys() <= COMMANDS["axis"][command].keys()


@pytest.mark.parametrize(
    ("changes", "command", "arguments"),
    [
        ({"type": 1}, "stop", {}),
        ({"type": 2}, "start", {"direction": "cw", "speed_rpm": 600.0}),
        ({"type": 3}, "start", {"direction": "ccw", "speed_rpm": 600.0}),
        ({"type": 4}, "set_speed", {"speed_rpm": 600.0}),
        ({"type": 5}, "orient", {"position_deg": 90.0, "speed_rpm": 600.0}),
        ({"type": 5, "speed": 0.0, "direction": 2}, "orient", {"position_deg": 90.0, "direction": "shortest"}),
        ({"type": 5, "speed": 0.0, "direction": -1}, "orient", {"position_deg": 90.0, "direction": "ccw"}),
        ({"type": 6}, "home", {}),
        ({"type": 7}, "select_gear", {"stage": 2}),
    ],
)
def test_external_commands_of_a_spindle(changes: Mapping[str, float], command: str, arguments: Any) -> None:
    expected = Command("s", command, {"source": "plc", **arguments})
    assert external_command("spindle", "s", {**SPINDLE, **changes}, {}) == expected


@pytest.mark.parametrize(
    ("changes", "command", "arguments"),
    [
        ({"type": 8}, "suppress_override", {"enabled": True}),
        ({"type": 9}, "suppress_override", {"enabled": False}),
        ({"type": 10}, "set_limits", {"max_speed_rpm": 600.0}),
        (
            {"type": 10, "speed": 0.0, "min_speed": 5.0, "acceleration": 9.0},
            "set_limits",
            {"min_speed_rpm": 5.0, "max_acceleration": 9.0},
        ),
        ({"type": 11}, "reset_limits", {}),
        ({"type": 12, "master": 7}, "couple", {"master": "s2"}),
        (
            {"type": 12, "master": 7, "factor_num": -1.0, "factor_den": 2.0},
            "couple",
            {"master": "s2", "factor_num": -1.0, "factor_den": 2.0},
        ),
        ({"type": 13}, "decouple", {}),
        ({"type": 14}, "set_feedforward", {"enabled": True}),
        ({"type": 15}, "set_feedforward", {"enabled": False}),
        ({"type": 16}, "reset_feedforward", {}),
    ],
)
def test_external_commands_of_a_spindle_that_count_at_once(
    changes: Mapping[str, float], command: str, arguments: Any
) -> None:
    given = external_command("spindle", "s", {**SPINDLE, **changes}, {7: "s2"})
    assert given == Command("s", command, arguments)
    assert arguments.keys() <= COMMANDS["spindle"][command].keys()


def test_an_external_command_is_taken_by_the_semaphore() -> None:
    x = Object()
    assert not x.take(external={**AXIS, "semaphore": 0})
    x.take(external=AXIS)
    assert x.control.command_semaphore
    x.take(external={**AXIS, "position": 1.0})  # no new edge
    assert x.block() == [("move_absolute", {"target": 12.5})]
    assert x.control.command_semaphore  # not answered
    x.answer(1, job=4)
    external = x.control.external
    assert not x.control.command_semaphore and (external.count, external.error_id, external.job) == (1, 0, 4)
    x.take(external={**AXIS, "semaphore": 0})
    x.take(external={**AXIS, "type": 1})
    assert x.block() == [("stop", {})] and x.control.holder == "p1"


def test_an_external_command_before_the_one_before_was_taken() -> None:
    x = Object()
    for semaphore in (1, 0, 1, 0):
        x.take(feed_hold=0.0, external={**AXIS, "semaphore": semaphore, "position": float(semaphore)})
    assert x.block()[-1:] == [("move_absolute", {"target": 1.0})]
    text = "plc: HLI of x: an external command comes before the one before was taken; nothing was changed"
    assert x.told == [(26167, text)]


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"type": 0}, "type = 0 is not within 1 ... 22"),
        ({"type": 23}, "type = 23 is not within 1 ... 22"),
        ({"buffer_mode": 7}, "buffer_mode = 7 is not within 0 ... 6"),
        ({"type": 15, "factor": 1.0, "master": 9}, "master = 9 is the logical number (P-AXIS-00016) of no axis"),
        ({"position": math.nan}, "position = nan is not finite"),
    ],
)
def test_an_external_command_that_is_none(changes: Mapping[str, float], reason: str) -> None:
    x = Object()
    x.take(external={**AXIS, **changes})
    assert x.block() == [] and not x.control.command_semaphore
    assert x.told == [(26164, f"plc: HLI of x: external command: {reason}; nothing was changed")]
    assert (x.control.external.count, x.control.external.error_id) == (1, 26164)


# ---------------------------------------------------------------- motions of external commands


def moving(semaphore: int = 1) -> Object:
    """An axis whose job 4 the PLC p1 has begun."""
    x = Object()
    x.take(external=AXIS)
    x.block()
    x.answer(1, job=4)
    x.report(active=4)
    x.take(external={**AXIS, "semaphore": semaphore})
    return x


@pytest.mark.parametrize("semaphore", [0, 1])
def test_a_motion_is_halted_when_its_plc_falls_silent(semaphore: int) -> None:
    x = moving(semaphore)
    x.control.watch(x.now + TIMEOUT)
    assert x.block() == [] and x.control.holder == "p1"
    x.control.watch(x.now + TIMEOUT + 0.001)
    text = "no message of 'p1' for 500 ms; its motion is halted"
    assert x.told == [
        (26165, f"plc: HLI of x: {text}; its values hold until others command them, and another PLC may take it")
    ]
    assert x.control.holder is None
    x.report(active=4)
    x.report(active=4)
    assert x.block() == [("halt", {})]  # once
    x.report(active=5)
    assert x.block() == []


def test_a_motion_is_halted_when_its_plc_leaves() -> None:
    x = moving()
    x.take(valid=False)
    x.report(active=4)
    assert x.block() == [("halt", {})] and x.told == []


def test_a_motion_that_waits_for_its_turn_is_halted_when_it_begins() -> None:
    """A spindle takes commands in order of arrival; the answer may come after the silence too."""
    s = Object("spindle")
    s.take(external=SPINDLE)
    s.block()
    s.control.watch(9.0)
    assert "; its motion is stopped; " in s.told[0][1]
    s.answer(1, job=7)
    s.report(active=6)
    assert s.block() == []
    s.report(active=7)
    assert s.block() == [("stop", {})]


def test_a_motion_of_another_is_not_halted() -> None:
    x = moving()
    x.report(ended=4, active=5)
    x.control.watch(9.0)
    x.report(active=5)
    assert x.block() == [] and "halted" not in x.told[0][1]


def test_an_external_command_that_has_not_gone_out_does_not_begin_without_its_plc() -> None:
    x = Object()
    x.take(external=AXIS)
    x.control.watch(9.0)
    assert x.block() == [] and not x.control.command_semaphore
    x.take(external=AXIS)  # the same again is no new command
    assert x.block() == []


def test_a_plc_holds_the_object_until_its_motion_has_ended() -> None:
    x = moving(semaphore=0)
    assert x.control.holder == "p1" and not x.take("p2", external=AXIS)
    x.take("p2", external={**AXIS, "semaphore": 0})
    x.report(ended=4)
    assert x.control.holder is None
    assert [number for number, _ in x.told] == [26162]
    assert x.take("p2", external=AXIS) and x.block() == [("move_absolute", {"target": 12.5})]


def test_anybody_may_stop_what_another_plc_holds() -> None:
    x = moving(semaphore=0)
    for _ in range(3):
        assert not x.take("p2", override=5.0, external={**AXIS, "type": 1})
        assert x.control.holder == "p1"
    assert x.block() == [("stop", {})]
    text = "'p2' stops it while 'p1' holds it; the stop is carried out, nothing else was changed"
    assert x.told == [(26162, f"plc: HLI of x: {text}")]
    x.take("p2", external={**AXIS, "semaphore": 0})
    x.take("p2", external={**AXIS, "type": 1})
    assert x.block() == [("stop", {})] and len(x.told) == 1
    for number in range(40):
        x.take(f"q{number}", external={**AXIS, "type": 1})
    assert len(x.control._stopping) <= 16


@pytest.mark.parametrize(("type", "command"), [(1, "stop"), (2, "halt"), (13, "emergency_stop")])
def test_each_way_to_stop_counts(type: int, command: str) -> None:
    x = moving(semaphore=0)
    x.take("p2", feed_hold=1.0, external={**AXIS, "type": type})
    assert x.block() == [(command, {})]
    assert [number for number, _ in x.told] == [26162]


@pytest.mark.parametrize("kind", ["axis", "spindle", "channel"])
def test_anybody_may_give_an_emergency_stop(kind: str) -> None:
    x = Object(kind)
    x.take("p1", override=50.0)
    x.block()
    for _ in range(3):
        assert not x.take("p2", emergency_stop=1.0, override=5.0)
    assert x.block() == [("set_emergency_stop", {"enabled": True})]
    text = "'p2' stops it while 'p1' holds it; the stop is carried out, nothing else was changed"
    assert x.told == [(26162, f"plc: HLI of x: {text}")]
    x.take("p2", emergency_stop=0.0)
    assert x.block() == []
    x.take("p2", emergency_stop=1.0)
    assert x.block() == [("set_emergency_stop", {"enabled": True})] and x.control.holder == "p1"


# ---------------------------------------------------------------- acknowledgements, units


def test_each_acknowledgement_counts_when_it_appears() -> None:
    x = Object("channel")
    taken = []
    for done in ((), (3,), (3,), (4, 3), (), (3,)):
        x.take(functions=True, done=done)
        taken.append(x.control.take_acknowledgements())
    assert taken == [[], [3], [], [4], [], [3]]
    assert x.control.serves_functions
    x.take(valid=False)
    assert not x.control.serves_functions


def test_a_spindle_whose_gear_changes_are_served() -> None:
    s = Object("spindle")
    s.take(gear_changed=0.0)
    assert s.control.serves_functions
    s.take(feed_hold=0.0)
    assert not s.control.serves_functions


def fields(kind: str, **given: Any) -> dict[str, Any]:
    named: dict[str, Any] = {"sequence": 0, "valid": True, "units": 0}
    for unit in CONTROL_UNITS[kind]:
        named |= {f"{unit.name}.enable_w": False, f"{unit.name}.command_w": 0.0}
    return named | given


def test_numbers_of_the_hli() -> None:
    """0.1 % of overrides; 0.1 µm, µm/s; 0.0001 °, 0.001 °/s: 36,000,000 are 6000 rpm."""
    external = {
        f"external.{name}": value for name, value in {**AXIS, "position": 125_000.0, "velocity": 2500.0}.items()
    }
    axis = control_message("axis", "p", fields("axis", **{"units": 1, "override.command_w": 505.0}, **external))
    assert axis.units["override"] == (False, 50.5)
    assert (axis.external["position"], axis.external["velocity"]) == (12.5, 2.5) and axis.semaphore
    external = {f"external.{name}": value for name, value in {**SPINDLE, "position": 900_000, "speed": 36e6}.items()}
    spindle = control_message("spindle", "p", fields("spindle", units=1, **external))
    assert (spindle.external["position"], spindle.external["speed"]) == (90.0, 6000.0)
    done = {"acknowledge.enable_w": True, "acknowledge.done_w": (0, 5, 0, 7)}
    channel = control_message("channel", "p", fields("channel", **{"override.command_w": 50.5}, **done))
    assert channel.units["override"] == (False, 50.5) and channel.acknowledged == (5, 7) and channel.serves_functions
