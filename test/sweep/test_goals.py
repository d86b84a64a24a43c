"""--goal: what an expression gives, and what is refused."""

import numpy as np
import pytest
from sweep_support import machine

from cnc_ptp.errors import CncError
from cnc_ptp.sweep.goals import Signal, read_goal, read_goals

END = "; nothing was started"
X = np.array([1.0, -4.0, 2.0])
Y = np.array([3.0, 1.0, 0.0])
COLUMNS = {
    Signal("x", "following_error"): X,
    Signal("y", "following_error"): Y,
    Signal("x", "set_velocity"): X,
    Signal("channel", "path_velocity"): Y,
    Signal("s", "following_error_deg"): X,
}
TIMES = {"program_time": 2.0, "run_time": 2.5}


@pytest.fixture(scope="module")
def mill():
    return machine()


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("max(following_error.x)", 4.0),
        ("max(following_error_deg.s)", 4.0),
        ("max(set_velocity.x)", 2.0),
        ("max(abs(set_velocity.x))", 4.0),
        ("min(set_velocity.x)", -4.0),
        ("mean(following_error.x)", 7.0 / 3.0),
        ("mean(set_velocity.x)", -1.0 / 3.0),
        ("rms(set_velocity.x)", 7.0**0.5),
        ("std(following_error.y)", (14.0 / 9.0) ** 0.5),
        ("last(set_velocity.x)", 2.0),
        ("max(following_error.x, following_error.y)", 4.0),
        ("max(program_time, 1)", 2.0),
        ("program_time", 2.0),
        ("run_time - program_time", 0.5),
        ("max((following_error.x ** 2 + following_error.y ** 2) ** 0.5)", 17.0**0.5),
        ("2 * program_time + 10 * rms(following_error.x) / 5", 4.0 + 2.0 * 7.0**0.5),
        ("mean(path_velocity)", 4.0 / 3.0),
        ("-max(path_velocity)", -3.0),
    ],
)
def test_values(mill, text, value):
    goal = read_goal(text, mill)
    assert goal.value(COLUMNS, TIMES) == pytest.approx(value, rel=1e-14)
    assert (goal.label, goal.sign) == (text, 1.0)


def test_maximise(mill):
    goal = read_goal("max:mean(path_velocity)", mill)
    assert (goal.label, goal.sign, goal.maximise) == ("mean(path_velocity)", -1.0, True)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("max(", "is no expression, as max(following_error.x)"),
        ("", "is no expression, as max(following_error.x)"),
        ("maxi(following_error.x)", "has the function maxi, which does not exist, only max, min, mean, rms, std, last, abs; did you mean max?"),
        ("max(following_eror.x)", "has following_eror.x: x has no signal 'following_eror'; did you mean following_error?"),
        ("max(following_error.chanel)", "has following_error.chanel: the machine has no unit 'chanel'; did you mean channel?"),
        ("max(x.following_error)", "has x.following_error; the signal is written following_error.x"),
        ("max(set_speed)", "has 'set_speed', which a run does not have; did you mean set_speed_rpm?"),
        ("max(set_jerk)", "has set_jerk without its unit: set_jerk.x or set_jerk.y or set_jerk.z"),
        ("following_error.x", "is a value for each cycle, not a number: max(following_error.x), rms(following_error.x) …"),
        ("abs(following_error.x) + 1", "is a value for each cycle, not a number: max(abs(following_error.x) + 1), rms(abs(following_error.x) + 1) …"),
        ("rms(following_error.x, 2)", "gives rms 2 values, it takes 1"),
        ("max()", "gives max 0 values, it takes some"),
        ("max(following_error.x, key=1)", "gives max 1 values, it takes some"),
        ("__import__('os').system('true')", "has '__import__('os').system('true')', which a goal cannot have"),
        ("program_time.__class__", "has program_time.__class__: the machine has no unit '__class__'"),
        ("[1]", "has '[1]', which a goal cannot have"),
        ("'a'", "has ''a'', which a goal cannot have"),
        ("True", "has 'True', which a goal cannot have"),
        ("1 if 1 else 2", "has '1 if 1 else 2', which a goal cannot have"),
        ("9" * 320, "has a number beyond 1.8e308"),
        ("1e999 * max(x.velocity)", "has a number beyond 1.8e308"),
        ("1or 2", "has '1 or 2', which a goal cannot have"),
        ("7 // 2", "has '7 // 2', which a goal cannot have"),
    ],
)  # fmt: skip
@pytest.mark.filterwarnings("error")
def test_expressions_that_are_refused(mill, text, reason):
    with pytest.raises(CncError) as caught:
        read_goal(text, mill)
    assert str(caught.value) == f"P-ERR-26179 --goal: '{text}' {reason}{END}"


@pytest.mark.parametrize(
    ("texts", "reason"),
    [
        ([], "there is no goal, as max(following_error.x)"),
        (["program_time", "max:program_time"], "'program_time' is given twice"),
        (["1+" * 300 + "1"], "a goal has 601 characters, at most 500"),
    ],
)
def test_goals_that_are_refused(mill, texts, reason):
    with pytest.raises(CncError) as caught:
        read_goals(texts, mill)
    assert str(caught.value) == f"P-ERR-26179 --goal: {reason}{END}"


@pytest.mark.parametrize(("text", "value"), [("1 / 0", "inf"), ("0 / 0", "nan"), ("10 ** 999", "inf")])
def test_a_value_that_is_not_finite(mill, text, value):
    with pytest.raises(CncError) as caught:
        read_goal(text, mill).value({}, TIMES)
    assert str(caught.value) == f"P-ERR-26179 --goal: {text} is {value}, not a finite number"
