"""#FACE and #CYL: paths are Cartesian, the limits are those of the axes (TF5200 spindle 2.8.8)."""

from __future__ import annotations

import random
from cmath import exp
from itertools import pairwise
from math import degrees, radians

import numpy as np
import pytest
import shapely
from c_axis_support import (
    LATHE,
    assert_within_limits,
    errors,
    face_path,
    lathe,
    machine_path,
    on_path,
    run,
)
from long_support import long
from machine_support import MachineBench
from replay_support import bits, replay
from shapely import LinearRing, box

from cnc_ptp.kinematics.cylinder import Cylinder
from cnc_ptp.kinematics.face import Face
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

BEGIN = "#CAX\nG00 X20 C0\n#FACE [X, C]\n"
MICROMETRE = 1e-3
HEXAGON = [complex(20.0, 0.0), complex(10.0, 17.0), complex(-10.0, 17.0), complex(-20.0, 0.0), complex(-10.0, -17.0)]


def on_face(text: str) -> str:
    return f"{BEGIN}{text}\n#FACE OFF\n#CAX OFF\nM30\n"


def lines(points: list[complex]) -> str:
    return "\n".join(f"G01 X{point.real} C{point.imag} F2000" for point in points)


def distance(point: complex, corners: list[complex]) -> float:
    """From a polyline, mm."""
    found = []
    for begin, end in pairwise(corners):
        along = end - begin
        part = ((point - begin) * along.conjugate()).real / abs(along) ** 2
        found.append(abs(point - begin - along * min(1.0, max(0.0, part))))
    return min(found)


def of_face(bench: MachineBench, start: complex = 20.0 + 0.0j) -> list[complex]:
    """The path from the first point of the face on."""
    path = face_path(bench)
    begin = next(index for index, point in enumerate(path) if abs(point - start) < 0.5 * MICROMETRE)
    return path[begin:]


def test_lines_on_the_face() -> None:
    bench = run(on_face(lines(HEXAGON[1:] + HEXAGON[:1])))
    assert bench.events == []
    assert max(distance(point, [*HEXAGON, HEXAGON[0]]) for point in of_face(bench)) < MICROMETRE
    assert_within_limits(bench)
    assert bench.column("s", "set_position_deg")[-1] == pytest.approx(360.0)
    assert max(bench.column("channel", "path_velocity")[2000:]) == pytest.approx(2000.0 / 60.0)


def test_shows_cartesian_positions() -> None:
    bench = run(on_face("G01 X10 C10 F2000\nG04 0.5"))
    shown = [block.programmed_position for block in bench.blocks["channel"]]
    assert any(position == pytest.approx([10.0, 300.0, 10.0], abs=1e-9) for position in shown)
    systems = [offsets.systems for block in bench.blocks["channel"] for offsets in block.offsets]
    assert ["#FACE [X, C]"] in systems
    assert systems[-1] == []


def test_arcs_on_the_face() -> None:
    bench = run(on_face("G03 X0 C20 I-20 J0 F2000\nG02 X10 C10 I0 J-10"))
    path = of_face(bench)
    off = [min(abs(abs(p) - 20.0), abs(abs(p - 10j) - 10.0)) for p in path]
    assert max(off) < MICROMETRE
    assert_within_limits(bench)


def test_arc_around_the_centre_moves_the_spindle_alone() -> None:
    bench = run(on_face("G03 X20 C0 I-20 J0 F2000"))
    path = machine_path(bench)
    assert path[-1][1] == pytest.approx(360.0)
    assert all(x == pytest.approx(20.0, abs=1e-9) for x, _, _ in path[-500:])


@pytest.mark.parametrize("beside", [5.0, 0.05, 0.0005, *long([0.5, 0.005])])
def test_past_the_centre(beside: float) -> None:
    """The path slows down by itself."""
    bench = run(on_face(f"G01 C{beside} F2000\nX-20"))
    assert bench.events == []
    path = of_face(bench)
    assert max(distance(point, [20.0, 20.0 + beside * 1j, -20.0 + beside * 1j]) for point in path) < MICROMETRE
    assert min(map(abs, path)) == pytest.approx(beside, rel=0.05)
    assert_within_limits(bench)


