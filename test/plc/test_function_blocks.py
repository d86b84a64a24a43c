"""Function blocks: the command behind each, what they say of refusals and ends, and on real axes and spindles."""

from __future__ import annotations

from math import nan
from typing import Any

import pytest
from machine_support import MILL, PTP
from plcopen_support import (
    ABORTED,
    ACCEPTED,
    ACTIVE,
    DONE,
    FAILED,
    REFUSED,
    FakeUnit,
    PlcBench,
    axis_block,
    outputs,
    spindle_block,
)

from cnc_ptp.plc.plcopen import (
    MC_CamIn,
    MC_CamOut,
    MC_ExtSetPointGenDisable,
    MC_ExtSetPointGenEnable,
    MC_ExtSetPointGenFeed,
    MC_GearIn,
    MC_GearOut,
    MC_Halt,
    MC_Home,
    MC_MoveAbsolute,
    MC_MoveAdditive,
    MC_MoveModulo,
    MC_MoveRelative,
    MC_MoveSuperimposed,
    MC_MoveVelocity,
    MC_OrientSpindle,
    MC_Power,
    MC_ReadAxisError,
    MC_ReadParameter,
    MC_ReadStatus,
    MC_Reset,
    MC_SetOverride,
    MC_SetPosition,
    MC_Stop,
    MC_WriteParameter,
)
from cnc_ptp.plc.program.plc_io import PlcIo
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit
from cnc_ptp.protocol.commands import COMMANDS

DYNAMICS = {"velocity": 1.0, "acceleration": 2.0, "deceleration": 3.0, "jerk": 4.0}
COMMAND_OF: list[tuple[str, type, dict[str, Any], str, dict[str, Any]]] = [
    ("axis", MC_MoveAbsolute, {"position": 5.0}, "move_absolute", {"target": 5.0}),
    ("axis", MC_MoveAbsolute, {"position": 5.0, **DYNAMICS}, "move_absolute", {"target": 5.0, **DYNAMICS}),
    ("axis", MC_MoveRelative, {"distance": -5.0, "jerk": 4.0}, "move_relative", {"distance": -5.0, "jerk": 4.0}),
    ("axis", MC_MoveAdditive, {"distance": 5.0, **DYNAMICS}, "move_additive", {"distance": 5.0, **DYNAMICS}),
    ("axis", MC_MoveModulo, {"position": -90.0}, "move_modulo", {"position": -90.0}),
    ("axis", MC_MoveVelocity, {**DYNAMICS, "velocity": -7.0}, "move_velocity", {**DYNAMICS, "velocity": -7.0}),
    (
        "axis",
        MC_MoveSuperimposed,
        {"distance": 1.0, "velocity_difference": 2.0},
        "move_superimposed",
        {"distance": 1.0, "velocity_difference": 2.0},
    ),
    ("axis", MC_Halt, {}, "halt", {}),
    ("axis", MC_Stop, {}, "stop", {}),
    ("axis", MC_Stop, {"deceleration": 9.0}, "emergency_stop", {"deceleration": 9.0}),
    ("axis", MC_Home, {}, "home", {}),
    ("axis", MC_Reset, {}, "reset", {}),
    ("axis", MC_SetPosition, {"position": 3.0, "relative": True}, "set_position", {"position": 3.0, "relative": True}),
    (
        "axis",
        MC_WriteParameter,
        {"parameter": "P-AXIS-00236", "value": 5.0},
        "write_parameter",
        {"parameter": "P-AXIS-00236", "value": 5.0},
    ),
    (
        "axis",
        MC_GearIn,
        {"master": "y", "ratio_numerator": 1.0, "ratio_denominator": -4.0},
        "couple",
        {"master": "y", "factor": -0.25},
    ),
    ("axis", MC_GearOut, {}, "decouple", {}),
    (
        "axis",
        MC_CamIn,
        {"master": "y", "cam_table": [(0, 0), (1, 2), (2, 0)], "periodic": False, "slave_offset": 1.0},
        "couple_cam",
        {"master": "y", "table": [[0.0, 0.0], [1.0, 2.0], [2.0, 0.0]], "cyclic": False, "slave_offset": 1.0},
    ),
    ("axis", MC_CamOut, {}, "decouple", {}),
    (
        "axis",
        MC_ExtSetPointGenEnable,
        {"mode": "relative", "position": 8.0},
        "external_enable",
        {"mode": "relative", "target": 8.0},
    ),
    ("axis", MC_ExtSetPointGenDisable, {}, "external_disable", {}),
    ("spindle", MC_MoveVelocity, {"velocity": -600.0}, "start", {"direction": "ccw", "speed_rpm": 600.0}),
    (
        "spindle",
        MC_MoveVelocity,
        {"velocity": 600.0, "buffer_mode": "buffered"},
        "start",
        {"direction": "cw", "speed_rpm": 600.0, "source": "plc"},
    ),
    ("spindle", MC_Halt, {}, "stop", {}),
    ("spindle", MC_Stop, {}, "stop", {}),
    ("spindle", MC_Stop, {"deceleration": 9.0, "jerk": 9.0}, "stop", {}),
    ("spindle", MC_Home, {}, "home", {}),
    (
        "spindle",
        MC_OrientSpindle,
        {"position": 90.0, "velocity": 30.0, "direction": "shortest"},
        "orient",
        {"position_deg": 90.0, "speed_rpm": 30.0, "direction": "shortest"},
    ),
    (
        "spindle",
        MC_GearIn,
        {"master": "m", "ratio_numerator": 2.0, "ratio_denominator": 3.0},
        "couple",
        {"master": "m", "factor_num": 2.0, "factor_den": 3.0},
    ),
    ("spindle", MC_GearOut, {}, "decouple", {}),
]
"""Kind, block, inputs -> the command and its arguments. Names of commands of which an axis has none yet: see COMMANDS."""


