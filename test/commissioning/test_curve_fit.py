"""Acceleration curves from points: the manual's numbers, exact rational arithmetic, SciPy, and curves that are refused."""

from __future__ import annotations

import random
from decimal import ROUND_DOWN, Decimal
from fractions import Fraction

import numpy as np
import pytest
from long_support import examples
from scipy.optimize import minimize

from cnc_ptp.commissioning.curve_fit import curve_fault, fit_curve
from cnc_ptp.commissioning.curve_points import CurvePoint, parse_point, parse_point_file
from cnc_ptp.errors import CncError

PAGE_44 = [
    CurvePoint(12_000.0, 16_000.0),
    CurvePoint(24_000.0, 8000.0),
    CurvePoint(36_000.0, 4000.0),
    CurvePoint(48_000.0, 2000.0),
]
EXPONENTS = {"polynomial": (1, 2, 3), "hyperbola": (2, 4)}


def coefficients(fit):
    return fit.parameters.b1, fit.parameters.b2, fit.parameters.b3


def law(kind, limit, b, speed):
    """Page 42, above the limit."""
    d, x = speed - limit.speed, speed / limit.speed
    if kind == "polynomial":
        return b[2] * d**3 + b[1] * d**2 + b[0] * d + limit.acceleration
    return b[0] / (1 + b[1] * x**2 * (1 + b[2] * x**2))


# ---------------------------------------------------------------- the manual


@pytest.mark.parametrize(
    ("kind", "points", "printed"),
    [
        ("polynomial", PAGE_44, ("-0.88888888", "2.08333333E-5", "-1.92901234E-10")),
        ("hyperbola", PAGE_44[:3], ("2.285714E4", "4.166666E-1", "2.857142E-2")),
    ],
)
def test_printed_coefficients_of_the_manual(kind, points, printed):
    """Pages 44 and 46, to the last digit; the manual cuts digits off and does not round."""
    fit = fit_curve(kind, points)
    for value, text in zip(coefficients(fit), printed, strict=True):
        step = Decimal(text).as_tuple().exponent
        assert Decimal(value).quantize(Decimal((0, (1,), step)), rounding=ROUND_DOWN) == Decimal(text)
    assert fit.exact
    assert curve_fault(fit) is None
    assert (fit.parameters.limit_speed, fit.parameters.constant) == (12_000.0, 16_000.0)


def test_the_fourth_point_of_the_manual_does_not_lie_on_its_hyperbola():
    """It gives 2133.3 at 48000 °/s; four points together are a least squares fit."""
    assert fit_curve("hyperbola", PAGE_44[:3]).law.acceleration(48_000.0) == pytest.approx(6400.0 / 3.0, rel=1e-12)
    four = fit_curve("hyperbola", PAGE_44)
    assert not four.exact
    assert 20.0 < max(map(abs, four.misses())) < 133.0
    assert four.misses()[0] == 0.0


# ---------------------------------------------------------------- exact fits against rational arithmetic


def exact_coefficients(kind, points):
    """b1 … b3 by Cramer's rule in whole fractions: no digit is lost."""
    limit, *above = [(Fraction(p.speed), Fraction(p.acceleration)) for p in points]
    if kind == "polynomial":
        rows = [[(n - limit[0]) ** k for k in (1, 2, 3)] for n, _ in above]
        return solve(rows, [a - limit[1] for _, a in above])
    rows = [[(n / limit[0]) ** k for k in (0, 2, 4)] for n, _ in (limit, *above)]
    c0, c1, c2 = solve(rows, [1 / a for _, a in (limit, *above)])
    return 1 / c0, c1 / c0, c2 / c1


def determinant(rows):
    (a, b, c), (d, e, f), (g, h, i) = rows
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def solve(rows, right):
    whole = determinant(rows)
    replaced = ([[*row[:k], value, *row[k + 1 :]] for row, value in zip(rows, right, strict=True)] for k in range(3))
    return tuple(determinant(system) / whole for system in replaced)


def drawn_points(draw, count):
    """Falling points like those of a motor: between 1/n and 1/n² each."""
    points = [CurvePoint(float(draw.randint(1000, 20_000)), float(draw.randint(2000, 50_000)))]
    for _ in range(count):
        ratio = draw.uniform(1.2, 1.8)
        last = points[-1]
        points.append(CurvePoint(last.speed * ratio, last.acceleration * ratio ** -draw.uniform(1.0, 2.0)))
    return points


