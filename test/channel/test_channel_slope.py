"""Step profile and trapezium (P-CHAN-00071, #SLOPE) in whole programs: times, jerk, feedforward, holds, resets."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from machine_support import CYCLE_TIME, MILL, MachineBench

from cnc_ptp.parameters import MachineParameters, load_machine
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

PROGRAM = "%P\nG60 G01 G90 X30 F3000\n{slope}\nX60\nG02 X80 Y0 I10 J0\nM30"


def of_slope(slope: str) -> MachineParameters:
    return replace(MILL, channels={"channel": replace(MILL.channels["channel"], slope=slope)})


def run(program: str, machine: MachineParameters = MILL) -> MachineBench:
    bench = MachineBench(program, machine=machine).run()
    assert bench.errors() == [] and bench.refusals() == []
    return bench


def jerks(bench: MachineBench) -> np.ndarray:
    """Of the channel's axes by program line: rows (line, x, y)."""
    columns = [bench.column(axis, "set_jerk") for axis in ("x", "y")]
    return np.column_stack([bench.column("channel", "line"), *columns])


def cycles_of(bench: MachineBench, line: int) -> int:
    return sum(1 for each in bench.column("channel", "line") if each == line)


def trapezium(t: np.ndarray, way: float, v: float, up: float, down: float) -> np.ndarray:
    """Position at times t of a motion with constant acceleration, by its closed form."""
    rise, fall = v / up, v / down
    cruise = way / v - 0.5 * (rise + fall)
    left = np.clip(rise + cruise + fall - t, 0.0, None)
    return np.select(
        [t < rise, t < rise + cruise],
        [0.5 * up * t**2, 0.5 * v * rise + v * (t - rise)],
        way - 0.5 * down * left**2,
    )


def test_a_line_of_the_step_profile_is_the_closed_form_in_every_cycle() -> None:
    bench = run("%P\nG01 G90 X30 F3000\nM30", of_slope("STEP"))
    position = np.array(bench.column("x", "set_position"))
    first = int(np.flatnonzero(position)[0]) - 1
    t = np.arange(len(position) - first) * CYCLE_TIME
    assert position[first:] == pytest.approx(trapezium(t, 30.0, 50.0, 2000.0, 2400.0), abs=1e-9)
    assert set(np.abs(bench.column("x", "set_acceleration"))) == {0.0, 2000.0, 2400.0}
    assert set(bench.column("x", "set_jerk")) == {0.0}


@pytest.mark.parametrize(
    ("default", "command", "steps"),
    [
        ("TRAPEZ", "#SLOPE [TYPE=STEP]", {2: False, 4: True, 5: True}),
        ("STEP", "#SLOPE [TYPE=TRAPEZ]", {2: True, 4: False, 5: False}),
        ("STEP", "#SLOPE DEFAULT", {2: True, 4: True, 5: True}),
        ("TRAPEZ", "#SLOPE DEFAULT", {2: False, 4: False, 5: False}),
    ],
)
def test_slope_acts_from_the_block_after_it(default: str, command: str, steps: dict[int, bool]) -> None:
    """On lines and arcs: no jerk with steps of the acceleration, else there is one; and steps are faster."""
    bench = run(PROGRAM.format(slope=command), of_slope(default))
    rows = jerks(bench)
    for line, stepping in steps.items():
        jerk = rows[rows[:, 0] == line, 1:]
        assert len(jerk) and (np.all(jerk == 0.0) if stepping else np.any(np.abs(jerk) > 1000.0)), line
    faster = cycles_of(bench, 4) < cycles_of(run(PROGRAM.format(slope=""), of_slope("TRAPEZ")), 4)
    assert faster is steps[4]
    assert bench.position("x") == 80.0 and bench.position("y") == 0.0


def test_the_next_program_begins_with_the_default() -> None:
    bench = MachineBench("%P\n#SLOPE [TYPE=STEP]\nG01 X10 F3000\nM30", end_when_idle=False)
    bench.run(1.0)
    bench.give("channel", "load", program="next.nc", text="%Q\nG01 X20 F3000\nM30")
    bench.give("channel", "start")
    before = len(bench.column("x", "set_jerk"))
    bench.run(1.0)
    jerk = np.array(bench.column("x", "set_jerk"))
    assert bench.position("x") == 20.0
    assert np.all(jerk[:before] == 0.0) and np.abs(jerk[before:]).max() > 1000.0