@pytest.mark.parametrize(("kind", "block_type", "inputs", "command", "arguments"), COMMAND_OF)
def test_the_command_behind_a_block(
    kind: str, block_type: type, inputs: dict[str, Any], command: str, arguments: dict[str, Any]
) -> None:
    unit = FakeUnit(kind)
    block_type(unit)(True, **inputs)
    given = unit.last.arguments
    mode = {"buffer_mode": "aborting"} if "buffer_mode" in COMMANDS["axis"].get(command, {}) and kind == "axis" else {}
    assert (unit.last.command, given) == (command, arguments | mode)


def test_a_buffer_mode_goes_to_the_axis_and_a_spindle_has_two() -> None:
    axis, spindle = FakeUnit(), FakeUnit("spindle", "s")
    MC_MoveAbsolute(axis)(True, position=1.0, buffer_mode="blending_low")
    assert axis.last.arguments == {"target": 1.0, "buffer_mode": "blending_low"}
    orient = MC_OrientSpindle(spindle)
    orient(True, position=1.0, buffer_mode="blending_low")
    assert spindle.given == []
    assert (orient.error_id, orient.error_text) == (
        22166,
        "spindle s: orient refused: buffer_mode = 'blending_low' is not aborting or buffered; nothing was changed",
    )


def test_an_error_has_number_and_text_of_its_unit() -> None:
    unit = FakeUnit()
    move = MC_MoveAbsolute(unit)
    move(True, position=1.0)
    assert outputs(move) == "busy"
    unit.last.tells = REFUSED
    move(True)
    assert outputs(move) == "error" and (move.error_id, move.error_text) == (23005, "command 1 refused")
    move(False)
    assert outputs(move) == "" and (move.error_id, move.error_text) == (0, "")


def test_a_motion_that_fails_says_with_which_error() -> None:
    unit = FakeUnit()
    move = MC_MoveAbsolute(unit)
    move(True, position=1.0)
    unit.last.tells = FAILED
    move(False)
    assert (move.error_id, move.error_text) == (23010, "axis x: its motion has ended with error 23010")


def test_mc_stop_holds_the_unit_until_execute_falls() -> None:
    unit = FakeUnit()
    stop, other_stop, move = MC_Stop(unit), MC_Stop(unit), MC_MoveAbsolute(unit)
    stop(True)
    unit.last.tells = DONE
    stop(True)
    assert outputs(stop) == "done"
    move(True, position=1.0)
    assert (move.error_id, move.error_text) == (
        22165,
        "axis x: move_absolute refused: MC_Stop holds it while execute is true; nothing was changed",
    )
    other_stop(True)
    unit.last.tells = DONE
    stop(False)
    move(False)
    move(True, position=1.0)
    assert move.error and unit.stops == 1  # the other one still holds it
    other_stop(False)  # done for one call: it holds until that
    assert unit.holds == [True, False]
    move(False)
    move(True, position=1.0)
    assert outputs(move) == "busy" and unit.last.command == "move_absolute"


