"""The path of a compensated tool against exact distances to the contour and Shapely's offsets.

Shapely's buffer is used for contours of lines alone: of arcs that are polygons with short chords it drops concave parts
(GEOS simplifies what it offsets). There its distances are used, and this argument: a closed curve that does not cross
itself and is at the distance of the radius from the contour everywhere is all of that offset.
"""

from __future__ import annotations

from functools import cache
from random import Random

import numpy as np
import pytest
import shapely
from contour_support import Edge, distances, edges_of, polygon, random_contour, words
from nc_support import TABLES, run

from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.radius.radius_state import RadiusSettings
from cnc_ptp.parameters import Tool, ToolTable

EXACT = 1e-6
"""mm: the requirement."""
CONTOURS = 200
ALL = RadiusSettings(look_ahead=50)
"""All elements of a contour are known."""


def program(contour: list[Edge], code: str) -> str:
    x, y = contour[0].start
    return "\n".join(["D1 G00 X0 Y0 F600", f"{code} G01 X{x:.6f} Y{y:.6f}", *map(words, contour), "G40 G01 X0 Y0"])


def path_of(contour: list[Edge], code: str, radius: float, settings: RadiusSettings = ALL) -> list[Edge]:
    """The path along a contour, without the motions to it and from it."""
    tools = ToolTable({1: Tool(radius=radius)}, True)
    return edges_of(run(program(contour, code), tools=tools, radius=settings))[1:-1]


@cache
def cases(*, lines_only: bool) -> list[tuple[int, list[Edge], list[Edge], float]]:
    """Seed, contour, path, and signed radius of contours into which the tool fits."""
    found, refused, seed = [], 0, 0
    while len(found) < CONTOURS:
        seed += 1
        random = Random(seed)
        contour = random_contour(random, lines_only=lines_only)
        if contour is None:
            continue
        left, radius = random.random() < 0.5, round(random.uniform(0.5, 4.0), 3)
        try:
            path = path_of(contour, "G41" if left else "G42", radius)
        except ProgramError as error:
            assert error.number in (90017, 21685, 21686), error
            refused += 1
            continue
        found.append((seed, path_of(contour, "G40", radius), path, -radius if left else radius))
    assert refused < CONTOURS / 4
    return found


def test_two_hundred_contours_of_lines_and_arcs_by_distances() -> None:
    for seed, contour, path, radius in cases(lines_only=False):
        points = np.vstack([edge.points(33) for edge in path])
        assert np.abs(distances(contour, points) - abs(radius)).max() < EXACT, seed
        area = polygon(contour)
        apart = shapely.distance(area.exterior, shapely.points(points))
        assert np.abs(apart - abs(radius)).max() < EXACT, seed
        assert (area.contains(shapely.points(points)) == (radius < 0.0)).all(), seed
        offset = polygon(path)
        assert offset.is_valid, seed
        assert path[0].start == pytest.approx(path[-1].end, abs=10.0 * EXACT), seed  # the middle of a line is rounded


@pytest.mark.parametrize("command", ["#FACE [X, C]", "#CYL [X, C, X20]"])
def test_contours_on_the_face_and_on_the_cylinder(command: str) -> None:
    """The plane is that of the Cartesian words, whatever G17 to G19 say."""
    for seed, contour, _, radius in cases(lines_only=False)[:60]:
        code, tools = "G41" if radius < 0.0 else "G42", ToolTable({1: Tool(radius=abs(radius))}, True)
        tool, *text = program(contour, code).replace("Y", "C").split("\n")
        text = ["D1", "#CAX", command, f"G19 {tool.removeprefix('D1 ')}", *text]
        blocks = run("\n".join(text), axes=("X", "C"), spindles=TABLES["c_axis"], tools=tools, radius=ALL)
        path = edges_of(blocks)[1:-1]
        points = np.vstack([edge.points(33) for edge in path])
        assert np.abs(distances(contour, points) - abs(radius)).max() < EXACT, seed
        inside = polygon(contour).contains(shapely.points(points))
        assert (inside == (radius < 0.0)).all(), seed
        assert all(block.motion.kinematics.name == command for block in blocks if block.motion is not None)