@pytest.mark.parametrize("angle", [30.0, *long([0.0])])
def test_through_the_centre_on_a_milling_machine(angle: float) -> None:
    program = f"#CAX\nG00 X20 C{angle}\nG92 C{angle}\n#FACE [X, C]\nG01 X-20 F2000\nC10\nX20 C0\n#FACE OFF\nM30\n"
    bench = run(program, machine=lathe(face_kind=2))
    assert bench.events == []
    path = machine_path(bench)
    assert min(x for x, _, _ in path) < -20.0
    assert_within_limits(bench)


def test_through_the_centre_on_a_lathe() -> None:
    bench = run(on_face("G01 X-20 F2000"))
    assert errors(bench) == [
        "channel channel: test.nc line 4 column 1 'G01 X-20 F2000': the path of #FACE [X, C] goes through the centre of"
        " rotation, where the C axis has no angle (P-CHAN-00008); the path stands behind line 3 '#FACE [X, C]' and the"
        " program is aborted"
    ]


def test_to_the_centre_and_back() -> None:
    bench = run(on_face("G01 X0 F2000\nX15"))
    assert bench.events == []
    assert bench.position("x") == pytest.approx(15.0)


def test_leaving_the_centre_at_another_angle() -> None:
    bench = run(on_face("G01 X0 F2000\nC15"))
    assert errors(bench) == [
        "channel channel: the path of #FACE [X, C] leaves the centre of rotation at an angle at which the C axis is not"
        " in test.nc line 5 'C15'; the path stops on its ramp and the program is aborted"
    ]
    assert bench.position("x") == pytest.approx(0.0)


@pytest.mark.long
def test_leaving_the_centre_at_another_angle_on_a_milling_machine() -> None:
    bench = run(on_face("G01 X0 F20\nX-5 C-0.05\nX-10"), machine=lathe(face_kind=2))
    assert errors(bench) == [
        "channel channel: the path of #FACE [X, C] leaves the centre of rotation at an angle at which the C axis is not"
        " in test.nc line 5 'X-5 C-0.05'; the path stops on its ramp and the program is aborted"
    ]
    assert bench.position("x") == pytest.approx(0.0)


def test_contouring() -> None:
    program = on_face("#CONTOUR MODE [DEV PATH_DEV=0.02]\nG261\n" + lines(HEXAGON[1:] + HEXAGON[:1]))
    bench = run(program)
    assert bench.events == []
    assert max(distance(point, [*HEXAGON, HEXAGON[0]]) for point in of_face(bench)) < 0.02 + MICROMETRE
    velocity = bench.column("channel", "path_velocity")
    moving = [cycle for cycle, v in enumerate(velocity) if v and bench.column("channel", "line")[cycle] > 5]
    assert min(velocity[moving[100] : moving[-100]]) > 1.0
    assert_within_limits(bench)


@pytest.mark.long
def test_random_polygons() -> None:
    draw = random.Random(2788)
    for _ in range(4):
        points = [complex(draw.uniform(-25, 25), draw.uniform(-25, 25)) for _ in range(8)]
        bench = run(on_face(lines(points)))
        assert bench.events == []
        assert max(distance(point, [20.0 + 0.0j, *points]) for point in of_face(bench)) < MICROMETRE
        assert_within_limits(bench)


def test_radius_of_the_tool_on_the_face() -> None:
    """G41 around a hexagon with a rounded corner: the centre of the mill is 3 mm beside it, arcs at the corners."""
    text = "G41 G01 X16 C0 F2000\nX8 C-13.856\nX-8\nX-16 C0\nG02 X-8 C13.856 I16 J0\nG01 X8\nX16 C0\nG40 X24 C8"
    bench = run(on_face(f"G00 X24 C0\n{text}").replace("#CAX\n", "D8\n#CAX\n", 1))
    assert bench.events == []
    arc = [16.0 * exp(1j * radians(angle)) for angle in np.linspace(180.0, 120.0, 2001)]
    contour = [complex(16, 0), complex(8, -13.856), complex(-8, -13.856), *arc, complex(8, 13.856), complex(16, 0)]
    part = LinearRing([(point.real, point.imag) for point in contour])
    path = [point - 55.0 * point / abs(point) for point in face_path(bench)]  # the mill is 55 mm beside the turret
    lines = [line for block in bench.blocks["channel"] for line in block.line]
    beside = [point for point, cycle in zip(path, on_path(bench), strict=True) if 7 <= lines[cycle] <= 12]
    assert len(beside) > 2000
    away = shapely.distance(part, shapely.points([(point.real, point.imag) for point in beside]))
    assert abs(away - 3.0).max() < MICROMETRE
    assert_within_limits(bench)


