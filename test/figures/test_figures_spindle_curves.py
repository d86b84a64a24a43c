"""Figures 15 to 21 of the spindle manual: every cycle of the runs against the closed forms, the points against its numbers."""

import math

import numpy as np
import pytest
from figure_support import CYCLE_TIME, SCENARIOS, head_and_scenario, run_of, texts_of

from cnc_ptp.plots.svg import svg_text
from figures.kinds import draw
from figures.run import run_figure
from figures.scenario_head import FigureError, read_head
from figures.spindle_curve import BRAKING, RUN_UP, measured, thinned

TOP = 54_000.0
FIGURES = {
    "spindle_curve": ("hyperbola",),
    "spindle_curve_shapes": ("polynomial", "hyperbola"),
    "spindle_curve_points": ("polynomial", "hyperbola"),
    "spindle_curve_polynomial": ("polynomial",),
    "spindle_curve_hyperbola": ("hyperbola",),
    "spindle_curve_asynchronous": ("asynchronous",),
    "spindle_curve_above_nominal": ("asynchronous",),
}
LIMIT, CONSTANT = 12_000.0, 16_000.0
A_MAX, N1, N2 = 16_000.0, 10_000.0, 20_000.0
FLOORS = {"polynomial": 2000.0, "hyperbola": 1400.0, "asynchronous": 4000.0}


def law(kind, n):
    """a(n) with the coefficients that pages 44, 46 and 49 print, without floor."""
    d, x = n - LIMIT, n / LIMIT
    if kind == "polynomial":
        above = -1.92901234e-10 * d**3 + 2.08333333e-5 * d**2 - 0.88888888 * d + CONSTANT
        return np.where(n < LIMIT, CONSTANT, above)
    if kind == "hyperbola":
        return np.where(n < LIMIT, CONSTANT, 2.285714e4 / (1.0 + 4.166666e-1 * x**2 * (1.0 + 2.857142e-2 * x**2)))
    return np.where(n < N1, A_MAX, A_MAX * N1 / n * np.where(n < N2, 1.0, N2 / n))


def closed_form(kind, n):
    return np.maximum(law(kind, np.maximum(n, 1.0)), FLOORS[kind])


def table(name, kind, leg):
    return measured(run_of(name), kind, leg)


@pytest.mark.parametrize(("name", "kind"), [(name, kind) for name, kinds in FIGURES.items() for kind in kinds])
def test_every_cycle_accelerates_as_the_closed_form_says(name, kind):
    """To 1e-9 relative, up and down; cycles at a corner may count to either side of it."""
    for leg in (RUN_UP, BRAKING):
        speed, acceleration = table(name, kind, leg)
        assert len(speed) > 8000
        assert acceleration == pytest.approx(closed_form(kind, speed), rel=1e-9)
        assert speed[0] < 16.0 and speed[-1] > TOP - 16.0


@pytest.mark.parametrize("kind", FLOORS)
def test_speeds_are_the_integral_of_the_closed_form(kind):
    """Time from one drawn speed to the next is ∫ dn / a(n), by Gauss-Legendre between the corners of the curve."""
    name = next(name for name, kinds in FIGURES.items() if kind in kinds)
    speed, _ = table(name, kind, RUN_UP)
    corners = {
        "polynomial": [LIMIT],
        "hyperbola": [LIMIT],
        "asynchronous": [N1, N2, math.sqrt(A_MAX * N1 * N2 / 4000.0)],
    }
    floor = {"polynomial": 36_000.0 + LIMIT, "hyperbola": math.inf, "asynchronous": math.inf}[kind]
    places, weights = np.polynomial.legendre.leggauss(8)
    clear = np.ones(len(speed) - 1, dtype=bool)
    for corner in (*corners[kind], floor):
        clear &= ~((speed[:-1] <= corner + 1.0) & (corner - 1.0 <= speed[1:]))
    half, middle = 0.5 * np.diff(speed)[clear], 0.5 * (speed[:-1] + speed[1:])[clear]
    nodes = middle[:, np.newaxis] + half[:, np.newaxis] * places
    durations = half * (weights / closed_form(kind, nodes)).sum(axis=1)
    assert clear.sum() > 8000
    assert durations == pytest.approx(CYCLE_TIME, rel=1e-8)  # the difference of speeds has lost a digit or two


def at(name, kind, speed):
    """The acceleration of the run at a speed, between two cycles."""
    speeds, accelerations = table(name, kind, RUN_UP)
    return float(np.interp(speed, speeds, accelerations))


def test_figures_16_to_18_show_the_interpolation_points_of_the_polynomial():
    for name in ("spindle_curve_shapes", "spindle_curve_points", "spindle_curve_polynomial"):
        for speed, printed in ((12_000.0, 16_000.0), (24_000.0, 8000.0), (36_000.0, 4000.0), (48_000.0, 2000.0)):
            assert at(name, "polynomial", speed) == pytest.approx(printed, rel=1e-4)
        assert at(name, "polynomial", 52_000.0) == 2000.0  # the law alone has 1432


def test_figures_15_to_19_show_the_interpolation_points_of_the_hyperbola():
    """The fourth point, 2000, is not on it: 6400/3."""
    for name in ("spindle_curve", "spindle_curve_shapes", "spindle_curve_points", "spindle_curve_hyperbola"):
        for speed, value in ((12_000.0, 16_000.0), (24_000.0, 8000.0), (36_000.0, 4000.0), (48_000.0, 6400.0 / 3.0)):
            assert at(name, "hyperbola", speed) == pytest.approx(value, rel=1e-4)