def test_a_mirrored_face_has_the_path_of_the_mirrored_contour() -> None:
    """Left of the drawing is right of the contour then; the mirrored program with the other code says so, too."""
    head = "G18 D1\n#CAX\nG00 X30 C0\n#FACE [X, C]\n"
    programs = (
        head + "G21 X-30\nG41 G01 X-20 C-10 F600\nC10\nX0 C20\nG40 X30",
        head + "G42 G01 X20 C-10 F600\nC10\nX0 C20\nG40 X-30",
    )
    options = {"spindles": TABLES["c_axis"], "tools": ToolTable({1: Tool(radius=3.0)}, True)}
    mirrored, plain = (edges_of(run(text, axes=("X", "C", "Z"), **options)) for text in programs)
    assert mirrored[1:] == plain[1:]


def test_two_hundred_contours_of_lines_by_shapelys_offset() -> None:
    for seed, contour, path, radius in cases(lines_only=True):
        ring = polygon(contour).buffer(radius, quad_segs=2000).exterior
        points = np.vstack([edge.points(33) for edge in path])
        assert shapely.distance(ring, shapely.points(points)).max() < EXACT, seed
        assert distances(path, np.array(ring.coords)).max() < EXACT, seed


def test_few_known_elements_give_the_same_path_or_refuse() -> None:
    """With 5 elements known, narrow places between elements further apart are not found; the rest is the same."""
    for seed, contour, path, radius in cases(lines_only=False)[:100]:
        side = "G41" if radius < 0.0 else "G42"
        ends = [edge.end for edge in path_of(contour, side, abs(radius), RadiusSettings())]
        assert np.array(ends) == pytest.approx(np.array([edge.end for edge in path]), abs=1e-9), seed


def random_lines(random: Random) -> list[str]:
    """A contour on a grid, on which elements touch, repeat and lead back along themselves."""
    grid, x, y, blocks = random.choice((1, 2, 5)), 0, 0, ["G01 X0 Y0"]
    for _ in range(random.randint(2, 9)):
        u, v = random.choice(((x + random.randint(-3, 3) * grid, y), (x, y + random.randint(-3, 3) * grid)))
        chord, code = abs(u - x) + abs(v - y), random.choice((1, 1, 1, 2, 3))
        radius = chord / 2.0 * random.choice((1.0, 1.2, 2.0)) * random.choice((1.0, -1.0))
        if code == 1:
            blocks.append(f"G01 X{u} Y{v}")
        elif chord:
            blocks.append(f"G0{code} X{u} Y{v} R{radius:.7f}")
        else:
            blocks.append(f"G0{code} X{u} Y{v} I{random.choice((2, 6, -7))}")
        x, y = u, v
    return blocks


@pytest.mark.parametrize("corners", ["G25", "G26"])
def test_no_point_of_a_path_is_nearer_than_the_radius(corners: str) -> None:
    """Whatever the contour is: the path keeps its distance, or the program is refused by a number of its own."""
    clear = 0
    for seed in range(400):
        random = Random(seed)
        blocks, radius, side = random_lines(random), random.choice((0.5, 1.0, 2.0, 2.5, 5.0)), random.choice((41, 42))
        tools = ToolTable({1: Tool(radius=radius)}, True)
        text = "\n".join([f"D1 {corners} G00 X-50 Y-60 F600", f"G{side} {blocks[0]}", *blocks[1:], "G40 G01 X80 Y90"])
        try:
            path = edges_of(run(text, tools=tools, radius=ALL), (-50.0, -60.0))[1:-1]
        except ProgramError as error:
            assert error.number in (90017, 21682, 21685, 21686), (seed, error)
            continue
        contour = edges_of(run(text.replace(f"G{side} ", ""), tools=tools), (-50.0, -60.0))[1:-1]
        assert distances(contour, np.vstack([edge.points(21) for edge in path])).min() > radius - EXACT, seed
        clear += 1
    assert clear > 100