def test_radius_of_the_tool_on_the_cylinder() -> None:
    """G42 within a window of 12 mm by 20 mm of arc on a cylinder of 30 mm: the mill stays 3 mm within it."""
    window = "Z2 C0\nC10\nZ14\nC-10\nZ2\nC0\nG40 Z8"
    text = f"D8\n#CAX\nG00 X40 C0 Z8\n#CYL [Z, C, X30]\nG42 G01 F2000 {window}\n#CYL OFF\n#CAX OFF\nM30\n"
    bench = run(text)
    assert bench.events == []
    length = radians(30.0)
    path = [(z - 84.0, angle * length) for _, angle, z in machine_path(bench)]
    lines = [line for block in bench.blocks["channel"] for line in block.line]
    inside = [point for point, cycle in zip(path, on_path(bench), strict=True) if 6 <= lines[cycle] <= 10]
    assert len(inside) > 1000
    away = shapely.distance(box(2.0, -10.0, 14.0, 10.0).exterior, shapely.points(inside))
    assert abs(away - 3.0).max() < MICROMETRE
    assert_within_limits(bench)


@pytest.mark.parametrize("at", [2.1, *long([1.7, 2.6])])
def test_feed_hold_and_override_keep_the_path(at: float) -> None:
    scenario = f"""- {{at: {at}, to: channel, do: feed_hold, enabled: true}}
- {{at: {at + 0.5}, to: channel, do: feed_hold, enabled: false}}
- {{at: {at + 0.7}, to: channel, do: set_override, percent: 50}}"""
    bench = run(on_face("G01 C0.5 F2000\nX-20\nX-15 C15"), scenario)
    assert C.HOLD in bench.states("channel")
    corners = [20.0, 20.0 + 0.5j, -20.0 + 0.5j, -15.0 + 15.0j]
    assert max(distance(point, corners) for point in of_face(bench)) < MICROMETRE
    assert_within_limits(bench)


def test_reset_on_the_face() -> None:
    bench = run(on_face("G01 C5 F2000\nX-20"), "- {at: 2.2, to: channel, do: reset}")
    assert max(distance(point, [20.0, 20.0 + 5j, -20.0 + 5j]) for point in of_face(bench)) < MICROMETRE
    assert bench.states("channel")[-1] in (C.READY, C.IDLE)
    assert_within_limits(bench)


def test_single_block_on_the_face() -> None:
    starts = "\n".join(f"- {{at: {2.0 + 2.0 * n}, to: channel, do: start}}" for n in range(6))
    scenario = f"- {{at: 0.0, to: channel, do: single_block, enabled: true}}\n{starts}"
    bench = run(f"{BEGIN}G01 C5 F2000\nX10\nC0\nM30\n", scenario)
    assert bench.events == []
    corners = [20.0, 20.0 + 5j, 10.0 + 5j, 10.0]
    assert max(distance(point, corners) for point in of_face(bench)) < MICROMETRE