def test_mc_stop_holds_the_unit_until_it_is_done_even_if_execute_fell_before() -> None:
    unit = FakeUnit()
    stop = MC_Stop(unit)
    stop(True)
    unit.last.tells = ACTIVE
    stop(False)
    assert stop.busy and unit.holds == [True]
    unit.last.tells = DONE
    stop(False)
    assert stop.done and unit.holds == [True, False]


def test_a_spindle_has_no_ramps_to_be_given() -> None:
    unit = FakeUnit("spindle", "s")
    move = MC_MoveVelocity(unit)
    move(True, velocity=500.0, acceleration=100.0)
    assert (move.error_id, move.error_text, unit.given) == (
        22170,
        "spindle s: MC_MoveVelocity refused: a spindle has the ramps of its gear, no acceleration, deceleration or jerk "
        "is possible; nothing was changed",
        [],
    )


def test_mc_stop_that_is_refused_holds_nothing() -> None:
    unit = FakeUnit()
    stop = MC_Stop(unit)
    stop(True)
    assert unit.stops == 1
    unit.last.tells = REFUSED
    stop(True)
    assert stop.error and unit.stops == 0
    stop(False)
    assert unit.stops == 0


def test_in_velocity_is_the_commanded_velocity_times_the_override() -> None:
    unit = FakeUnit()
    move = MC_MoveVelocity(unit)
    move(True, velocity=-50.0)
    unit.last.tells = ACTIVE
    for velocity, override, reached in (
        (-10.0, 100.0, False),
        (-50.0, 100.0, True),
        (-50.0, 50.0, False),
        (-25.0, 50.0, True),
    ):
        unit.block = axis_block(S.CONTINUOUS_MOTION, set_velocity=[velocity], override_percent=[override])
        move(False)
        assert (move.in_velocity, outputs(move)) == (reached, "busy active")
    unit.last.tells = ABORTED
    move(False)
    assert (move.in_velocity, outputs(move)) == (False, "command_aborted")


def test_an_endless_motion_that_comes_to_rest_by_itself_is_an_error() -> None:
    unit = FakeUnit()
    move, gear = MC_MoveVelocity(unit), MC_GearIn(unit)
    move(True, velocity=50.0)
    unit.last.tells = DONE
    move(True)
    assert (move.error_id, move.error_text) == (
        22168,
        "axis x: its motion has come to rest without a command, at a soft limit for instance",
    )
    gear(True, master="y")
    unit.last.tells = DONE
    gear(True)
    assert (gear.error_id, gear.error_text) == (22168, "axis x: its coupling to y has ended without a command")


def test_in_gear_of_a_spindle_is_what_the_spindle_reports() -> None:
    unit = FakeUnit("spindle", "s")
    gear = MC_GearIn(unit)
    master = FakeUnit("spindle", "m")
    gear(True, master=master, ratio_numerator=-2.0)
    unit.last.tells = ACCEPTED
    unit.block = spindle_block(master_wanted="m")
    gear(True)
    assert (gear.in_gear, outputs(gear)) == (False, "busy")
    for reached, speed, of_master, in_gear in (
        (False, -200.0, 100.0, False),
        (True, -200.0, 100.0, True),
        (True, 0.0, 100.0, False),
        (True, 200.0, 100.0, False),
        (True, 0.0, 0.0, True),
    ):
        unit.block = spindle_block(master="m", speed_reached=[reached], set_speed_rpm=[speed])
        master.block = spindle_block(set_speed_rpm=[of_master])
        gear(True)
        assert (gear.in_gear, outputs(gear)) == (in_gear, "busy active")
    unit.block = spindle_block()
    gear(True)
    assert (gear.in_gear, outputs(gear)) == (False, "command_aborted")
    gear(False)
    gear(True, master="m")
    unit.last.tells = ACCEPTED
    unit.block = spindle_block(master="m", speed_reached=[True], set_speed_rpm=[5.0])
    gear(True)
    assert gear.in_gear  # by the name alone the speed of the master is not known
    unit.block = spindle_block()
    gear(True)
    gear(False)
    gear(True, master="m")
    unit.last.tells = ACCEPTED
    gear(True)
    assert (gear.error_id, gear.error_text) == (22167, "spindle s: m was not granted as its master")