def test_figures_20_and_21_show_the_asynchronous_drive():
    """a_max to N1, half of it at N2, the floor from √(a_max·N1·N2/a_min) on."""
    for name in ("spindle_curve_asynchronous", "spindle_curve_above_nominal"):
        for speed, value in ((9000.0, 16_000.0), (16_000.0, 10_000.0), (20_000.0, 8000.0), (25_000.0, 5120.0)):
            assert at(name, "asynchronous", speed) == pytest.approx(value, rel=1e-4)
        speeds, accelerations = table(name, "asynchronous", RUN_UP)
        assert speeds[accelerations == 4000.0][0] == pytest.approx(28_284.27, abs=4.1)


# ---------------------------------------------------------------- what is in the pictures


def picture(name):
    """The drawing of a figure, and its texts."""
    figure = read_head(SCENARIOS / f"{name}.yaml")
    drawing = draw(figure, run_of(name))
    return drawing, texts_of(svg_text(drawing, title=figure.title))


@pytest.mark.parametrize(
    ("name", "begin", "end", "texts"),
    [
        ("spindle_curve", 0.0, TOP, {"n_limit 12000", "a_const 16000", "a_min 1400", "speed n in deg/s"}),
        ("spindle_curve_points", 0.0, TOP, {"a(n1) = 16000", "a(n2) = 8000", "a(n3) = 4000", "a(n4) = 2000"}),
        ("spindle_curve_polynomial", 0.0, TOP - LIMIT, {"a(n4) = 2000", "a_min 2000", "speed above the limit n − n_limit in deg/s"}),
        ("spindle_curve_hyperbola", 1.0, TOP / LIMIT, {"a(n3) = 4000", "a_min 1400", "relative speed n / n_limit"}),
        ("spindle_curve_asynchronous", 0.0, TOP, {"N1 10000", "N2 20000", "a_max 16000", "a_max · N1/n", "a_max · N1·N2/n²", "a_min 4000"}),
        ("spindle_curve_above_nominal", 0.0, TOP - N1, {"a_max · N1/n", "a_max · N1·N2/n²", "a_min 4000"}),
    ],
)  # fmt: skip
def test_scales_and_words(name, begin, end, texts):
    drawing, shown = picture(name)
    assert texts <= set(shown)
    assert {"run-up", "braking", "law"} <= set(shown)
    (plot, *_) = drawing.axes
    assert plot.get_xlim()[0] == begin
    lines = [line.get_xdata() for line in plot.lines if len(line.get_xdata()) > 100]
    assert max(np.max(x) for x in lines) == pytest.approx(end, rel=1e-3)


def test_captions_keep_their_digits():
    caption = " ".join(picture("spindle_curve_polynomial")[1]).replace("\u00a0", " ")
    assert "b1 = −0.88888888 1/s, b2 = 2.08333333E-5 1/deg, b3 = −1.92901234E-10 s/deg²" in caption


def test_several_spindles_stand_side_by_side():
    drawing, texts = picture("spindle_curve_shapes")
    left, right = (plot.get_position() for plot in drawing.axes)
    assert left.x1 < right.x0 and left.width == pytest.approx(right.width)
    assert {"polynomial, acceleration a in deg/s²", "hyperbola, acceleration a in deg/s²"} <= set(texts)
    assert texts.count("law") == 1


def test_drawn_cycles_are_thinned_with_both_ends():
    speed = np.arange(0.0, 1000.0, 8.0)
    shown = thinned(speed)
    assert (shown[0], shown[-1], len(shown)) == (0, 124, 26)
    assert np.diff(speed[shown]).max() <= 48.0


# ---------------------------------------------------------------- heads that make no picture

START = "- {at: 0.05, to: hyperbola, do: start, direction: ccw, speed_rpm: 100}\n- {at: 0.3, to: hyperbola, do: stop}\n"


def written(folder, scenario=START, **head):
    whole = {
        "title": "t",
        "caption": "c",
        "machine": "config/spindle_curves.yaml",
        "axes": "hyperbola",
        "kind": "spindle_curve",
    }
    return head_and_scenario(folder, {**whole, **head}, scenario)


def test_turning_counterclockwise_is_the_same_curve(tmp_path):
    run = run_figure(read_head(written(tmp_path)))
    for leg in (RUN_UP, BRAKING):
        speed, acceleration = measured(run, "hyperbola", leg)
        assert set(acceleration) == {16_000.0}
        assert speed.max() == pytest.approx(600.0, abs=16.0)


@pytest.mark.parametrize(
    ("head", "scenario", "reason"),
    [
        ({"over": "time"}, START, "'over: time' in the head is not one of n, n - n_limit, n / n_limit"),
        ({"points": "12000"}, START, "P-ERR-27041 point '12000': it is not SPEED:ACCELERATION, two numbers; nothing was fitted"),
        ({}, "[]\n", "spindle 'hyperbola' never accelerates"),
        ({"axes": "s", "machine": "config/mill.yaml"}, "[]\n", "'s' has no acceleration curve (P-AXIS-00202)"),
        ({"axes": "x", "machine": "config/mill.yaml"}, "[]\n", "'x' has no acceleration curve (P-AXIS-00202)"),
    ],
)  # fmt: skip
def test_heads_that_make_no_picture(tmp_path, head, scenario, reason):
    figure = read_head(written(tmp_path, scenario, **head))
    run = run_figure(figure)
    with pytest.raises(FigureError) as caught:
        draw(figure, run)
    assert str(caught.value) == f"figure move.yaml: {reason}; no picture was drawn"