def test_cylinder() -> None:
    bench = run("#CAX\nG00 X62 Z290 C0\n#CYL [Z, C, X60]\nG01 C30 F2000\nG03 Z280 C40 I0 J10\n#CYL OFF\nM30\n")
    assert bench.events == []
    cycles = len(on_path(bench))
    unrolled = [(z, angle * 60.0 / degrees(1.0)) for _, angle, z in machine_path(bench)][-cycles // 2 :]
    off = [
        min(abs(z - 290.0) if c <= 30.0 + 1e-9 else 1.0, abs(abs(complex(z - 290.0, c - 40.0)) - 10.0))
        for z, c in unrolled
    ]
    assert max(off) < MICROMETRE
    assert bench.column("s", "set_position_deg")[-1] == pytest.approx(40.0 / 60.0 * degrees(1.0))
    assert_within_limits(bench)


def test_from_the_face_to_the_cylinder() -> None:
    """The angle is that to which the path on the face has turned the spindle, with its whole turns."""
    bench = run(BEGIN + "G03 X20 C0 I-20 J0 F2000\n#CYL [Z, C, X20]\nG91 G01 C10\n#CYL OFF\nM30\n")
    assert bench.events == []
    assert bench.column("s", "set_position_deg")[-1] == pytest.approx(360.0 + 10.0 / 20.0 * degrees(1.0))


def test_zero_offset_of_c_turns_the_face() -> None:
    bench = run("#CAX\nG00 X20 C40\nG92 C40\n#FACE [X, C]\nG01 X10 F2000\n#FACE OFF\nG01 C10\nM30\n")
    assert bench.events == []
    assert bench.position("x") == 10.0
    assert bench.column("s", "set_position_deg")[-1] == pytest.approx(50.0)


def test_soft_limits_are_those_of_the_axes() -> None:
    bench = run(on_face("G01 X150 C150 F2000"))
    assert errors(bench) == [
        "channel channel: test.nc line 4 column 1 'G01 X150 C150 F2000': axis X: 212.132 mm lies beyond the positive soft"
        " limit 200 mm (P-AXIS-00178); the path stands behind line 3 '#FACE [X, C]' and the program is aborted"
    ]


def test_programmed_limits_are_those_of_the_axes() -> None:
    bench = run(f"G99 X30\n{BEGIN}G01 C30 F2000\nM30\n")
    assert errors(bench) == [
        "channel channel: test.nc line 5 column 1 'G01 C30 F2000': axis X: 36.0555 mm lies beyond the software limit 30 mm"
        " of G99; the path stands behind line 4 '#FACE [X, C]' and the program is aborted"
    ]


def test_slopes() -> None:
    bench = run(on_face("#SLOPE [TYPE=STEP]\nG01 C0.5 F2000\nX-20\n#SLOPE [TYPE=SIN2]\nG01 X20"))
    assert bench.events == []
    corners = [20.0, 20.0 + 0.5j, -20.0 + 0.5j, 20.0 + 0.5j]
    assert max(distance(point, corners) for point in of_face(bench)) < MICROMETRE


def test_manual_blocks_end_a_kinematics() -> None:
    scenario = """- {at: 0.1, to: channel, do: mdi, text: "#CAX\\nG00 X20 C0"}
- {at: 4.0, to: channel, do: mdi, text: "#CAX\\n#FACE [X, C]\\nG01 X10 C10 F2000"}
- {at: 8.0, to: channel, do: mdi, text: "G01 X12 F2000"}"""
    bench = MachineBench("M30\n", scenario, machine=LATHE).run(10.0)
    assert bench.events == []
    assert bench.position("x") == 12.0
    assert [offsets.systems for block in bench.blocks["channel"] for offsets in block.offsets][-1] == []


@pytest.mark.long
def test_replay_gives_the_same_again() -> None:
    bench = run(on_face(lines(HEXAGON)), "- {at: 2.0, to: channel, do: set_override, percent: 40}")
    again, first = replay(bench.machine, bench.records, len(bench.blocks["plc"])), bits(bench)
    for unit in ("channel", "s", "x", "z"):
        assert again[unit] == first[unit]


@pytest.mark.parametrize("kinematics", [Face(0, 2, (5.0, 1.0, 30.0), True), Cylinder(1, 2, 60.0, (5.0, 1.0, 30.0))])
def test_derivatives_are_those_of_the_positions(kinematics: Face | Cylinder) -> None:
    """Against central differences of the inverse along a curved path."""

    def programmed(u: float) -> list[tuple[float, float, float, float]]:
        return [
            (10.0 + u + 0.1 * u**3, 1.0 + 0.3 * u * u, 0.6 * u, 0.6),
            (2.0 * u, 2.0, 0.0, 0.0),
            (7.0 - 2.0 * u + 0.5 * u * u, -2.0 + u, 1.0, 0.0),
        ]

    def machine(u: float) -> tuple[float, ...]:
        return kinematics.inverse(tuple([q for q, _, _, _ in programmed(u)]), near)

    near, step = (20.0, 0.0, 60.0), 1e-2
    at = 0.3
    positions = [machine(at + n * step) for n in range(-2, 3)]
    for axis, (q, q1, q2, q3) in enumerate(kinematics.shape(programmed(at), near)):
        a, b, c, d, e = (position[axis] for position in positions)
        assert q == pytest.approx(c)
        assert q1 == pytest.approx((a - 8.0 * b + 8.0 * d - e) / (12.0 * step), rel=1e-5, abs=1e-6)
        assert q2 == pytest.approx((-a + 16.0 * b - 30.0 * c + 16.0 * d - e) / (12.0 * step**2), rel=1e-4, abs=1e-5)
        assert q3 == pytest.approx((e - 2.0 * d + 2.0 * b - a) / (2.0 * step**3), rel=1e-2, abs=1e-2)
    assert kinematics.forward(machine(at)) == pytest.approx([q for q, _, _, _ in programmed(at)])
