"""All commands of an axis in all its states, arguments, limits, power, reset and watchdog, with the exact texts."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest
from machine_support import CYCLE_TIME, UnitBench, assert_axis_smooth, axis_bench

from cnc_ptp.axis.states import state_name
from cnc_ptp.machine.blocks import AxisStateCode as S
from cnc_ptp.machine.blocks import ChannelBlock, StatusBit

DYNAMICS = {"velocity": 2000.0, "acceleration": 5000.0, "deceleration": 5000.0, "jerk": 50_000.0}


def path_block(first_cycle: int, positions: list[float], velocity: float = 0.0, *, axis: str = "x") -> ChannelBlock:
    """A channel block that moves `axis` (second of two) over `positions` at `velocity`."""
    count = len(positions)
    return ChannelBlock(
        first_cycle,
        count,
        path_active=True,
        axes=["other", axis],
        set_position=[0.0] * count + positions,
        set_velocity=[0.0] * count + [velocity] * count,
        set_acceleration=[0.0] * 2 * count,
        set_jerk=[0.0] * 2 * count,
    )


def follow_path(bench: UnitBench, blocks: int = 3, velocity: float = 100.0, begin: float = 0.0) -> None:
    """Lets the axis follow a path at constant velocity (which steps at its begin; the axis does not judge that)."""
    for _ in range(blocks):
        positions = [begin + velocity * CYCLE_TIME * n for n in range(bench.count)]
        bench.run(bench.count, {"channel": path_block(bench.cycle, positions, velocity)})
        begin = positions[-1] + velocity * CYCLE_TIME


def disabled(bench: UnitBench) -> None:
    bench.accepted("power", on=False)


def standing(bench: UnitBench) -> None:
    pass


def moving(bench: UnitBench) -> None:
    bench.accepted("move_absolute", target=3000.0, **DYNAMICS)
    bench.run(400)


def on_path(bench: UnitBench) -> None:
    follow_path(bench)


def stopping(bench: UnitBench) -> None:
    moving(bench)
    bench.accepted("stop")
    bench.run(50)


def powered_off_in_motion(bench: UnitBench) -> None:
    moving(bench)
    bench.accepted("power", on=False)
    bench.run(50)


def error_ramp(bench: UnitBench) -> None:
    moving(bench)
    bench.accepted("upstream_lost", source="plc")
    bench.run(50)


def error_stop(bench: UnitBench) -> None:
    error_ramp(bench)
    bench.run(1000)


STATES: dict[str, tuple[Callable[[UnitBench], None], S]] = {
    "disabled": (disabled, S.DISABLED),
    "standing": (standing, S.STANDSTILL),
    "moving": (moving, S.DISCRETE_MOTION),
    "on_path": (on_path, S.SYNCHRONIZED_MOTION),
    "stopping": (stopping, S.STOPPING),
    "powered_off_in_motion": (powered_off_in_motion, S.STOPPING),
    "error_ramp": (error_ramp, S.ERROR_STOP),
    "error_stop": (error_stop, S.ERROR_STOP),
}


def not_ready(command: str, state: str) -> str:
    return (
        f"P-ERR-23005 axis x: {command} refused: the axis is in {state}, it must be in Standstill; nothing was changed"
    )


MOVES_REFUSED = {
    "disabled": "Disabled",
    "moving": "DiscreteMotion",
    "on_path": "SynchronizedMotion",
    "stopping": "Stopping",
    "powered_off_in_motion": "Stopping",
    "error_ramp": "ErrorStop",
    "error_stop": "ErrorStop",
}
REFUSALS: dict[tuple[str, str], str] = {
    **{("move_absolute", name): not_ready("move_absolute", state) for name, state in MOVES_REFUSED.items()},
    **{("move_relative", name): not_ready("move_relative", state) for name, state in MOVES_REFUSED.items()},
    ("stop", "on_path"): (
        "P-ERR-23005 axis x: stop refused: the channel path moves the axis; use feed_hold or reset of the channel; "
        "nothing was changed"
    ),
    ("reset", "error_ramp"): (
        "P-ERR-23008 axis x: reset refused: the axis still moves on its error ramp; wait for standstill; "
        "nothing was changed"
    ),
}
WARNINGS: dict[tuple[str, str], str] = {
    ("stop", "disabled"): "axis x: stop without effect in Disabled",
    ("stop", "standing"): "axis x: stop without effect in Standstill",
    ("stop", "stopping"): "axis x: stop without effect in Stopping",
    ("stop", "powered_off_in_motion"): "axis x: stop without effect in Stopping",
    ("stop", "error_ramp"): "axis x: stop without effect in ErrorStop",
    ("stop", "error_stop"): "axis x: stop without effect in ErrorStop",
    **{
        ("power on", name): "axis x: power is on already"
        for name in ("standing", "moving", "on_path", "stopping", "error_ramp", "error_stop")
    },
    ("power off", "disabled"): "axis x: power is off already",
    ("power off", "powered_off_in_motion"): "axis x: power is off already",
}
AFTER: dict[tuple[str, str], S] = {
    ("move_absolute", "standing"): S.DISCRETE_MOTION,
    ("move_relative", "standing"): S.DISCRETE_MOTION,
    ("stop", "moving"): S.STOPPING,
    ("power on", "disabled"): S.STANDSTILL,
    ("power off", "standing"): S.DISABLED,
    ("power off", "moving"): S.STOPPING,
    ("power off", "on_path"): S.ERROR_STOP,
    ("reset", "error_stop"): S.STANDSTILL,
    ("lost plc", "standing"): S.ERROR_STOP,
    ("lost plc", "moving"): S.ERROR_STOP,
    ("lost plc", "on_path"): S.ERROR_STOP,
    ("lost plc", "stopping"): S.ERROR_STOP,
    ("lost plc", "powered_off_in_motion"): S.ERROR_STOP,
    ("lost clock", "standing"): S.ERROR_STOP,
    ("lost clock", "moving"): S.ERROR_STOP,
    ("lost clock", "on_path"): S.ERROR_STOP,
    ("lost clock", "stopping"): S.ERROR_STOP,
    ("lost clock", "powered_off_in_motion"): S.ERROR_STOP,
    ("lost channel", "on_path"): S.ERROR_STOP,
}
"""State in the first cycle after the command where it differs from the one before."""

COMMANDS: dict[str, tuple[str, dict[str, Any]]] = {
    "power on": ("power", {"on": True}),
    "power off": ("power", {"on": False}),
    "reset": ("reset", {}),
    "move_absolute": ("move_absolute", {"target": 100.0, **DYNAMICS}),
    "move_relative": ("move_relative", {"distance": 100.0, **DYNAMICS}),
    "set_override": ("set_override", {"percent": 60.0}),
    "stop": ("stop", {}),
    "lost plc": ("upstream_lost", {"source": "plc"}),
    "lost clock": ("upstream_lost", {"source": "clock"}),
    "lost channel": ("upstream_lost", {"source": "channel"}),
}


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_in_every_state(command: str, state: str) -> None:
    """Refused commands leave the motion bit-identical; the others lead to the state of the table."""
    prepare, expected = STATES[state]
    name, arguments = COMMANDS[command]
    bench, undisturbed = axis_bench(), axis_bench()
    for each in (bench, undisturbed):
        prepare(each)
    if bench.blocks:
        assert bench.state == expected
    begin = bench.cycle
    record = bench.give(name, **arguments)
    after = AFTER.get((command, state), expected)
    assert record.accepted is ((command, state) not in REFUSALS)
    if record.accepted:
        assert record.message == WARNINGS.get((command, state), "")
    else:
        assert f"P-ERR-{record.error_id} {record.message}" == REFUSALS[command, state]
        assert [(event.severity, event.text) for event in bench.unit.take_events()] == [(1, record.message)]
    for each in (bench, undisturbed):
        if after == S.SYNCHRONIZED_MOTION:
            follow_path(each, begin=3.0)
        else:
            each.run(3000)
            assert each.column("set_velocity")[-1] == 0.0
    assert bench.column("state")[begin] == after
    if not record.accepted or record.message:
        assert bench.columns() == undisturbed.columns()


@pytest.mark.parametrize("source", ["plc", "clock", "channel"])
def test_watchdog_texts(source: str) -> None:
    bench = axis_bench()
    on_path(bench)
    bench.accepted("upstream_lost", source=source)
    bench.run(200)
    assert bench.event_texts() == [
        f"P-ERR-26101 axis x: no block of '{source}' came within the watchdog time; the axis stops on its own ramp "
        "(ErrorStop)"
    ]
    assert_axis_smooth(bench.blocks[2:], acceleration=5000.0, jerk=50_000.0)
    assert set(bench.column("error_id")[30:]) == {26101}


def test_a_path_continues_in_one_cycle_at_its_velocity_before_the_ramp_begins() -> None:
    """The last setpoint of the path is extrapolated by one cycle: c of the fault is on the old motion."""
    bench = axis_bench()
    on_path(bench)  # 100 mm/s, last setpoint 2.9 mm
    bench.accepted("upstream_lost", source="channel")
    bench.run(200)
    assert bench.column("set_position")[29:31] == pytest.approx([2.9, 3.0], abs=1e-12)
    assert bench.column("set_velocity")[30] == pytest.approx(100.0)
    stop_time = 2.0 * math.sqrt(100.0 / 50_000.0)  # A- is not reached
    assert bench.column("set_position")[-1] == pytest.approx(3.0 + 0.5 * 100.0 * stop_time, abs=1e-9)


# ---------------------------------------------------------------- arguments


BAD_NUMBERS: list[tuple[Any, str]] = [
    (math.nan, "22001 axis x: {command} refused: {name} = nan is not finite; nothing was changed"),
    (math.inf, "22001 axis x: {command} refused: {name} = inf is not finite; nothing was changed"),
    (-math.inf, "22001 axis x: {command} refused: {name} = -inf is not finite; nothing was changed"),
    (10**400, "22001 axis x: {command} refused: {name} = an integer that long is not finite; nothing was changed"),
    ("5", "22001 axis x: {command} refused: {name} = '5' is not a number; nothing was changed"),
    (True, "22001 axis x: {command} refused: {name} = True is not a number; nothing was changed"),
    (None, "22001 axis x: {command} refused: {name} = None is not a number; nothing was changed"),
    ([1.0], "22001 axis x: {command} refused: {name} = [1.0] is not a number; nothing was changed"),
]
NUMBERS = [
    ("move_absolute", "target", {}),
    ("move_relative", "distance", {}),
    ("set_override", "percent", {}),
    *[("move_absolute", name, {"target": 1.0}) for name in DYNAMICS],
]


@pytest.mark.parametrize(("value", "text"), BAD_NUMBERS)
@pytest.mark.parametrize(("command", "name", "others"), NUMBERS)
def test_bad_numbers(command: str, name: str, others: dict[str, float], value: Any, text: str) -> None:
    bench = axis_bench()
    assert bench.refused(command, **others, **{name: value}) == "P-ERR-" + text.format(command=command, name=name)
    bench.run(10)
    assert bench.state == S.STANDSTILL and bench.column("status_bits")[-1] == 0


@pytest.mark.parametrize("name", DYNAMICS)
@pytest.mark.parametrize("value", [0.0, -1.0, 0, -0.0])
def test_dynamics_must_be_above_0(name: str, value: float) -> None:
    text = f"{name} = {value} must be greater than 0"
    assert axis_bench().refused("move_absolute", target=1.0, **{name: value}) == (
        f"P-ERR-23003 axis x: move_absolute refused: {text}; nothing was changed"
    )


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
@pytest.mark.parametrize("override", [0.0, 50.0])
@pytest.mark.parametrize("name", ["acceleration", "deceleration", "velocity"])
def test_dynamics_that_no_table_can_be_made_for_leave_no_job(name: str, kind: int, override: float) -> None:
    """1e-300 passes the check above and is refused by the planner: nothing of the job may stay."""
    bench = axis_bench(override_type=kind)
    bench.accepted("set_override", percent=override)
    record = bench.give("move_absolute", target=1.0, **{name: 1e-300})
    if record.accepted:
        assert name == "velocity" or override == 0.0
        return
    assert record.error_id == 23001
    bench.run(10)
    assert bench.state == S.STANDSTILL and bench.column("status_bits")[-1] == 0
    assert set(bench.column("set_position")) == {0.0}


@pytest.mark.parametrize(
    ("command", "arguments", "text"),
    [
        ("move_absolute", {}, "22001 axis x: move_absolute refused: argument 'target' is missing; nothing was changed"),
        (
            "move_absolute",
            {"target": 1.0, "speed": 5.0},
            "22001 axis x: move_absolute refused: unknown argument 'speed'; nothing was changed. Known: target, "
            "velocity, "
            "acceleration, deceleration, jerk",
        ),
        ("stop", {"now": True}, "22001 axis x: stop refused: unknown argument 'now'; nothing was changed. Known: none"),
        ("power", {"on": 1}, "22001 axis x: power refused: on = 1 is not a switch; nothing was changed"),
        ("power", {"on": "on"}, "22001 axis x: power refused: on = 'on' is not a switch; nothing was changed"),
        (
            "jump",
            {},
            "22002 axis x: unknown command 'jump'; nothing was changed. Known: compensation_start, compensation_stop, emergency_stop, external_disable, external_enable, external_setpoints, halt, move_absolute, move_modulo, move_relative, new_target, new_velocity_and_target, power, reset, set_override, set_override_type, stop",
        ),
    ],
)
def test_what_an_axis_does_not_understand(command: str, arguments: dict[str, Any], text: str) -> None:
    assert axis_bench().refused(command, **arguments) == f"P-ERR-{text}"


# ---------------------------------------------------------------- velocity and soft limits


def test_velocity_above_the_maximum_and_above_the_reference_velocity() -> None:
    bench = axis_bench(max_velocity=2000.0, reference_velocity=1500.0)
    assert bench.refused("move_absolute", target=1.0, velocity=2000.5) == (
        "P-ERR-23004 axis x: move_absolute refused: velocity 2000.5 mm/s is above the maximum 2000.0 mm/s "
        "(P-AXIS-00212); nothing was changed"
    )
    assert bench.refused("move_relative", distance=1.0, velocity=1500.5) == (
        "P-ERR-23011 axis x: move_relative refused: velocity 1500.5 mm/s is above the reference velocity 1500.0 mm/s "
        "(P-MACH-00008); nothing was changed"
    )
    assert bench.accepted("move_absolute", target=1.0, velocity=1500) == ""


def test_rotary_axes_speak_of_degrees() -> None:
    bench = axis_bench(rotary=True, max_velocity=360.0, reference_velocity=360.0)
    assert "velocity 361.0 deg/s is above the maximum 360.0 deg/s" in bench.refused(
        "move_absolute", target=1.0, velocity=361.0
    )


@pytest.mark.parametrize(
    ("command", "argument", "text"),
    [
        (
            "move_absolute",
            {"target": 100.001},
            "120002 {c}: target 100.001 mm lies beyond the positive soft limit 100.0 mm",
        ),
        (
            "move_relative",
            {"distance": 60.5},
            "120002 {c}: target 100.5 mm lies beyond the positive soft limit 100.0 mm",
        ),
        (
            "move_absolute",
            {"target": -50.1},
            "120003 {c}: target -50.1 mm lies beyond the negative soft limit -50.0 mm",
        ),
        (
            "move_relative",
            {"distance": -91},
            "120003 {c}: target -51.0 mm lies beyond the negative soft limit -50.0 mm",
        ),
    ],
)
def test_soft_limits(command: str, argument: dict[str, float], text: str) -> None:
    bench = axis_bench(soft_limit_negative=-50.0, soft_limit_positive=100.0, start_position=40.0)
    number = "P-AXIS-00178" if "positive" in text else "P-AXIS-00177"
    expected = text.format(c=f"axis x: {command} refused")
    assert bench.refused(command, **argument) == f"P-ERR-{expected} ({number}); nothing was changed"
    bench.run(10)
    assert bench.state == S.STANDSTILL


@pytest.mark.parametrize("target", [100.0, -50.0])
def test_the_soft_limits_themselves_can_be_reached(target: float) -> None:
    bench = axis_bench(soft_limit_negative=-50.0, soft_limit_positive=100.0)
    bench.accepted("move_absolute", target=target)
    bench.run(1000)
    assert bench.column("set_position")[-1] == target


@pytest.mark.parametrize("outside", [150.0, -80.0])
def test_from_outside_the_soft_limits_only_inwards(outside: float) -> None:
    bench = axis_bench(soft_limit_negative=-50.0, soft_limit_positive=100.0, start_position=outside)
    bench.refused("move_relative", distance=10.0 if outside > 0.0 else -10.0)
    bench.refused("move_absolute", target=outside * 0.9)
    bench.accepted("move_absolute", target=20.0)
    bench.run(1000)
    assert bench.column("set_position")[-1] == 20.0


# ---------------------------------------------------------------- power, reset


def test_power_off_while_moving_ramps_down_and_then_disables() -> None:
    bench = axis_bench(kv=50.0, drive_time_constant=0.003)
    moving(bench)
    bench.accepted("power", on=False)
    bench.run(1000)
    states, velocity = bench.column("state"), bench.column("set_velocity")
    end = states.index(S.DISABLED)
    assert set(states[400:end]) == {S.STOPPING} and velocity[end] == 0.0 and velocity[end - 1] > 0.0
    assert set(bench.column("command_velocity")[end:]) == {0.0}
    assert abs(bench.column("command_velocity")[end - 1]) > 0.0
    assert bench.column("actual_velocity")[-1] == pytest.approx(0.0, abs=1e-9)
    assert bench.events == []
    assert_axis_smooth(bench, acceleration=5000.0, jerk=50_000.0)


def test_the_enable_moves_nothing() -> None:
    """What the drive still lacked when the loop was opened is no step of the command velocity later on."""
    bench = axis_bench(kv=50.0, drive_time_constant=0.003)
    moving(bench)
    bench.accepted("power", on=False)
    bench.run(1500)
    rest, actual = bench.column("following_error")[-1], bench.column("actual_position")[-1]
    assert abs(rest) > 1e-6
    bench.accepted("power", on=True)
    bench.run(100)
    assert set(bench.column("command_velocity")[-100:]) == {0.0}
    assert bench.column("set_position")[-1] == bench.column("actual_position")[-1] == pytest.approx(actual, abs=1e-9)
    assert bench.state == S.STANDSTILL
    bench.accepted("move_absolute", target=0.0, **DYNAMICS)
    bench.run(3000)
    assert bench.column("actual_position")[-1] == pytest.approx(0.0, abs=1e-6)


def test_power_on_again_on_the_ramp_ends_in_standstill() -> None:
    bench = axis_bench()
    powered_off_in_motion(bench)
    bench.accepted("power", on=True)
    bench.run(1000)
    assert bench.state == S.STANDSTILL and S.DISABLED not in bench.column("state")
    assert_axis_smooth(bench, acceleration=5000.0, jerk=50_000.0)


def test_power_off_on_the_path_is_a_fault_and_the_loop_opens_at_standstill() -> None:
    bench = axis_bench(kv=50.0, drive_time_constant=0.003)
    follow_path(bench, blocks=20)
    bench.accepted("power", on=False)
    bench.run(1000)
    assert bench.event_texts() == [
        "P-ERR-23010 axis x: the enable was removed during path motion; the axis stops on its own ramp (ErrorStop)"
    ]
    velocity, command = bench.column("set_velocity"), bench.column("command_velocity")
    end = next(k for k in range(200, 1200) if velocity[k] == 0.0)
    assert command[end - 1] != 0.0 and set(command[end + 1 :]) == {0.0}
    bench.accepted("reset")
    bench.run(10)
    assert bench.state == S.DISABLED
    bench.accepted("power", on=True)
    bench.run(10)
    assert bench.state == S.STANDSTILL and set(bench.column("command_velocity")[-10:]) == {0.0}


def test_power_on_in_error_stop_closes_the_loop_and_keeps_the_error() -> None:
    bench = axis_bench()
    on_path(bench)
    bench.accepted("power", on=False)
    bench.run(500)
    bench.accepted("power", on=True)
    bench.run(10)
    assert bench.state == S.ERROR_STOP and bench.column("error_id")[-1] == 23010
    bench.accepted("reset")
    bench.run(10)
    assert bench.state == S.STANDSTILL


def test_an_axis_without_power_at_the_start() -> None:
    bench = axis_bench(powered_at_start=False)
    bench.run(10)
    assert set(bench.column("state")) == {S.DISABLED}
    bench.accepted("power", on=True)
    bench.run(10)
    assert set(bench.column("state")[10:]) == {S.STANDSTILL}


def test_reset_clears_error_and_bit() -> None:
    bench = axis_bench()
    error_stop(bench)
    assert bench.column("status_bits")[-1] == StatusBit.ERROR
    bench.accepted("reset")
    bench.run(10)
    assert (bench.state, bench.column("error_id")[-1], bench.column("status_bits")[-1]) == (S.STANDSTILL, 0, 0)
    assert bench.accepted("move_absolute", target=0.0) == ""


# ---------------------------------------------------------------- faults


def test_a_fault_takes_the_stronger_of_own_ramp_and_ramp_of_the_start() -> None:
    """Weak start (500), strong axis (5000): stops within 2000/5000 + 0.1 s; and the other way round."""
    for own, given in ((5000.0, 500.0), (500.0, 5000.0)):
        bench = axis_bench(deceleration=own)
        bench.accepted("move_absolute", target=50_000.0, **{**DYNAMICS, "deceleration": given})
        bench.run(1000)
        bench.accepted("upstream_lost", source="clock")
        bench.run(4500)
        velocity = bench.column("set_velocity")
        stand = next(k for k in range(1000, 5500) if velocity[k] == 0.0)
        assert stand == pytest.approx(1500, abs=1)
        assert_axis_smooth(bench, acceleration=5000.0, jerk=50_000.0)


def test_a_fault_on_a_stop_ramp_does_not_weaken_it() -> None:
    bench = axis_bench(deceleration=500.0)
    bench.accepted("move_absolute", target=50_000.0, **DYNAMICS)
    bench.run(1000)
    bench.accepted("stop")
    bench.run(200)
    bench.accepted("upstream_lost", source="plc")
    bench.run(500)
    assert bench.column("set_velocity").index(0.0, 1000) == pytest.approx(1500, abs=1)


@pytest.mark.parametrize(
    ("prepare", "state"),
    [(moving, "DiscreteMotion"), (stopping, "Stopping"), (disabled, "Disabled")],
)
def test_a_path_that_the_axis_cannot_follow(prepare: Callable[[UnitBench], None], state: str) -> None:
    bench = axis_bench()
    prepare(bench)
    begin = bench.column("set_position")[-1] if bench.blocks else 0.0
    follow_path(bench, begin=begin)
    assert bench.event_texts() == [
        f"P-ERR-23009 axis x: the channel moves the path while the axis is in {state}; the axis stops on its own ramp "
        "(ErrorStop)"
    ]
    bench.run(1000)
    assert bench.state == S.ERROR_STOP and bench.column("set_velocity")[-1] == 0.0
    assert_axis_smooth(bench, acceleration=5000.0, jerk=50_000.0)
    if prepare is disabled:
        assert set(bench.column("command_velocity")) == {0.0}


def test_a_path_that_begins_elsewhere_is_a_fault() -> None:
    """Also after a reset while the channel still ramps down: the axis must not jump onto the path."""
    bench = axis_bench(start_position=1.0)
    follow_path(bench, begin=1.5)
    assert bench.event_texts() == [
        "P-ERR-23009 axis x: the path of the channel begins at 1.5 mm, the axis stands at 1.0 mm; the axis "
        "stops on its "
        "own ramp (ErrorStop)"
    ]
    assert set(bench.column("set_position")) == {1.0}


def test_a_channel_that_lets_the_axis_go_while_it_moves() -> None:
    bench = axis_bench()
    on_path(bench)
    bench.run(500)
    assert bench.event_texts() == [
        "P-ERR-23009 axis x: the channel let the axis go while it moved; the axis stops on its own ramp (ErrorStop)"
    ]
    assert_axis_smooth(bench.blocks[2:], acceleration=5000.0, jerk=50_000.0)


def test_only_the_block_of_a_channel_that_has_the_axis_counts() -> None:
    bench = axis_bench()
    idle = path_block(0, [5.0] * 10)
    idle.path_active = False
    bench.run(10, {"channel": idle, "other": path_block(0, [9.0] * 10, axis="y")})
    assert set(bench.column("set_position")) == {0.0} and bench.state == S.STANDSTILL


def test_following_error_on_the_path_stops_from_the_setpoint_of_that_cycle() -> None:
    bench = axis_bench(kv=50.0, following_error_monitoring=True, following_error_limit=1.0)
    follow_path(bench, blocks=10)
    bench.run(500)
    cycle = bench.events[0].cycle
    assert bench.event_texts() == [
        "P-ERR-17744 axis x: following error 1.0247 mm exceeds 1.0 mm (P-AXIS-00168); the axis stops on its own ramp "
        "(ErrorStop)"
    ]
    assert bench.column("state")[cycle - 1 : cycle + 1] == [S.SYNCHRONIZED_MOTION, S.ERROR_STOP]
    assert_axis_smooth(bench.blocks[1:], acceleration=5000.0, jerk=50_000.0)


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


@pytest.mark.parametrize("name", ["acceleration", "deceleration"])
def test_an_acceleration_above_that_of_the_axis_is_refused(name: str) -> None:
    bench = axis_bench(max_acceleration=50000.0)
    assert bench.refused("move_absolute", target=5.0, **{name: 50000.5}) == (
        f"P-ERR-23013 axis x: move_absolute refused: {name} 50000.5 mm/s² is above the maximum 50000.0 mm/s² (P-AXIS-00008); "
        "nothing was changed"
    )