def test_mc_gear_in_changes_the_ratio_of_an_axis_that_is_in_gear() -> None:
    """x goes from 0 to 60 at 100 mm/s from 0.5 s on; y follows with 1, and with 2 from 0.8 s on (30 mm of x)."""

    def make(io: PlcIo) -> Recorder:
        x, y = io.axis("x"), io.axis("y")
        gear, again, move, out = MC_GearIn(y), MC_GearIn(y), MC_MoveAbsolute(x), MC_GearOut(y)

        def step(io: PlcIo, n: int) -> str:
            gear(1 <= n < 20, master=x)
            move(n >= 50, position=60.0, velocity=100.0)
            again(n >= 80, master="x", ratio_numerator=2.0)
            out(n >= 160)
            io.done(n > 170)
            return outputs(again) + " in_gear" * again.in_gear

        return Recorder(step)

    bench = PlcBench(make).run()
    assert bench.plc.seen == ["", "busy", "busy active in_gear", "command_aborted"] and not bench.refusals()
    x = bench.column("x", "set_position")[800]  # y is continuous in the cycle of the command
    assert 20.0 < x < 35.0 and bench.position("y") == pytest.approx(x + 2.0 * (60.0 - x), abs=1e-9)
    assert [record.command for record in bench.records if record.target == "y"] == [
        "couple", "set_coupling_factor", "decouple",
    ]  # fmt: skip


def test_a_new_ratio_for_another_kind_of_coupling_is_refused_with_its_reason() -> None:
    unit = FakeUnit("axis", "y")
    unit.block = axis_block(S.SYNCHRONIZED_MOTION, master="x", job=7)
    gear = MC_GearIn(unit)
    gear(True, master="x", ratio_numerator=2.0)
    assert (unit.last.command, unit.last.arguments) == ("set_coupling_factor", {"factor": 2.0})
    unit.last.tells = REFUSED
    gear(True)
    assert gear.error and gear.error_id == 23005


def test_mc_power_gives_enable_and_feed_releases_when_they_change() -> None:
    unit = FakeUnit()
    power = MC_Power(unit)
    power(True)
    assert unit.given == [] and power.busy  # nothing is known of the unit
    unit.block = axis_block(S.DISABLED)
    power(True)
    assert [(given.command, given.arguments) for given in unit.given] == [("power", {"enabled": True})]
    assert (power.busy, power.valid, power.status) == (True, False, False)
    for given in unit.given:
        given.tells = ACCEPTED
    unit.block = axis_block(S.STANDSTILL)
    power(True)
    assert (power.busy, power.valid, power.status, power.error) == (False, True, True, False)
    power(True, enable_negative=False)
    assert len(unit.given) == 2 and unit.last.arguments == {"forward": True, "backward": False}
    unit.last.tells = REFUSED
    power(True, enable_negative=False)
    assert (power.valid, power.error, power.error_id) == (False, True, 23005)
    unit.block = axis_block(S.ERROR_STOP)
    power(False)
    assert unit.given[2].arguments == {"enabled": False} and not power.status
    assert unit.given[3].arguments == {"forward": True, "backward": True}


def test_mc_power_does_not_command_an_enable_that_is_there() -> None:
    unit = FakeUnit()
    unit.block = axis_block(S.STANDSTILL)
    power = MC_Power(unit)
    power(True)
    assert unit.given == [] and power.valid and power.status
    power(False)
    assert unit.given[0].arguments == {"enabled": False}
    other = MC_Power(FakeUnit("spindle"))
    other.unit.block = spindle_block(S.DISABLED)
    other(True)
    assert [given.command for given in other.unit.given] == ["power"]


def test_mc_set_override_gives_a_factor_when_it_changes_and_again_after_enable() -> None:
    unit = FakeUnit()
    override = MC_SetOverride(unit)
    override(True, 0.5)
    override(True, 0.5)
    assert unit.last.arguments == {"percent": 50.0} and len(unit.given) == 1 and override.busy and not override.enabled
    unit.last.tells = ACCEPTED
    override(True, 0.5)
    assert override.enabled
    override(False)
    assert not override.busy and not override.enabled
    override(True, 0.5)
    assert len(unit.given) == 2
    unit.last.tells = REFUSED
    override(True, 0.5)
    assert override.error_id == 23005 and not override.busy
    override(True, 0.7)
    assert override.error and len(unit.given) == 2  # until enable has fallen


