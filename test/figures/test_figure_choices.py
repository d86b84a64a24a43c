"""Choices in the head of a figure: panels, units, an NC program, another kind of picture."""

import numpy as np
import pytest
from figure_support import head_and_scenario, run_of, texts_of

from cnc_ptp.plots.svg import svg_text
from figures.kinds import draw
from figures.picture import last_above, shown_cycles
from figures.run import Marker, run_figure
from figures.scenario_head import FigureError, read_head

MOVE = "- {at: 0.05, to: x, do: move_absolute, target: 1}\n"
PTP, MILL, FRICTION = "config/ptp.yaml", "config/mill.yaml", "config/friction.yaml"


def written(folder, scenario=MOVE, machine=PTP, axes="x", **head):
    """A scenario file with a head."""
    return head_and_scenario(folder, {"title": "t", "caption": "c", "machine": machine, "axes": axes, **head}, scenario)


def picture(file):
    figure = read_head(file)
    return texts_of(svg_text(draw(figure, run_figure(figure)), title=figure.title))


def refusal(file):
    """The text of the refusal without "figure move.yaml: " and "; no picture was drawn"."""
    with pytest.raises(FigureError) as caught:
        picture(file)
    text = str(caught.value)
    assert text.startswith("figure move.yaml: ")
    assert text.endswith("; no picture was drawn")
    return text.removeprefix("figure move.yaml: ").removesuffix("; no picture was drawn")


# panels


def titles(texts):
    return [text for text in texts if " in " in text]


def test_panels_are_drawn_in_the_order_of_the_head(tmp_path):
    shown = titles(picture(written(tmp_path, panels="jerk, torque, velocity")))
    assert shown == ["jerk in mm/s³", "torque in N", "velocity in mm/s", "time in s"]


def test_torque_is_that_of_the_motor_where_the_axis_has_a_feed_constant(tmp_path):
    assert "torque in Nm" in picture(written(tmp_path, machine=FRICTION, panels="torque"))
    c = "- {at: 0.05, to: c, do: move_absolute, target: 1}\n"
    assert {"torque in Nm", "velocity in deg/s"} <= set(
        picture(written(tmp_path, c, axes="c", panels="velocity, torque"))
    )


def test_small_following_errors_are_shown_in_micrometres(tmp_path):
    """20 mm/s at Kv = 500 1/s are 40 µm, 200 mm/s 0.4 mm."""
    slow, fast = (
        f"- {{at: 0.05, to: x, do: move_absolute, target: 60, velocity: {velocity}}}\n" for velocity in (20, 200)
    )
    assert {"following error in µm", "40"} <= set(picture(written(tmp_path, slow, panels="following error")))
    assert {"following error in mm", "0.4"} <= set(picture(written(tmp_path, fast, panels="following error")))


def test_unknown_panel(tmp_path):
    known = (
        "position, velocity, acceleration, jerk, following error, command velocity, feedforward, additive velocity, "
        "additive torque, friction current, torque"
    )
    assert refusal(written(tmp_path, panels="speed")) == f"panel 'speed' does not exist, known are {known}"


def test_the_picture_goes_on_until_the_lag_is_gone():
    """A lag of 10 mm that falls with 1/Kv = 20 ms is below 1 % after 92 ms."""
    run = run_of("control_lag_without")
    end, lag = shown_cycles(run), run.column("x", "following_error")
    assert abs(lag[end]) < 0.1 <= abs(lag[end - 60])
    assert last_above(10.0 * np.exp(-np.arange(200) / 20.0), 0.01) == 92


# spindles


def test_spindle_has_panels_of_its_own(tmp_path):
    start = "- {at: 0.02, to: s, do: start, direction: cw, speed_rpm: 30}\n- {at: 0.1, to: s, do: stop}\n"
    file = written(tmp_path, start, machine=MILL, axes="s")
    assert titles(picture(file)) == ["speed in rpm", "acceleration in deg/s²", "following error in deg", "time in s"]
    run = run_figure(read_head(file))
    assert run.column("s", "set_speed_rpm").max() == 30.0
    assert run.markers == (Marker(0.02, "start 30 rpm"), Marker(0.1, "stop"))


