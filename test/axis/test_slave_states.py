"""All commands of an axis on masters, slaves and pseudo masters: what is refused, and that nothing moves then."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from axis_states_support import COMMANDS as AXIS_COMMANDS
from slave_support import COMPENSATION, DYNAMICS, SlaveBench

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import state_name

# "y" is the axis that gets the command; x is its master, z its slave


def slave(bench: SlaveBench) -> None:
    bench.send_all([("z", "couple", {"master": "y", "factor": 0.5}), ("y", "couple", {"master": "x", "factor": 0.5})])


def moving_slave(bench: SlaveBench) -> None:
    slave(bench)
    bench.send("x", "move_absolute", target=4000.0, **DYNAMICS)
    bench.run(0.4)


def held_slave(bench: SlaveBench) -> None:
    moving_slave(bench)
    bench.send("x", "set_override", percent=0.0)
    bench.run(1.0)


def compensating_slave(bench: SlaveBench) -> None:
    moving_slave(bench)
    bench.do("y", "compensation_start", **{**COMPENSATION, "process_velocity": 1000.0})
    bench.run(0.1)


def slave_in_error(bench: SlaveBench) -> None:
    moving_slave(bench)
    bench.do("y", "power", enabled=False)
    bench.run(1.0)


def slave_on_its_ramp(bench: SlaveBench) -> None:
    moving_slave(bench)
    bench.do("y", "power", enabled=False)


def pseudo_master(bench: SlaveBench) -> None:
    moving_slave(bench)
    bench.do("y", "decouple")
    bench.run(0.1)


def held_pseudo_master(bench: SlaveBench) -> None:
    pseudo_master(bench)
    bench.do("y", "set_override", percent=0.0)
    bench.run(1.0)


def stopping_pseudo_master(bench: SlaveBench) -> None:
    pseudo_master(bench)
    bench.do("y", "stop")


def pseudo_master_with_target(bench: SlaveBench) -> None:
    moving_slave(bench)
    bench.do("y", "decouple", target=1500.0)
    bench.run(0.1)


def master(bench: SlaveBench) -> None:
    bench.do("z", "couple", master="y", factor=0.5)


def moving_master(bench: SlaveBench) -> None:
    master(bench)
    bench.send("y", "move_absolute", target=3000.0, **DYNAMICS)
    bench.run(0.4)


STATES: dict[str, tuple[Callable[[SlaveBench], None], S]] = {
    "slave": (slave, S.SYNCHRONIZED_MOTION),
    "moving_slave": (moving_slave, S.SYNCHRONIZED_MOTION),
    "held_slave": (held_slave, S.SYNCHRONIZED_MOTION),
    "compensating_slave": (compensating_slave, S.SYNCHRONIZED_MOTION),
    "slave_in_error": (slave_in_error, S.ERROR_STOP),
    "slave_on_its_ramp": (slave_on_its_ramp, S.ERROR_STOP),
    "pseudo_master": (pseudo_master, S.CONTINUOUS_MOTION),
    "held_pseudo_master": (held_pseudo_master, S.CONTINUOUS_MOTION),
    "stopping_pseudo_master": (stopping_pseudo_master, S.STOPPING),
    "pseudo_master_with_target": (pseudo_master_with_target, S.DISCRETE_MOTION),
    "master": (master, S.STANDSTILL),
    "moving_master": (moving_master, S.DISCRETE_MOTION),
}
COMMANDS: dict[str, tuple[str, dict[str, Any]]] = {
    **{name: entry for name, entry in AXIS_COMMANDS.items() if not name.startswith("lost") and name != "move_modulo"},
    "couple": ("couple", {"master": "x", "factor": 0.5}),
    "couple in a circle": ("couple", {"master": "z", "factor": 0.5}),
    "couple to c": ("couple", {"master": "c", "factor": 0.5}),
    "set_coupling_factor": ("set_coupling_factor", {"factor": 0.6}),
    "set_cyclic_factor": ("set_cyclic_factor", {"factor": 0.6}),
    "decouple": ("decouple", {}),
    "decouple target": ("decouple", {"target": 800.0}),
    "decouple velocity": ("decouple", {"velocity": 300.0}),
}

SLAVES = ("slave", "moving_slave", "held_slave", "compensating_slave")
IN_ERROR = ("slave_in_error", "slave_on_its_ramp")
PSEUDO = ("pseudo_master", "held_pseudo_master", "stopping_pseudo_master", "pseudo_master_with_target")
MASTERS = ("master", "moving_master")
FREE = (*PSEUDO, *MASTERS)
MOVES = ("move_absolute", "move_relative", "move_velocity")
MODES = ("move_absolute aborting", "move_absolute buffered", "move_velocity aborting")
MOVING = ("pseudo_master", "held_pseudo_master", "pseudo_master_with_target", "moving_master")
REDIRECTIONS = ("new_target", "new_velocity_and_target")
ENABLES = ("external_enable absolute", "external_enable relative")
COUPLES = ("couple", "couple in a circle", "couple to c")
DECOUPLES = ("decouple", "decouple target", "decouple velocity")

Texts = dict[tuple[str, str], str]


def refused(number: int, commands: tuple[str, ...], states: tuple[str, ...], reason: str) -> Texts:
    """The same reason for these commands in these situations; {state} stands for the name of the state."""
    return {
        (command, state): f"P-ERR-{number} axis y: {command.split()[0]} refused: "
        f"{reason.format(state=state_name(STATES[state][1]))}; nothing was changed"
        for command in commands
        for state in states
    }


REFUSALS: Texts = {
    **refused(23040, (*MOVES, *MODES, "jog", "set_position"), SLAVES, "the axis is a slave of x; decouple it"),
    **refused(
        23005,
        MODES,
        (*IN_ERROR, "stopping_pseudo_master"),
        "the axis is in {state}, it must be in Standstill, DiscreteMotion or ContinuousMotion",
    ),
    **refused(23005, ("move_superimposed",), (*IN_ERROR, "stopping_pseudo_master"), "the axis is in {state}"),
    **refused(23015, ("move_superimposed",), ("compensating_slave",), "a position compensation is active"),
    **refused(23071, ("set_position",), (*FREE, *IN_ERROR), "the axis is the master of z; decouple first"),
    **refused(
        23005,
        MOVES,
        (*IN_ERROR, *PSEUDO, "moving_master"),
        "the axis is in {state}, it must be in Standstill",
    ),
    **refused(
        23005,
        ("jog",),
        (*IN_ERROR, *PSEUDO, "moving_master"),
        "the axis is in {state}, it must be in Standstill or jogging",
    ),
    **refused(
        23040, ("stop", "halt", "emergency_stop"), SLAVES, "the axis is a slave of x; stop x or decouple the axis"
    ),
    **refused(
        23014,
        REDIRECTIONS,
        (*SLAVES, *IN_ERROR, "master"),
        "no positioning is active (the axis is in {state}); start one",
    ),
    **refused(
        23021, ("compensation_start",), ("slave", "held_slave"), "the basic motion of the slave is at a standstill"
    ),
    **refused(
        23019,
        ("compensation_start",),
        ("compensating_slave",),
        "a position compensation is active; it cannot be started again",
    ),
    **refused(
        23021, ("compensation_start",), (*IN_ERROR, "master"), "no basic motion is active (the axis is in {state})"
    ),
    **refused(
        23020, ("compensation_start",), ("stopping_pseudo_master",), "the axis is stopping or in its brake phase"
    ),
    **refused(23029, ENABLES, IN_ERROR, "the axis has error 23010; reset it"),
    **refused(23030, ENABLES, SLAVES, "x is the master of the axis"),
    **refused(23005, ENABLES, ("stopping_pseudo_master",), "the axis is in {state}"),
    **refused(
        23026,
        ENABLES[:1],
        ("pseudo_master", "held_pseudo_master", "pseudo_master_with_target", "moving_master"),
        "absolute setpoints are not permitted during a PTP motion; use relative",
    ),
    **refused(23008, ("reset",), ("slave_on_its_ramp",), "the axis still moves on its error ramp; wait for standstill"),
    **refused(
        23044,
        COUPLES,
        (*SLAVES, *IN_ERROR, *PSEUDO, "moving_master"),
        "the axis is in {state}, it must be in Standstill",
    ),
    **refused(23046, ("couple in a circle",), ("master",), "z is a slave of the axis already (z -> y)"),
    **refused(
        23047,
        ("set_coupling_factor", "set_cyclic_factor"),
        (*IN_ERROR, *FREE),
        "the axis is not coupled (it is in {state})",
    ),
    **refused(23050, ("set_cyclic_factor",), SLAVES, "the axis is not coupled cyclically"),
    **refused(23047, DECOUPLES, FREE, "the axis is not coupled (it is in {state})"),
}


def to(state: S, commands: tuple[str, ...], situations: tuple[str, ...]) -> dict[tuple[str, str], S]:
    return {(command, situation): state for command in commands for situation in situations}


AFTER: dict[tuple[str, str], S] = {
    **to(S.DISCRETE_MOTION, (*MOVES[:2], *MODES[:2], "move_superimposed"), ("master",)),
    **to(S.CONTINUOUS_MOTION, ("move_velocity", "move_velocity aborting"), ("master",)),
    **to(S.DISCRETE_MOTION, ("move_absolute aborting",), MOVING),
    **to(S.DISCRETE_MOTION, ("move_absolute buffered", "halt"), ("pseudo_master",)),
    **to(S.CONTINUOUS_MOTION, ("move_velocity aborting",), MOVING),
    **to(S.DISCRETE_MOTION, REDIRECTIONS, ("pseudo_master", "held_pseudo_master")),
    **to(S.CONTINUOUS_MOTION, (*ENABLES, "jog"), ("master",)),
    **to(S.SYNCHRONIZED_MOTION, ("couple", "couple to c"), ("master",)),
    **to(S.STANDSTILL, DECOUPLES, ("slave", "held_slave")),
    **to(S.CONTINUOUS_MOTION, ("decouple", "decouple velocity"), ("moving_slave", "compensating_slave")),
    **to(S.DISCRETE_MOTION, ("decouple target",), ("moving_slave", "compensating_slave")),
    **to(S.ERROR_STOP, ("power off",), SLAVES),
    **to(S.STOPPING, ("power off",), ("pseudo_master", "pseudo_master_with_target", "moving_master")),
    **to(S.DISABLED, ("power off",), ("master", "held_pseudo_master")),
    **to(S.STOPPING, ("stop",), ("pseudo_master", "pseudo_master_with_target", "moving_master")),
    **to(S.STOPPING, ("emergency_stop",), ("pseudo_master", "pseudo_master_with_target", "moving_master")),
    **to(S.STANDSTILL, ("stop", "halt", "emergency_stop"), ("held_pseudo_master",)),
    **to(S.DISABLED, ("reset",), ("slave_in_error",)),
    **to(S.STOPPING, ("reset",), ("pseudo_master", "pseudo_master_with_target", "moving_master")),
    **to(S.STANDSTILL, ("reset",), ("held_pseudo_master",)),
}
"""State in the first cycle after the command where it differs from the one before."""


def prepared(state: str) -> SlaveBench:
    bench = SlaveBench()
    STATES[state][0](bench)
    return bench


def test_the_table_names_nothing_that_does_not_exist() -> None:
    for command, state in (*REFUSALS, *AFTER):
        assert command in COMMANDS and state in STATES
    assert not REFUSALS.keys() & AFTER.keys()


def columns(bench: SlaveBench) -> dict[str, list[Any]]:
    lists = [name for name, value in vars_of(bench.last("x")) if isinstance(value, list)]
    names = [name for name in lists if name not in ("job_events", "answers")]
    return {f"{axis} {name}": bench.column(axis, name) for axis in "xyzc" for name in names}


def vars_of(block: Any) -> list[tuple[str, Any]]:
    return [(name, getattr(block, name)) for name in type(block).__dataclass_fields__]


@pytest.mark.parametrize("state", STATES)
def test_every_command_in_every_state(state: str) -> None:
    """Refused commands leave the motion of the whole group bit-identical; the others lead to the state of the table."""
    undisturbed = prepared(state)
    undisturbed.run(0.31)
    theirs = columns(undisturbed)
    for command, (name, arguments) in COMMANDS.items():
        bench = prepared(state)
        begin = bench.cycle
        record = bench.send("y", name, **arguments)
        expected = REFUSALS.get((command, state))
        answer = "" if record.accepted else f"P-ERR-{record.error_id} {record.message}"
        assert answer == (expected or ""), (command, state)
        assert bench.column("y", "state")[begin] == AFTER.get((command, state), STATES[state][1]), (command, state)
        bench.run(0.3)
        assert bench.failed == undisturbed.failed or command == "power off", (command, state)
        if expected:
            assert columns(bench) == theirs, (command, state)


@pytest.mark.long
@pytest.mark.parametrize("state", STATES)
def test_every_command_in_every_state_ends_in_rest(state: str) -> None:
    """After each command everything can be brought to rest and powered, reset and moved on."""
    for command, (name, arguments) in COMMANDS.items():
        bench = prepared(state)
        bench.send("y", name, **arguments)
        bench.run(0.2)
        bench.send_all([(axis, "stop", {}) for axis in "xyzc"])
        bench.settle()
        for axis in "xyzc":
            bench.send(axis, "external_disable")
            bench.send(axis, "stop")
            bench.send(axis, "decouple")
            bench.send(axis, "reset")
            bench.send(axis, "power", enabled=True)
            bench.send(axis, "set_override", percent=100.0)
        bench.run(0.1)
        for axis in "xyzc":
            assert bench.state(axis) == S.STANDSTILL, (command, axis)
            assert bench.send(axis, "move_absolute", target=-10.0).accepted, (command, axis)
        bench.settle()
        assert [bench.position(axis) for axis in "xyzc"] == [-10.0] * 4, command