def test_a_factor_that_is_no_number_is_refused_once() -> None:
    unit = FakeUnit()
    override = MC_SetOverride(unit)
    for _ in range(3):
        override(True, nan)
    assert len(unit.given) == 1
    unit.last.tells = REFUSED
    override(True, nan)
    assert override.error and not override.enabled and len(unit.given) == 1


@pytest.mark.parametrize("denominator", [0, -0.0])
def test_a_gear_ratio_over_0_is_refused_by_the_block(denominator: float) -> None:
    unit = FakeUnit()
    gear = MC_GearIn(unit)
    gear(True, "y", 1.0, denominator)
    assert (gear.busy, gear.error, gear.error_id, unit.given) == (False, True, 22001, [])
    reason = f"ratio_denominator = {denominator} must be different from 0"
    assert gear.error_text == f"axis x: MC_GearIn refused: {reason}; nothing was changed"
    gear(False)
    gear(True, "y", 1.0, 2.0)
    assert unit.last.arguments == {"master": "y", "factor": 0.5}


def test_read_blocks() -> None:
    unit = FakeUnit()
    status, error, parameter = MC_ReadStatus(unit), MC_ReadAxisError(unit), MC_ReadParameter(unit)
    status(True)
    error(True)
    assert status.busy and not status.valid and error.busy and not error.valid
    names = (
        "disabled",
        "standstill",
        "homing",
        "discrete_motion",
        "continuous_motion",
        "synchronized_motion",
        "stopping",
        "error_stop",
    )
    for state in S:
        unit.block = axis_block(state, error_id=[17])
        status(True)
        error(True)
        true = [name for name in names if getattr(status, name)]
        assert true == [state.name.lower()] and status.valid
        assert error.valid and error.axis_error_id == 17
    status(False)
    assert not status.valid and not any(getattr(status, name) for name in names)
    unit.parameters["P-AXIS-00236"] = 500
    parameter(True, "P-AXIS-00236")
    assert parameter.valid and parameter.value == 500


def test_feed_counts_its_setpoints_from_the_next_block_on() -> None:
    unit = FakeUnit()
    feed = MC_ExtSetPointGenFeed(unit)
    feed((0.0, 0.0, 1.0, 1), (0.1, 1.0, 1.0, 1))
    assert unit.last.arguments["setpoints"] == [[0, 0.0, 0.0, 1.0, 1], [1, 0.1, 1.0, 1.0, 1]]
    unit.block = axis_block(first_cycle=9)
    unit.last.tells = REFUSED
    feed((0.2, 1.0, 0.0, 1))
    assert unit.last.arguments["setpoints"] == [[10, 0.2, 1.0, 0.0, 1]]
    assert (feed.error, feed.error_id, feed.error_text) == (True, 23005, "command 1 refused")
    unit.last.tells = ACCEPTED
    feed()
    assert not feed.error and len(unit.given) == 2


# on a machine


class Recorder:
    """A PLC that calls its blocks by a plan and notes their outputs: `step(io, n)` in its n-th cycle."""

    def __init__(self, step: Any) -> None:
        self._step = step
        self.n = 0
        self.seen: list[str] = []

    def cycle(self, io: PlcIo) -> None:
        told = self._step(io, self.n)
        if told is not None and self.seen[-1:] != [told]:
            self.seen.append(told)
        self.n += 1


def test_a_positioning_on_an_axis() -> None:
    def make(io: PlcIo) -> Recorder:
        move = MC_MoveAbsolute(io.axis("x"))

        def step(io: PlcIo, n: int) -> str:
            move(n < 40, position=10.0, velocity=100.0)
            io.done(n > 50)
            return outputs(move)

        return Recorder(step)

    bench = PlcBench(make).run()
    assert bench.plc.seen == ["busy", "busy active", "done", ""]
    assert bench.position("x") == 10.0 and not bench.failed
    assert [(r.target, r.command, r.cycle, r.accepted) for r in bench.records] == [("x", "move_absolute", 0, True)]