@pytest.mark.parametrize(("kind", "above"), [("polynomial", 3), ("hyperbola", 2)])
def test_random_points_against_rational_arithmetic(kind, above):
    draw, fitted = random.Random(18), 0
    while fitted < 300:
        points = drawn_points(draw, above)
        expected = exact_coefficients(kind, points)
        if kind == "hyperbola" and (expected[0] <= 0 or abs(expected[2]) > 1e3):
            continue
        fit = fit_curve(kind, points)
        assert coefficients(fit) == pytest.approx([float(value) for value in expected], rel=1e-9)
        assert fit.exact and max(map(abs, fit.misses())) < 1e-7
        fitted += 1


@pytest.mark.parametrize("more", [0, 4])
@pytest.mark.parametrize("kind", ["polynomial", "hyperbola"])
def test_round_trip_of_random_coefficients(kind, more):
    """Points on a curve give the curve back, also when there are more of them than unknowns."""
    draw = random.Random(19)
    for _ in range(100):
        limit = CurvePoint(float(draw.randint(1000, 20_000)), float(draw.randint(2000, 50_000)))
        if kind == "polynomial":
            end, rates = 4.0 * limit.speed, [draw.uniform(-0.4, -0.1), draw.uniform(-0.2, 0.2), draw.uniform(-0.1, 0.1)]
            b = [rate * limit.acceleration / end**k for k, rate in enumerate(rates, start=1)]
        else:
            d1, d2 = draw.uniform(0.05, 0.6), draw.uniform(0.001, 0.1)
            b = [limit.acceleration / (1 - d1 - d2), d1 / (1 - d1 - d2), d2 / d1]
        needed = {"polynomial": 3, "hyperbola": 2}[kind] + more
        speeds = sorted(limit.speed * draw.uniform(1.2, 5.0) for _ in range(needed))
        points = [limit, *(CurvePoint(n, law(kind, limit, b, n)) for n in speeds)]
        if min(np.diff([point.speed for point in points])) < 0.1 * limit.speed:
            continue
        fit = fit_curve(kind, points)
        assert coefficients(fit) == pytest.approx(b, rel=1e-6, abs=1e-9 * abs(b[0]) / limit.speed**2)
        assert max(map(abs, fit.misses())) < 1e-6
        assert fit.exact == (more == 0)


# ---------------------------------------------------------------- least squares


@pytest.mark.parametrize("kind", ["polynomial", "hyperbola"])
def test_least_squares_against_a_minimiser_of_scipy(kind):
    """Nelder-Mead from the same points: no better sum of squares, and the same curve."""
    draw = random.Random(20)
    limit = CurvePoint(12_000.0, 16_000.0)
    speeds = np.linspace(15_000.0, 48_000.0, 12)
    noisy = [16_000.0 * (12_000.0 / n) ** 1.4 * (1.0 + draw.uniform(-0.03, 0.03)) for n in speeds]
    fit = fit_curve(kind, [limit, *map(CurvePoint, speeds, noisy)])
    own = coefficients(fit)
    scale = np.array(own)

    def squares(part):
        b = np.array([*part, 0.0])[:3] * scale
        if kind == "hyperbola":  # through the limit point: b1 = a_konst·(1 + b2·(1 + b3))
            b = [limit.acceleration * (1.0 + part[0] * scale[1] * (1.0 + part[1] * scale[2])), *(part * scale[1:])]
        return sum((law(kind, limit, b, n) - a) ** 2 for n, a in zip(speeds, noisy, strict=True)) / 1e6

    start = np.full(3 if kind == "polynomial" else 2, 0.9)
    best = minimize(squares, start, method="Nelder-Mead", options={"maxiter": 20_000, "xatol": 1e-10, "fatol": 1e-14})
    assert best.success
    assert best.x == pytest.approx(np.ones(len(start)), rel=1e-5)
    assert sum(miss**2 for miss in fit.misses()) / 1e6 <= best.fun * (1.0 + 1e-12)