def test_axis_and_spindle_share_the_panels_that_both_have(tmp_path):
    both = "- {at: 0.02, to: s, do: start, direction: cw, speed_rpm: 30}\n- {at: 0.1, to: s, do: stop}\n" + MOVE
    texts = picture(written(tmp_path, both, machine=MILL, axes="x, s", panels="position, speed"))
    assert titles(texts) == ["position in mm or deg", "speed in rpm", "time in s"]
    assert (texts.count("x set"), texts.count("s set")) == (1, 2)


def test_unit_that_the_machine_does_not_have(tmp_path):
    expected = "axis 'w' does not exist in config/mill.yaml, known are x, y, z, s"
    assert refusal(written(tmp_path, machine=MILL, axes="w")) == expected


# programs


def test_program_runs_from_the_start_on_and_its_switches_are_marked(tmp_path):
    (tmp_path / "part.nc").write_text("N10 G90 G136 X80\nN20 G135\nN30 G01 X5 F6000\nN40 X[COMP OFF FRICT]\nN50 M30\n")
    run = run_figure(read_head(written(tmp_path, "[]\n", machine=MILL, program="part.nc")))
    assert run.column("x", "set_position")[-1] == 5.0
    texts = [marker.text for marker in run.markers]
    assert texts == ["set feedforward 80 %", "set feedforward on", "set friction compensation off"]


def test_program_that_cannot_be_read(tmp_path):
    expected = (
        f"P-ERR-26110 NC program {tmp_path}/part.nc cannot be read: No such file or directory; nothing was started"
    )
    assert refusal(written(tmp_path, "[]\n", machine=MILL, program="part.nc")) == expected


# kinds


def test_unknown_kind(tmp_path):
    of_spindles = "spindle_curve, spindle_states, spindle_and_path, gear_ranges"
    known = f"time, friction_curve, weights, circle, {of_spindles}, over_path, corners, thread, surfaces, turned_part"
    expected = f"kind 'bars' does not exist, known are {known}"
    assert refusal(written(tmp_path, kind="bars")) == expected


def test_friction_curve_needs_a_plant_with_friction(tmp_path):
    expected = "axis 'x' has no friction (simulation.model CASCADED, P-SIM-00006)"
    assert refusal(written(tmp_path, kind="friction_curve")) == expected


def test_friction_curve_needs_both_directions(tmp_path):
    one = "- {at: 0.1, to: x, do: move_relative, distance: 12, velocity: 10}\n"
    expected = (
        "P-ERR-27007 axis x: no speed was driven in both directions (constant velocities: 10); weight and friction "
        "cannot be told apart, no table was made, drive each speed in both directions"
    )
    assert refusal(written(tmp_path, one, machine=FRICTION, kind="friction_curve")) == expected


def test_weights_need_a_reversal(tmp_path):
    one = "- {at: 0.1, to: x, do: move_relative, distance: 1, velocity: 10}\n"
    expected = "axis 'x' never turns back with friction compensation"
    assert refusal(written(tmp_path, one, machine=FRICTION, kind="weights")) == expected


CIRCLE = {"machine": MILL, "axes": "x, y", "kind": "circle", "program": "part.nc"}
ARC = "N10 G90 X10\nN20 G04 0.1\nN30 G03 I-10 F2000\nN40 M30\n"


@pytest.mark.parametrize(
    ("head", "expected"),
    [
        ({"axes": "x"}, "a circle needs two axes of a machine with a channel"),
        ({}, "a circle needs 'turns: name = N10 N20; ...' in its head"),
        ({"turns": "off = 30"}, "'off = 30' in 'turns:' is not 'name = N10 N20'"),
        ({"turns": "N30"}, "'N30' in 'turns:' is not 'name = N10 N20'"),
        ({"turns": "off = N30 N99"}, "turns 'off': the program does not move in N99"),
    ],
)
def test_heads_that_make_no_circle(tmp_path, head, expected):
    (tmp_path / "part.nc").write_text(ARC)
    assert refusal(written(tmp_path, "[]\n", **{**CIRCLE, **head})) == expected
