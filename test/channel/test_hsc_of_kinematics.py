"""#HSC on the face and on the cylinder: short lines become a smooth curve there, too."""

from __future__ import annotations

from cmath import exp
from itertools import pairwise
from math import cos, pi, radians, sin

import numpy as np
import pytest
import shapely
from c_axis_support import assert_within_limits, face_path, run
from machine_support import MachineBench
from shapely import LineString, Point

DEV = 0.005
RADIUS = 30.0
CHORDS = 2000
CHORD = 0.05


def wave(count: int = CHORDS) -> list[tuple[float, float]]:
    """Points with the distance of a chord on a wave: z along it, y across, so smooth that the feed is possible."""
    points, z = [(0.0, 0.0)], 0.0
    while len(points) <= count:
        slope = 2.0 * pi / 50.0 * 5.0 * cos(2.0 * pi * z / 50.0)
        z += CHORD / (1.0 + slope * slope) ** 0.5
        points.append((z, 5.0 * sin(2.0 * pi * z / 50.0)))
    return points


def blocks(points: list[tuple[float, float]], first: str, second: str, feed: float = 6000.0) -> str:
    lines = "\n".join(f"{first}{200.0 + a:.6f} {second}{b:.6f}" for a, b in points[1:])
    return f"#HSC ON [BSPLINE PATH_DEV={DEV}]\nG01 F{feed:g}\n{lines}\n#HSC OFF\n"


def on_cylinder(text: str) -> str:
    return f"#CAX\nG00 X30 C0 Z200\n#CYL [Z, C, X{RADIUS}]\n{text}#CYL OFF\n#CAX OFF\nM30\n"


def cutting_time(bench: MachineBench) -> int:
    """Cycles with the feed of the program."""
    feeds, speeds = (np.array(bench.column("channel", name)) for name in ("programmed_feed", "path_velocity"))
    return np.count_nonzero((np.abs(feeds - 100.0) <= 1e-4) & (speeds > 0.0))


@pytest.mark.long
def test_chords_on_the_cylinder_take_the_time_of_the_plane() -> None:
    """And the smooth curve is within the deviation of them, with the limits of the axes."""
    points = wave()
    bench = run(on_cylinder(blocks(points, "Z", "C")))
    assert bench.events == []
    assert_within_limits(bench)
    plane = run(f"G00 X100 Z200\nG92 X100\n{blocks(points, 'Z', 'X')}M30\n")
    assert plane.events == []
    assert cutting_time(bench) <= 1.05 * cutting_time(plane)
    chords = LineString([(200.0 + z, y) for z, y in points])
    z, angle = bench.column("z", "set_position"), bench.column("s", "set_position_deg")
    moving = [(a, radians(b) * RADIUS) for a, b in zip(z, angle, strict=True)][z.index(200.0) :]
    assert len(moving) > 1000 and moving[-1] == pytest.approx((200.0 + points[-1][0], points[-1][1]), abs=1e-5)
    assert shapely.distance(chords, shapely.points(moving)).max() <= DEV * (1.0 + 1e-6)


def test_chords_past_the_centre_of_the_face() -> None:
    """A circle in chords that passes the centre at 0.05 mm: smooth where it may be, as it is near the centre."""
    centre, radius = 10.0 + 0.0j, 9.95
    points = [centre + radius * exp(2j * pi * n / 400) for n in range(401)]
    text = "\n".join(f"X{p.real:.6f} C{p.imag:.6f}" for p in points[1:])
    program = f"#CAX\nG00 X{points[0].real} C0\n#FACE [X, C]\n#HSC ON [BSPLINE PATH_DEV={DEV}]\nG01 F2000\n{text}\n"
    bench = run(f"{program}#HSC OFF\n#FACE OFF\n#CAX OFF\nM30\n")
    assert bench.events == []
    assert_within_limits(bench)
    chords = LineString([(p.real, p.imag) for p in points])
    path = face_path(bench)
    begin = next(index for index, p in enumerate(path) if abs(p - points[0]) < 1e-6)
    assert max(chords.distance(Point(p.real, p.imag)) for p in path[begin:]) <= DEV * (1.0 + 1e-6)
    assert sum(abs(b - a) for a, b in pairwise(path[begin:])) == pytest.approx(chords.length, rel=1e-3)
    assert bench.column("s", "set_position_deg")[-1] == pytest.approx(0.0, abs=1e-6)