def test_points_below_the_limit_are_not_fitted():
    low = [CurvePoint(0.0, 16_000.0), CurvePoint(6000.0, 15_900.0)]
    fit = fit_curve("polynomial", [*low, *PAGE_44], limit_speed=12_000.0)
    assert coefficients(fit) == coefficients(fit_curve("polynomial", PAGE_44))
    assert (fit.exact, fit.limit_index) == (True, 2)
    assert fit.misses()[:2] == [0.0, 100.0]


def test_the_limit_point_is_what_the_parameters_can_hold():
    """P-AXIS-00130 counts 0.001 °/s, P-AXIS-00007 whole °/s²."""
    fit = fit_curve("polynomial", [CurvePoint(12_000.00049, 16_000.4), *PAGE_44[1:]])
    assert (fit.parameters.limit_speed, fit.parameters.constant) == (12_000.0, 16_000.0)
    assert fit.misses()[0] == pytest.approx(-0.4, abs=1e-3)


def test_constant_points_are_a_constant_curve():
    flat = [point._replace(acceleration=500.0) for point in PAGE_44]
    for kind in ("polynomial", "hyperbola"):
        fit = fit_curve(kind, flat)
        assert fit.misses() == pytest.approx([0.0] * 4, abs=1e-9)
        assert curve_fault(fit) is None


# ---------------------------------------------------------------- curves that no spindle can run on


def fault(kind, *points, **options):
    return str(curve_fault(fit_curve(kind, [CurvePoint(*point) for point in points], **options)))


def test_pole_of_a_hyperbola():
    """Points that rise bend the denominator down: 1.05 - 0.05·x², 0 at x = √21."""
    texts = [float(1.0 / (1.05 - 0.05 * x * x)) for x in (1.0, 2.0, 3.0)]
    points = [(1000.0 * x, 800.0 * a) for x, a in zip((1.0, 2.0, 3.0), texts, strict=True)]
    assert fault("hyperbola", *points, top_speed=5000.0) == (
        "P-ERR-27049 the hyperbola has a pole at 4582.58 °/s, below the largest speed 5000 °/s; no lines for the machine "
        "file were made"
    )


def test_pole_between_two_points():
    """a_konst/a = 1 at x = 1, 2 at 2 and 0.2 … : the denominator dips below 0 and comes back before the last point."""
    denominator = np.polynomial.Polynomial([6.0, -6.5, 1.5])  # 1 at 1, roots between 1.33 and 3
    points = [(1000.0 * s**0.5, 1000.0 / denominator(s)) for s in (1.0, 3.4, 4.0)]
    text = fault("hyperbola", *points)
    root = 1000.0 * float(min(denominator.roots())) ** 0.5
    assert text.startswith(f"P-ERR-27049 the hyperbola has a pole at {root:g} °/s, below the largest speed 2000 °/s; ")


def test_polynomial_that_comes_to_nothing():
    """16 - 8·u - 2·u² comes to -16 beyond the last point; a floor makes it a curve."""
    points = [(1000.0 * (1.0 + u), 1600.0 - 800.0 * u - 200.0 * u * u) for u in (0.0, 0.5, 1.0, 1.5)]
    assert fault("polynomial", *points, top_speed=3000.0) == (
        "P-ERR-27048 the polynomial falls to -800 °/s² at 3000 °/s, acceleration must be above 0 (a_min, P-AXIS-00010, is "
        "a floor); no lines for the machine file were made"
    )
    assert fault("polynomial", *points, top_speed=3000.0, minimum=50.0) == "None"


def test_polynomial_that_swings_between_its_points():
    """1000 - 1200·v + 800·v², least at v = 3/4."""
    points = [(1000.0 * (1.0 + v), 1000.0 - 1200.0 * v + 800.0 * v * v) for v in (0.0, 0.25, 0.5, 1.0)]
    assert fault("polynomial", *points) == (
        "P-ERR-27050 the polynomial rises from 550 °/s² at 1750 °/s to 600 °/s² at 2000 °/s, it must fall; no lines for "
        "the machine file were made"
    )
    assert fault("polynomial", *points, minimum=600.0) == "None"
    assert fault("polynomial", *points, top_speed=1750.0) == "None"


