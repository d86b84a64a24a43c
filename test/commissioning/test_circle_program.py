"""The program of a circle test, as the interpreter understands it, and which cycles of a run are measured."""

import math

import numpy as np
import pytest

from cnc_ptp.commissioning.circle_program import circle_program, find_plane, measured_turn
from cnc_ptp.errors import CncError
from cnc_ptp.nc.canonical import CircularMove
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.nc.plain_channel import plain_channel

AXES = ("X", "Y", "Z")


def circles_of(program):
    blocks = list(interpret(parse_program(program.text, "circle.nc"), (0.0, 0.0, 0.0), plain_channel(AXES)))
    return [(block.source.line, block.motion) for block in blocks if isinstance(block.motion, CircularMove)]


@pytest.mark.parametrize(("name", "indices"), [("XY", (0, 1)), ("zx", (2, 0)), ("XZ", (2, 0)), ("yz", (1, 2))])
@pytest.mark.parametrize("radius", [0.5, 25.0, 133.7])
def test_every_turn_is_a_full_circle_about_the_centre(name, indices, radius):
    program = circle_program(find_plane(name), centre=(12.5, -7.25), radius=radius, feed=2000.0)
    circles = circles_of(program)
    assert [line for line, _ in circles] == [turn.line for turn in program.turns]
    assert len(circles) == 4
    for (_, move), turn in zip(circles, program.turns, strict=True):
        assert move.plane == indices
        assert move.sweep == pytest.approx(-360.0 if turn.clockwise else 360.0)
        assert move.center == pytest.approx((12.5, -7.25), abs=1e-8)
        assert move.radius == pytest.approx(radius, abs=1e-8)
        assert move.feed == pytest.approx(2000.0 / 60.0)
        start = math.degrees(math.atan2(move.target[indices[1]] + 7.25, move.target[indices[0]] - 12.5)) % 360.0
        assert start == pytest.approx(turn.start)


def test_one_direction_and_blocks_ahead():
    program = circle_program(
        find_plane("XY"),
        centre=(0.0, 0.0),
        radius=25.0,
        feed=1234.5,
        directions=(True,),
        before=("G137", "X[COMP OFF FRICT]"),
    )
    assert program.text == (
        "%CIRCLE\n"
        "N10 G17 G90 G162\n"
        "N20 G137\n"
        "N30 X[COMP OFF FRICT]\n"
        "N40 G00 X17.67766953 Y17.67766953\n"
        "N50 G04 0.5\n"
        "N60 G02 I-17.67766953 J-17.67766953 F1234.5\n"
        "N70 G00 X-17.67766953 Y-17.67766953\n"
        "N80 G04 0.5\n"
        "N90 G02 I17.67766953 J17.67766953 F1234.5\n"
        "N100 G04 0.5\n"
        "N110 M30\n"
    )
    assert [turn.line for turn in program.turns] == [7, 10]


@pytest.mark.parametrize("name", ["XX", "XYZ", "X", "AB", ""])
def test_other_planes_are_refused(name):
    with pytest.raises(CncError) as refusal:
        find_plane(name)
    assert str(refusal.value) == f"P-ERR-27024 plane {name} is not one of XY, ZX, YZ; nothing was started"


def driven(program, lag=0.5, overshoot=0.0, last=360.0):
    """Lines and actual positions of a run of the program: each turn in 0.1° steps, `lag` degrees behind."""
    lines, points = [1], [(0.0, 0.0)]
    for turn in program.turns:
        side = -1.0 if turn.clockwise else 1.0
        for step in np.arange(0.0, last, 0.1):
            angle = math.radians(turn.start + side * (step - lag + overshoot))
            lines.append(turn.line)
            points.append((program.centre[0] + 25.0 * math.cos(angle), program.centre[1] + 25.0 * math.sin(angle)))
        lines += [turn.line + 1] * 30
        points += [(99.0, 99.0)] * 30
    return np.array(lines), np.array(points)


@pytest.mark.parametrize("clockwise", [False, True])
@pytest.mark.parametrize("lag", [0.0, 0.5, 30.0])
def test_the_two_halves_make_one_whole_turn_without_starts_and_stops(clockwise, lag):
    program = circle_program(find_plane("XY"), centre=(40.0, -30.0), radius=25.0, feed=2000.0)
    lines, points = driven(program, lag)
    chosen = measured_turn(program, clockwise, lines, points)
    offsets = points[chosen] - np.array(program.centre)
    angles = np.sort(np.degrees(np.arctan2(offsets[:, 1], offsets[:, 0])) % 360.0)
    assert len(angles) == pytest.approx(3600, abs=2)
    assert np.max(np.diff(angles, append=angles[0] + 360.0)) < 0.21
    starts = {turn.line for turn in program.turns if turn.clockwise == clockwise}
    assert set(lines[chosen]) == starts


def test_a_turn_that_was_not_finished_is_no_result():
    program = circle_program(find_plane("XY"), centre=(0.0, 0.0), radius=25.0, feed=2000.0)
    lines, points = driven(program, lag=0.0, last=200.0)
    with pytest.raises(CncError) as refusal:
        measured_turn(program, False, lines, points)
    assert (
        str(refusal.value) == "P-ERR-27022 circle test: the turn in line 5 went 199.9° of 360°; nothing was evaluated"
    )
    with pytest.raises(CncError) as refusal:
        measured_turn(program, False, np.zeros(5), np.zeros((5, 2)))
    assert str(refusal.value) == "P-ERR-27022 circle test: the turn in line 5 went 0.0° of 360°; nothing was evaluated"