@pytest.mark.parametrize(("slope", "fed_forward"), [("STEP", False), ("TRAPEZ", True)])
def test_jerk_feedforward_has_nothing_to_put_out_with_the_step_profile(slope: str, fed_forward: bool) -> None:
    """P-AXIS-00337: for profiles without limited jerk a jerk command of 0 is output."""
    z = MILL.axes["z"]
    jerk = replace(z.control.feedforward, mode=0x4)
    machine = of_slope(slope)
    machine = replace(machine, axes={**MILL.axes, "z": replace(z, control=replace(z.control, feedforward=jerk))})
    bench = run("%P\nG135\nG01 Z-20 F3000\nM30", machine)
    assert bench.column("z", "feedforward_percent")[-1] == 100.0
    assert bool(np.any(bench.column("z", "feedforward_velocity"))) is fed_forward


def test_override_hold_and_reset_are_ramps_of_the_same_kind() -> None:
    """50 mm/s: at 40 % with 2400 mm/s², held, on again, and reset: v²/(2A-) of way."""
    bench = MachineBench("%P\nG01 X200 F3000\nM30", machine=of_slope("STEP"), end_when_idle=False)
    bench.run(0.3)
    for command, arguments in (
        ("set_override", {"percent": 40.0}),
        ("feed_hold", {"enabled": True}),
        ("feed_hold", {"enabled": False}),
        ("set_override", {"percent": 100.0}),
    ):
        assert bench.give("channel", command, **arguments).accepted
        bench.run(0.2)
    begin, from_cycle = bench.position("x"), len(bench.column("x", "set_velocity"))
    assert bench.column("x", "set_velocity")[-1] == pytest.approx(50.0)
    assert bench.give("channel", "reset").accepted
    bench.run(0.3)
    assert bench.position("x") - begin == pytest.approx(50.0**2 / 2.0 / 2400.0, abs=1.01 * 50.0 * CYCLE_TIME)
    velocity, acceleration = (np.array(bench.column("x", name)) for name in ("set_velocity", "set_acceleration"))
    assert velocity[from_cycle - 1 :].min() == 0.0 and velocity[-1] == 0.0
    assert set(acceleration) == {0.0, 2000.0, -2400.0}
    change = np.diff(velocity)
    assert change.max() <= 2000.0 * CYCLE_TIME + 1e-9 and change.min() >= -2400.0 * CYCLE_TIME - 1e-9
    assert bench.last("channel").state[-1] == C.READY
    assert bench.errors() == []


def loaded(value: str) -> MachineParameters:
    return load_machine(
        "/machine: {ros__parameters: {channels: [channel], axes: [x]}}\n"
        f"/channel: {{ros__parameters: {{prog_start: {{slope: {{profile: {value}}}}}, "
        "gruppe: {'0': {achse: {'0': {log_achs_nr: 1, bezeichnung: X}}}}}}\n"
        "/x: {ros__parameters: {kopf: {achs_nr: 1}}}\n",
        "m.yaml",
    )


@pytest.mark.parametrize(("value", "slope"), [("0", "STEP"), ("1", "TRAPEZ"), ("2", "SIN2"), ("3", "TRAPEZ")])
def test_the_parameter_selects_the_slope(value: str, slope: str) -> None:
    machine = loaded(value)
    assert machine.channels["channel"].slope == slope
    told = [str(notice) for notice in machine.warnings if "P-CHAN-00071" in notice.parameter]
    name = {"3": "HSC"}.get(value)
    ends = [] if name is None else [f"value {value}, {name}, is not available; 1 (TRAPEZ) is used"]
    assert len(told) == len(ends) and all(text.endswith(end) for text, end in zip(told, ends, strict=True))


def test_without_the_parameter_the_jerk_is_limited() -> None:
    assert MILL.channels["channel"].slope == "TRAPEZ"
