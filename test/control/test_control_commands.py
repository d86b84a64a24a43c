"""Commands of feedforward and friction compensation: what they select, what they refuse, word for word."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import pytest
from loop_support import NO_FRICTION, VEL, control, feedforward, make_loop, motion, run

from cnc_ptp.control.commands import ControlCommands
from cnc_ptp.control.control_loop import ControlLoop
from cnc_ptp.errors import CncError
from cnc_ptp.parameters.view.control_view import FrictionParameters

FRICTION = replace(NO_FRICTION, permitted=True, active=True, velocities=(0.0,), currents=(5.0,))
CRUISE = motion([(100, 25_000.0), (100, -25_000.0), (1400, 0.0)])


def bench(
    mode: int = VEL, friction: FrictionParameters = FRICTION, *, always: bool = False, subject: str = "axis x"
) -> tuple[ControlLoop, ControlCommands]:
    loop = make_loop(control(of_feedforward=feedforward(mode, always_active=always), friction=friction))
    return loop, ControlCommands(loop, subject)


def share(loop: ControlLoop) -> float:
    """The part of the velocity that the feedforward gives once it has been coupled in or out at standstill."""
    loop.step((0.0, 0.0, 0.0, 0.0), True)
    return run(loop, [(0.0, 10.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)])[0].feedforward_velocity / 10.0


def test_selection_and_weight_are_kept_apart() -> None:
    """G135, G136, G137 of the manual: a weight stays when the feedforward is switched."""
    loop, commands = bench()
    assert share(loop) == 0.0
    steps = [
        ({"enabled": True}, 1.0),
        ({"weight_percent": 80.0}, 0.8),
        ({"enabled": False}, 0.0),
        ({"enabled": True}, 0.8),
        ({"weight_percent": 0}, 0.0),
        ({"enabled": True, "weight_percent": 95}, 0.95),
        ({"enabled": False, "weight_percent": 30}, 0.0),
        ({"enabled": True}, 0.3),
    ]
    for arguments, expected in steps:
        assert commands.do_set_feedforward(0, **arguments) is None  # type: ignore[arg-type]
        assert share(loop) == pytest.approx(expected, rel=1e-12), arguments
    commands.do_reset_feedforward(0)
    assert share(loop) == 0.0
    commands.do_set_feedforward(0, enabled=True)
    assert share(loop) == 1.0, "the weight is 100 % again"


def test_permanent_activation_outlasts_g137_and_program_starts() -> None:
    """P-AXIS-00255; the weight of G136 holds for it too."""
    loop, commands = bench(always=True)
    assert share(loop) == 1.0
    commands.do_set_feedforward(0, enabled=False)
    assert share(loop) == 1.0
    commands.do_set_feedforward(0, weight_percent=40.0)
    assert share(loop) == pytest.approx(0.4)
    commands.do_reset_feedforward(0)
    assert share(loop) == 1.0


def test_a_program_start_in_motion_couples_out_softly() -> None:
    loop, commands = bench()
    commands.do_set_feedforward(0, enabled=True)
    before = run(loop, CRUISE[:500])
    commands.do_reset_feedforward(500)
    after = run(loop, CRUISE[500:1500])
    values = [row.feedforward_velocity for row in [before[-1], *after]]
    assert values[0] == pytest.approx(loop.drive.velocity, rel=1e-6) and values[-1] == 0.0
    assert 0.0 < max(a - b for a, b in pairwise(values)) <= 4.0 + 1e-9


@pytest.mark.parametrize("percent", [-1e-9, math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("subject", ["axis x", "spindle s"])
def test_a_weight_beyond_its_range_is_refused(percent: float, subject: str) -> None:
    loop, commands = bench(subject=subject)
    commands.do_set_feedforward(0, enabled=True, weight_percent=60.0)
    with pytest.raises(CncError) as caught:
        commands.do_set_feedforward(0, enabled=False, weight_percent=percent)
    text = (
        f"set_feedforward refused: weight_percent = {percent} must be a number of 0 or more (G136); nothing was changed"
    )
    assert str(caught.value) == f"P-ERR-23060 {subject}: {text}"
    assert share(loop) == pytest.approx(0.6)


@pytest.mark.parametrize("percent", [100.5, 136, 1e9])
@pytest.mark.parametrize("mode", [0, VEL])
def test_a_weight_above_100_is_limited_with_a_warning(percent: float, mode: int) -> None:
    """TF5200 feedforward 3: it is limited to 100 % for all axes."""
    loop, commands = bench(mode=mode)
    commands.do_set_feedforward(0, enabled=False, weight_percent=60.0)
    told = commands.do_set_feedforward(0, enabled=True, weight_percent=percent)
    limited = f"P-WARN-23062 axis x: weight_percent = {percent:g} is above 100 and limited to it (G136)"
    no_effect = "; feedforward without effect, P-AXIS-00223 (vorsteuer.vorsteuerung) is NONE"
    assert told == limited + ("" if mode else no_effect)
    assert loop.feedforward.percent == (100.0 if mode else 0.0)


@pytest.mark.parametrize("percent", [0, 0.0, 100, 100.0, 1e-9])
def test_the_ends_of_the_range_are_good(percent: float) -> None:
    loop, commands = bench()
    assert commands.do_set_feedforward(0, enabled=True, weight_percent=percent) is None
    assert share(loop) == pytest.approx(percent / 100.0)


def test_without_parameters_feedforward_has_no_effect_and_says_so() -> None:
    loop, commands = bench(mode=0)
    assert commands.do_set_feedforward(0, enabled=True, weight_percent=50.0) == (
        "axis x: feedforward without effect, P-AXIS-00223 (vorsteuer.vorsteuerung) is NONE"
    )
    assert commands.do_set_feedforward(0, enabled=False) is None
    assert share(loop) == 0.0


def test_nothing_asked_for() -> None:
    _, commands = bench()
    assert commands.do_set_feedforward(0) == (
        "axis x: set_feedforward without effect, neither enabled nor weight_percent is given"
    )


# ---------------------------------------------------------------- friction


def current(loop: ControlLoop) -> float:
    """After the 0.1 s in which it comes or goes."""
    return [loop.step((0.0, 1.0, 0.0, 0.0), True).friction_current for _ in range(101)][-1]


def test_friction_compensation_on_and_off_stays_after_a_program() -> None:
    loop, commands = bench()
    assert current(loop) == 5.0, "active after start-up"
    assert commands.do_set_friction_compensation(0, enabled=False) is None
    assert current(loop) == 0.0
    commands.do_reset_feedforward(0)
    assert current(loop) == 0.0
    assert commands.do_set_friction_compensation(0, enabled=True) is None
    assert current(loop) == 5.0


def test_friction_compensation_that_is_not_activated() -> None:
    loop, commands = bench(friction=replace(FRICTION, permitted=False, active=False))
    with pytest.raises(CncError) as caught:
        commands.do_set_friction_compensation(0, enabled=True)
    assert str(caught.value) == (
        "P-ERR-70495 axis x: set_friction_compensation refused: friction compensation is not activated (P-AXIS-00522 "
        "lr_param.frict_comp = 0); nothing was changed"
    )
    assert commands.do_set_friction_compensation(0, enabled=False) is None
    assert current(loop) == 0.0


@pytest.mark.parametrize("friction", [replace(FRICTION, active=False), replace(FRICTION, velocities=(), currents=())])
def test_friction_compensation_without_mode_or_table(friction: FrictionParameters) -> None:
    loop, commands = bench(friction=friction)
    assert commands.do_set_friction_compensation(0, enabled=True) == (
        "axis x: friction compensation without effect, P-COMP-00041 (frict_comp.mode) is 0, or the table has no entries"
    )
    assert current(loop) == 0.0
    assert commands.do_set_friction_compensation(0, enabled=False) is None