@pytest.mark.parametrize("kind", ["polynomial", "hyperbola"])
def test_turns_are_those_of_a_fine_grid(kind):
    """Where the sign of the slope changes, against 200001 places."""
    draw, seen = random.Random(21), 0
    for _ in range(examples(200)):
        points = [CurvePoint(1000.0 * k, draw.uniform(500.0, 1500.0)) for k in (1, 2, 3, 4)]
        try:
            fit = fit_curve(kind, points if kind == "polynomial" else points[:3], top_speed=4500.0)
        except CncError:
            continue
        grid = np.linspace(1000.0, 4500.0, 200_001)
        b, limit = coefficients(fit), CurvePoint(1000.0, fit.parameters.constant)
        slopes = np.sign(np.diff(law(kind, limit, b, grid) if kind == "polynomial" else 1 / law(kind, limit, b, grid)))
        found = grid[1:-1][slopes[1:] * slopes[:-1] < 0]
        assert fit.turns() == pytest.approx([1000.0, *found, 4500.0], abs=0.02)
        seen += len(found)
    assert seen > examples(30)


# ---------------------------------------------------------------- refused points


def refusal(call, *arguments, **options):
    with pytest.raises(CncError) as caught:
        call(*arguments, **options)
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "unit", "reason"),
    [
        ("12000", "deg/s", "it is not SPEED:ACCELERATION, two numbers"),
        ("12000;16000", "deg/s", "it is not SPEED:ACCELERATION, two numbers"),
        ("a:16000", "deg/s", "it is not SPEED:ACCELERATION, two numbers"),
        ("-1:16000", "deg/s", "speed -1 deg/s is not within 0 ... 2e+06 deg/s"),
        ("nan:16000", "rpm", "speed nan rpm is not within 0 ... 333333 rpm"),
        ("400000:16000", "rpm", "speed 400000 rpm is not within 0 ... 333333 rpm"),
        ("12000:0", "deg/s", "acceleration 0 °/s² is not above 0 and up to 1e+08"),
        ("12000:inf", "deg/s", "acceleration inf °/s² is not above 0 and up to 1e+08"),
    ],
)
def test_points_that_are_none(text, unit, reason):
    assert refusal(parse_point, text, unit) == f"P-ERR-27041 point '{text}': {reason}; nothing was fitted"


def test_a_point_in_rpm():
    assert parse_point("2000:16000", "rpm") == CurvePoint(12_000.0, 16_000.0)


def test_point_files_name_their_unit():
    rpm = "remark, acceleration_deg_s2, speed_rpm\nlimit, 16000, 2000\n\n, 8000, 4000\n"
    degrees = "speed_deg_s,acceleration_deg_s2\n12000,16000\n24000,8000\n"
    assert parse_point_file(rpm, "a.csv") == parse_point_file(degrees, "b.csv") == PAGE_44[:2]


HEAD = "1: the first line must name acceleration_deg_s2 and one of speed_deg_s, speed_rpm, separated by commas; it is "


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", f"{HEAD}''"),
        ("speed,acceleration_deg_s2\n1,2\n", f"{HEAD}'speed, acceleration_deg_s2'"),
        ("speed_rpm\n1\n", f"{HEAD}'speed_rpm'"),
        ("speed_rpm;acceleration_deg_s2\n1;2\n", f"{HEAD}'speed_rpm;acceleration_deg_s2'"),
        ("speed_rpm,speed_deg_s,acceleration_deg_s2\n1,6,2\n", f"{HEAD}'speed_rpm, speed_deg_s, acceleration_deg_s2'"),
        ("speed_rpm,acceleration_deg_s2,speed_rpm\n1,2,1\n", f"{HEAD}'speed_rpm, acceleration_deg_s2, speed_rpm'"),
        ("n" * 200, f"{HEAD}'{'n' * 100}'"),
        ("speed_rpm,acceleration_deg_s2\n1,2\n2\n", "3: '2' has 1 values instead of 2"),
        ("speed_rpm,acceleration_deg_s2\n1,x\n", "2: speed_rpm '1' and acceleration_deg_s2 'x' are not two numbers"),
        ("acceleration_deg_s2,speed_deg_s\n,\n8,\"1,5\"\n", "3: speed_deg_s '1,5' and acceleration_deg_s2 '8' are not two numbers"),
        ("speed_rpm,acceleration_deg_s2\n1,-2\n", "2: acceleration -2 °/s² is not above 0 and up to 1e+08"),
    ],
)  # fmt: skip
def test_point_files_that_are_none(text, reason):
    assert refusal(parse_point_file, text, "p.csv") == f"P-ERR-27042 point file p.csv:{reason}; nothing was fitted"