def test_a_halt_aborts_a_positioning_and_a_refused_one_changes_nothing() -> None:
    def make(io: PlcIo) -> Recorder:
        x = io.axis("x")
        move, far, halt = MC_MoveAbsolute(x), MC_MoveAbsolute(x), MC_Halt(x)

        def step(io: PlcIo, n: int) -> str:
            move(n >= 1, position=1000.0)
            far(n == 10, position=1e9)
            halt(n >= 30)
            io.done(n > 100)
            return " | ".join(map(outputs, (move, far, halt)))

        return Recorder(step)

    bench = PlcBench(make).run()
    assert bench.plc.seen == [
        " |  | ",
        "busy |  | ",
        "busy active |  | ",
        "busy active | busy | ",
        "busy active | error | ",
        "busy active |  | ",
        "busy active |  | busy",
        "command_aborted |  | busy active",
        "command_aborted |  | done",
    ]
    assert len(bench.refusals()) == 1 and 0.0 < bench.position("x") < 1000.0


def test_spindle_blocks_on_a_mill() -> None:
    def make(io: PlcIo) -> Recorder:
        s = io.spindle("s")
        turn, orient, stop = MC_MoveVelocity(s), MC_OrientSpindle(s), MC_Stop(s)

        def step(io: PlcIo, n: int) -> str:
            turn(n >= 1, velocity=-600.0)
            orient(n >= 60, position=90.0, direction="ccw")
            stop(n >= 200)
            io.done(n > 300)
            return " | ".join((outputs(turn) + " in_velocity" * turn.in_velocity, outputs(orient), outputs(stop)))

        return Recorder(step)

    bench = PlcBench(make, machine=MILL).run()
    assert bench.plc.seen == [
        " |  | ",
        "busy |  | ",
        "busy active |  | ",
        "busy active in_velocity |  | ",
        "busy active in_velocity | busy | ",
        "command_aborted | busy active | ",
        "command_aborted | done | ",
        "command_aborted | done | busy",
        "command_aborted | done | done",
    ]
    assert bench.last("s").actual_position_deg[-1] % 360.0 == pytest.approx(90.0, abs=0.1)


def test_couplings_on_axes() -> None:
    def make(io: PlcIo) -> Recorder:
        x, y = io.axis("x"), io.axis("y")
        gear, out, move = MC_GearIn(y), MC_GearOut(y), MC_MoveRelative(x)

        def step(io: PlcIo, n: int) -> str:
            gear(1 <= n < 3, master=x, ratio_numerator=-1, ratio_denominator=2)
            move(n >= 5, distance=100.0)
            out(n >= 200)
            io.done(n > 210)
            return " | ".join((outputs(gear) + " in_gear" * gear.in_gear, outputs(move), outputs(out)))

        return Recorder(step)

    bench = PlcBench(make).run()
    assert bench.plc.seen[2:4] == ["busy active in_gear |  | ", "busy active in_gear | busy | "]
    assert bench.plc.seen[-3:] == [
        "busy active in_gear | done | busy",
        "command_aborted | done | done",  # for one call: execute has fallen long before
        " | done | done",
    ]
    assert bench.position("y") == -50.0


def test_power_reset_and_read_blocks_on_an_axis() -> None:
    seen: dict[str, Any] = {}

    def make(io: PlcIo) -> Recorder:
        x = io.axis("x")
        power, reset, status, error = MC_Power(x), MC_Reset(x), MC_ReadStatus(x), MC_ReadAxisError(x)
        read, write = MC_ReadParameter(x), MC_WriteParameter(x)

        def step(io: PlcIo, n: int) -> None:
            power(n < 20 or n > 40)
            status(True)
            error(True)
            reset(n > 60)
            write(n > 10, "P-AXIS-00236", 700)
            read(True, "getriebe[0].window")
            seen[n] = (power.status, status.disabled, error.axis_error_id, outputs(reset), outputs(write), read.value)
            io.done(n > 80)

        return Recorder(step)

    bench = PlcBench(make).run()
    assert not bench.failed
    assert seen[15][:3] == (True, False, 0) and seen[30][:3] == (False, True, 0) and seen[50][:3] == (True, False, 0)
    assert seen[70][3] == "done" and seen[20][4] == "done"
    assert seen[5][5] != 700 and seen[20][5] == 700


