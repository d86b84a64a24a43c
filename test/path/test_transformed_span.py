"""Parts of a Cartesian path as the axes behind a kinematics see it: their bounds, and where there is no position."""

from __future__ import annotations

import random
from itertools import pairwise
from math import hypot

import pytest
from long_support import long

from cnc_ptp.errors import CncError
from cnc_ptp.kinematics.cylinder import Cylinder
from cnc_ptp.kinematics.face import Face
from cnc_ptp.kinematics.kinematics import Kinematics
from cnc_ptp.path.geometry import Arc, Line
from cnc_ptp.path.lookahead.spans import Span, whole
from cnc_ptp.path.transformed_span import divided, require_possible

XZC = (0, 1, 2)
ORIGIN = (3.0, 0.0, 20.0)
LATHE = Face(0, 2, ORIGIN, False)
MILL = Face(0, 2, ORIGIN, True)
CYLINDER = Cylinder(1, 2, 25.0, ORIGIN)
SAMPLES = 7


def line(*points: tuple[float, float]) -> Span:
    (x, y), (to_x, to_y) = points
    return whole(Line((x, 1.0, y), (to_x, 2.0, to_y), XZC), 0)


def arc(start: tuple[float, float], centre: tuple[float, float], sweep: float) -> Span:
    z = complex(*start) - complex(*centre)
    turned = complex(*centre) + z * 1j ** (sweep / 90.0)
    begin, end = (start[0], 1.0, start[1]), (turned.real, 1.5, turned.imag)
    return whole(Arc(begin, end, centre, (0, 2), hypot(z.real, z.imag), sweep, XZC), 0)


def start_of(span: Span, kinematics: Kinematics) -> tuple[float, ...]:
    return kinematics.inverse(tuple([q for q, _, _, _ in span.shape(0.0)]), ORIGIN)


def random_spans(seed: int) -> list[Span]:
    draw = random.Random(seed)
    lines = [line(*[(draw.uniform(-20, 20), draw.uniform(-20, 20)) for _ in range(2)]) for _ in range(20)]
    arcs = [
        arc(*[(draw.uniform(-20, 20), draw.uniform(-20, 20)) for _ in range(2)], draw.uniform(-350, 350))
        for _ in range(20)
    ]
    return lines + arcs


@pytest.mark.parametrize("kinematics", [LATHE, MILL, CYLINDER])
@pytest.mark.parametrize("seed", [0, *long([1, 2, 3])])
def test_bounds_hold_within_each_part(kinematics: Kinematics, seed: int) -> None:
    """Sampled: no derivative of an axis is beyond the bounds, which are at most some times too large."""
    for span in random_spans(seed):
        parts, _ = divided(span, kinematics, start_of(span, kinematics))
        assert sum(part.length for part in parts) == pytest.approx(span.length)
        for part in parts:
            half = 0.5 * part.length
            for begin, end in ((0.0, part.length), (0.0, half), (half, part.length)):
                bounds = part.bounds(begin, end)
                for n in range(SAMPLES):
                    shape = part.shape(begin + (end - begin) * n / (SAMPLES - 1))
                    for (_, *derivatives), largest in zip(shape, bounds, strict=True):
                        assert all(
                            abs(d) <= b * (1.0 + 1e-9) + 1e-12 for d, b in zip(derivatives, largest, strict=True)
                        )


@pytest.mark.parametrize("kinematics", [LATHE, MILL, CYLINDER])
def test_parts_continue_each_other(kinematics: Kinematics) -> None:
    for span in random_spans(9):
        parts, end = divided(span, kinematics, start_of(span, kinematics))
        assert [q for q, _, _, _ in parts[0].shape(0.0)] == pytest.approx(start_of(span, kinematics))
        for part, following in pairwise(parts):
            for one, other in zip(part.shape(part.length), following.shape(0.0), strict=True):
                assert one == pytest.approx(other, rel=1e-6, abs=1e-9)
        assert [q for q, _, _, _ in parts[-1].shape(parts[-1].length)] == pytest.approx(end)


def test_parts_are_short_near_the_centre_alone() -> None:
    span = line((20.0, 0.05), (-20.0, 0.05))
    lengths = [part.length for part in divided(span, LATHE, start_of(span, LATHE))[0]]
    assert min(lengths) < 0.02
    assert max(lengths) > 1.0
    assert len(lengths) < 150


def refusal(span: Span, kinematics: Kinematics, start: tuple[float, ...] | None = None) -> tuple[int, str]:
    with pytest.raises(CncError) as caught:
        require_possible(span, kinematics, start or start_of(span, kinematics))
    return caught.value.number, caught.value.message


def test_a_line_through_the_centre() -> None:
    span = line((20.0, 0.0), (-20.0, 0.0))
    require_possible(span, MILL, start_of(span, MILL))
    assert refusal(span, LATHE) == (
        22121,
        "the path of #FACE [X, C] goes through the centre of rotation, which X must not pass (P-CHAN-00008)",
    )


@pytest.mark.parametrize("kinematics", [LATHE, MILL])
def test_an_arc_through_the_centre(kinematics: Kinematics) -> None:
    assert refusal(arc((20.0, 0.0), (10.0, 0.0), 270.0), kinematics) == (
        22121,
        "the path of #FACE [X, C] comes to the centre of rotation, where the C axis has no angle",
    )


def test_a_line_from_the_centre_at_another_angle() -> None:
    assert refusal(line((0.0, 0.0), (0.0, 10.0)), LATHE, (3.0, 1.0, 20.0)) == (
        22122,
        "the path of #FACE [X, C] leaves the centre of rotation at an angle at which the C axis is not",
    )
    require_possible(line((0.0, 0.0), (0.0, 10.0)), LATHE, (3.0, 1.0, 110.0))