def test_the_line_of_a_point_file_from_which_on_the_speeds_do_not_ascend():
    text = "acceleration_deg_s2,speed_rpm\n16000,2000\n\n8000,1000\n4000,500\n"
    assert refusal(parse_point_file, text, "p.csv") == (
        "P-ERR-27043 point file p.csv:4: point 6000:8000 comes after 12000:16000 (°/s:°/s²), speeds must ascend; nothing "
        "was fitted"
    )


def test_columns_of_other_names_are_no_speeds():
    text = "note speed_rpm,speed_deg_s,acceleration_deg_s2\n7,12000,16000\n"
    assert parse_point_file(text, "p.csv") == PAGE_44[:1]


@pytest.mark.parametrize(
    ("kind", "points", "options", "text"),
    [
        ("polynomial", PAGE_44[::-1], {}, "P-ERR-27043 point 36000:4000 comes after 48000:2000 (°/s:°/s²), speeds must ascend; nothing was fitted"),
        ("polynomial", [PAGE_44[0], *PAGE_44], {}, "P-ERR-27043 point 12000:16000 comes after 12000:16000 (°/s:°/s²), speeds must ascend; nothing was fitted"),
        ("polynomial", [], {}, "P-ERR-27044 the polynomial needs a point at the limit speed and 3 above it, 0 above it given; nothing was fitted"),
        ("polynomial", PAGE_44[:3], {}, "P-ERR-27044 the polynomial needs a point at the limit speed and 3 above it, 2 above it given; nothing was fitted"),
        ("hyperbola", PAGE_44[:2], {}, "P-ERR-27044 the hyperbola needs a point at the limit speed and 2 above it, 1 above it given; nothing was fitted"),
        ("hyperbola", PAGE_44, {"limit_speed": 36_000.0}, "P-ERR-27044 the hyperbola needs a point at the limit speed and 2 above it, 1 above it given; nothing was fitted"),
        ("polynomial", PAGE_44, {"limit_speed": 13_000.0}, "P-ERR-27045 no point lies at the limit speed 13000 °/s, which gives a_konst (P-AXIS-00007); nothing was fitted. Points at 12000, 24000, 36000, 48000 °/s"),
        ("polynomial", [CurvePoint(0.0, 17_000.0), *PAGE_44], {}, "P-ERR-27045 the limit speed 0 °/s (P-AXIS-00130) must be above 0; nothing was fitted. It is the first point, or --limit"),
        ("polynomial", PAGE_44, {"top_speed": 12_000.0}, "P-ERR-27046 the largest speed 12000 °/s is not above the limit speed 12000 °/s and up to 2e+06 °/s; nothing was fitted"),
        ("polynomial", PAGE_44, {"top_speed": float("nan")}, "P-ERR-27046 the largest speed nan °/s is not above the limit speed 12000 °/s and up to 2e+06 °/s; nothing was fitted"),
        ("polynomial", PAGE_44, {"minimum": 16_001.0}, "P-ERR-27046 a_min 16001 °/s² (P-AXIS-00010) is above a_konst 16000 °/s²; nothing was fitted"),
        ("hyperbola", [CurvePoint(1.0, 0.4), CurvePoint(2.0, 0.3), CurvePoint(3.0, 0.2)], {}, "P-ERR-27046 a_konst 0.4 °/s² is 0 in whole °/s² (P-AXIS-00007); nothing was fitted"),
    ],
)  # fmt: skip
def test_points_that_make_no_curve(kind, points, options, text):
    assert refusal(fit_curve, kind, points, **options) == text


def test_points_that_fall_too_steeply_for_a_hyperbola():
    """1/n³: x³ = -32/45 + 14/9·x² + 7/45·x⁴ at x = 1, 2, 4."""
    points = [CurvePoint(1000.0 * x, 8000.0 / x**3) for x in (1.0, 2.0, 4.0)]
    assert refusal(fit_curve, "hyperbola", points) == (
        "P-ERR-27047 no hyperbola: the points ask for a_konst/a = -0.7111 +1.556·x² +0.1556·x⁴ with x = n/n_grenz, but "
        "the first must be above 0 (b1) and the second not 0 (b2); nothing was fitted, a polynomial can be"
    )