def test_stop_in_the_brake_phase_is_an_ordinary_one() -> None:
    """An emergency stop is refused there (23017)."""

    def make(io: PlcIo) -> Recorder:
        x = io.axis("x")
        move, stop = MC_MoveAbsolute(x), MC_Stop(x)

        def step(io: PlcIo, n: int) -> str:
            move(True, position=1000.0, velocity=2000.0, jerk=50000.0)
            stop(n >= 70, deceleration=20000.0)
            io.done(n > 120)
            return outputs(stop)

        return Recorder(step)

    bench = PlcBench(make).run()
    assert bench.plc.seen == ["", "busy", "busy active", "done"] and bench.position("x") == 1000.0
    assert [(record.command, record.error_id) for record in bench.records[1:]] == [
        ("emergency_stop", 23017),
        ("hold_stop", 0),
        ("stop", 0),
    ]


def test_external_setpoints_of_a_plc_are_those_of_the_axis_to_the_bit() -> None:
    def make(io: PlcIo) -> Recorder:
        x = io.axis("x")
        enable, feed, disable = MC_ExtSetPointGenEnable(x), MC_ExtSetPointGenFeed(x), MC_ExtSetPointGenDisable(x)

        def step(io: PlcIo, n: int) -> str:
            enable(n >= 0, mode="absolute")
            if 2 <= n < 12:
                cycles = range((n - 2) * 10, (n - 1) * 10)
                feed(*((0.5 * 1000.0 * (k * 0.001) ** 2, 1000.0 * k * 0.001, 1000.0, 1) for k in cycles))
            disable(n >= 12)
            io.done(n > 20)
            assert not feed.error, feed.error_text
            return " | ".join((outputs(enable) + " enabled" * enable.enabled, outputs(disable)))

        return Recorder(step)

    bench = PlcBench(make).run()
    assert bench.plc.seen == ["busy | ", "done enabled | ", "done enabled | busy", "done | done"]
    positions = bench.column("x", "set_position")[20:120]
    assert positions == [0.5 * 1000.0 * (k * 0.001) ** 2 for k in range(100)]
    assert any(bits & StatusBit.EXT_SETPOINT for bits in bench.column("x", "status_bits"))


def test_homing_is_done_at_its_standstill() -> None:
    def make(io: PlcIo) -> Recorder:
        home = MC_Home(io.spindle("s"))

        def step(io: PlcIo, n: int) -> str:
            home(n >= 1)
            io.done(home.done)
            return outputs(home)

        return Recorder(step)

    bench = PlcBench(make, machine=MILL).run()
    assert bench.plc.seen == ["", "busy", "busy active", "done"] and bench.last("s").referenced[-1]


def test_a_cam_follows_its_table() -> None:
    table = [[0.0, 0.0], [50.0, 20.0], [100.0, 0.0]]

    def make(io: PlcIo) -> Recorder:
        x, y = io.axis("x"), io.axis("y")
        cam, out, move = MC_CamIn(y), MC_CamOut(y), MC_MoveAbsolute(x)

        def step(io: PlcIo, n: int) -> str:
            cam(True, master="x", cam_table=table, periodic=False)
            move(n >= 5, position=50.0)
            out(move.done)
            io.done(out.done)
            return " | ".join((outputs(cam) + " in_sync" * cam.in_sync, outputs(out)))

        return Recorder(step)

    bench = PlcBench(make).run()
    assert bench.plc.seen[-3:] == ["busy active in_sync | ", "busy active in_sync | busy", "command_aborted | done"]
    assert bench.position("y") == pytest.approx(20.0, abs=1e-9)


def test_parameters_of_the_file_and_unknown_ones() -> None:
    seen: list[Any] = []

    def make(io: PlcIo) -> Recorder:
        read = MC_ReadParameter(io.axis("x"))

        def step(io: PlcIo, n: int) -> None:
            read(n % 4 < 2, ("P-AXIS-00212", "getriebe[0].kvv")[n % 8 >= 4])
            seen.append((read.valid, read.value, read.error_id, read.error_text))
            io.done(n > 10)

        return Recorder(step)

    PlcBench(make, machine=PTP).run()
    assert (
        seen[0][:3] == (True, 10000000, 0)
        and seen[5][0] is False
        and seen[5][2:]
        == (
            22169,
            "axis x has no parameter 'getriebe.0.kvv'; did you mean getriebe[i].kv (P-AXIS-00099)?; nothing was read",
        )
    )
    assert seen[6][2:] == (0, "")
