"""Rotation, mirror, scale and #CS behind #FACE and #CYL act in the plane of their words; C counts as Y there."""

from __future__ import annotations

from cmath import exp, pi

import pytest
from nc_support import FACING, TABLES, run

from cnc_ptp.nc.canonical import CanonicalBlock, CircularMove

FACE, CYLINDER = "#FACE [X, C]", "#CYL [Z, C, X20]"
LATHE = ("X", "C", "Z")
TURNED = exp(1j * pi / 6.0)


def arc_of(command: str, change: str) -> tuple[CircularMove, complex, complex, complex]:
    """Arc from (20, 0) about the origin to (0, 20): start, target and centre in the plane."""
    first = command[command.index("[") + 1]
    text = f"#CAX\nG00 X30 Z30\n{command}\n{change}\nG01 {first}30 C30 F300\n{first}20 C0\nG03 {first}0 C20 I-20 J0\n"
    blocks: list[CanonicalBlock] = run(text, axes=LATHE, spindles=TABLES["c_axis"])
    line, arc = [block.motion for block in blocks if block.motion is not None][-2:]
    assert isinstance(arc, CircularMove)
    a, c = LATHE.index(first), LATHE.index("C")
    assert arc.plane == (a, c)
    return arc, complex(line.target[a], line.target[c]), complex(arc.target[a], arc.target[c]), complex(*arc.center)


@pytest.mark.parametrize("plane", ["G17", "G18", "G19"])
@pytest.mark.parametrize("command", [FACE, CYLINDER])
@pytest.mark.parametrize(
    ("change", "factor", "mirrored"),
    [
        ("#ROTATION ON [ANGLE=30]", TURNED, False),
        ("#SCALE ON {first}2 C2", 2.0, False),
        ("G21", 1.0, "first"),
        ("G22", 1.0, "second"),
        ("G23", -1.0, False),
    ],
)
def test_an_arc_in_changed_coordinates(
    command: str, change: str, factor: complex, mirrored: str | bool, plane: str
) -> None:
    first = command[command.index("[") + 1]
    arc, *points = arc_of(command, f"{plane}\n{change.format(first=first)}")
    expected = [20.0 * factor, 20.0j * factor, 0.0]
    if mirrored:
        sign = -1.0 if mirrored == "first" else 1.0
        expected = [sign * complex(point).conjugate() for point in expected]
    assert points == pytest.approx(expected, abs=1e-12)
    assert arc.radius == pytest.approx(abs(points[0]), abs=1e-12)
    assert arc.sweep == pytest.approx(-90.0 if mirrored else 90.0)


def test_a_coordinate_system_on_the_face_is_turned_about_its_normal() -> None:
    _, *points = arc_of(FACE, "#CS ON [5, 7, 0, 0, 0, 30]")
    assert points == pytest.approx([5 + 7j + 20.0 * TURNED, 5 + 7j + 20.0j * TURNED, 5 + 7j], abs=1e-12)


def test_rotation_about_a_centre_on_the_cylinder() -> None:
    _, *points = arc_of(CYLINDER, "#ROTATION ON [ANGLE=30 CENTER1=4 CENTER2=3]")
    centre = 4.0 + 3.0j
    assert points == pytest.approx([centre + (p - centre) * TURNED for p in (20.0, 20.0j, 0.0)], abs=1e-12)


def test_behind_the_face_the_plane_is_that_of_the_axes_again() -> None:
    text = f"G18\n#CAX\nG00 X30 Z30\n{FACE}\n#ROTATION ON [ANGLE=30]\n#FACE OFF\nG21 Z5\nX6\n"
    blocks = run(text, axes=LATHE, spindles=TABLES["c_axis"])
    assert [block.motion.target[2] for block in blocks if block.motion is not None][-1] == -5.0


def test_diameters_do_not_count_on_the_face() -> None:
    """Words of X are Cartesian there; on the cylinder X is an axis, so they do."""
    options = {"axes": LATHE, "spindles": TABLES["c_axis"], "turning": FACING["X"]}
    for command, x in ((FACE, 20.0), (CYLINDER, 10.0)):
        text = f"G18 G51\n#CAX\nG00 X60 Z30\n{command}\nG01 X20 F300\nM30"
        targets = [block.motion.target[0] for block in run(text, **options) if block.motion is not None]
        assert targets == [30.0, x]
