"""The path of a compensated tool against exact distances to the contour and Shapely's offsets.

Shapely's buffer is used for contours of lines alone: of arcs that are polygons with short chords it drops concave parts
(GEOS simplifies what it offsets). There its distances are used, and this argument: a closed curve that does not cross
itself and is at the distance of the radius from the contour everywhere is all of that offset.
"""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from random import Random

import numpy as np
import pytest
import shapely
from contour_support import Edge, distances, edges_of, polygon, random_contour, words
from long_support import examples, long
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


@pytest.mark.long
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
    for seed, contour, _, radius in cases(lines_only=False)[: examples(60)]:
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


@pytest.mark.long
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


CLOSED = {
    "tool inside, overlap past the start": (5.0, "G41 G01 X20 Y0\nX40\nY30\nX0\nY0\nX25\nG40 Y15", (20.0, 15.0)),
    "tool outside, lines longer than their edges": (
        5.0,
        "G42 G01 X-10 Y0\nX40\nY30\nX0\nY-10\nG40 X-20",
        (-20.0, -15.0),
    ),
    "three edges, lines longer than their edges": (
        4.0,
        "G42 G01 X-8 Y0\nX40\nX20 Y30\nX-5 Y-7.5\nG40 X-20",
        (-20.0, -15.0),
    ),
    "circle, half of an arc to it and from it": (
        5.0,
        "G41 G01 X12 Y-12\nG03 X20 Y-20 I8 J0\nG03 X20 Y-20 I0 J20\nG03 X28 Y-12 I0 J8\nG40 G01 X20 Y-10",
        (20.0, -10.0),
    ),
    "circle from outside, arcs to it and from it": (
        5.0,
        "G42 G01 X12 Y-28\nG02 X20 Y-20 I8 J0\nG03 X20 Y-20 I0 J20\nG02 X28 Y-28 I0 J-8\nG40 G01 X20 Y-40",
        (20.0, -40.0),
    ),
    "pocket, arcs to it and from it behind the start": (
        3.0,
        "G41 G01 X14 Y6\nG03 X20 Y0 I6\nG01 X40\nY30\nX0\nY0\nX23\nG03 X29 Y6 J6\nG40 G01 X20 Y15",
        (20.0, 15.0),
    ),
    "triangle from inside, arcs to it and from it": (
        3.0,
        "G41 G01 X15 Y5\nG03 X20 Y0 I5\nG01 X50\nX20 Y40\nX-10 Y0\nX20\nG03 X25 Y5 J5\nG40 G01 X20 Y12",
        (20.0, 12.0),
    ),
}
"""Radius, program, and where it starts. The edges bound one area, the rest leads to it and from it."""
INSIDE = [name for name, (_, text, _) in CLOSED.items() if "G41" in text]


@pytest.mark.parametrize("name", CLOSED)
@pytest.mark.parametrize("look_ahead", [50, *long([5])])
def test_a_closed_contour_with_overruns_is_machined_as_a_whole(name: str, look_ahead: int) -> None:
    """All of Shapely's offset of the edges, and no point of the path is nearer to one."""
    radius, text, start = CLOSED[name]
    tools, settings = ToolTable({1: Tool(radius=radius)}, True), RadiusSettings(look_ahead=look_ahead)
    head = f"D1 G00 X{start[0]} Y{start[1]} F600\n"
    path = edges_of(run(head + text, tools=tools, radius=settings))[1:]
    contour = edges_of(run(head + text.replace("G41 ", "").replace("G42 ", ""), tools=tools))[2:-1]
    walls = bounds(contour)
    [area] = shapely.polygonize([walls]).geoms
    points = np.vstack([edge.points(101) for edge in path[1:-1]])
    assert shapely.distance(walls, shapely.points(points)).min() > radius - 2.0 * GRID
    machined = shapely.union_all([shapely.LineString(edge.chords()) for edge in path[1:-1]])
    if name in INSIDE:
        ring = area.buffer(-radius, quad_segs=2000).exterior
        assert shapely.distance(machined, shapely.points(ring.coords)).max() < 5.0 * GRID
    else:  # at the corner of the start the lines cross outside of the arc
        samples = [walls.interpolate(part, normalized=True) for part in np.linspace(0.0, 1.0, 400)]
        assert shapely.distance(machined, samples) == pytest.approx(np.full(400, radius), abs=2.0 * GRID)
    for before, behind in pairwise(path):
        assert before.end == pytest.approx(behind.start, abs=EXACT)


def test_an_overrun_of_the_wrong_side_is_refused() -> None:
    """The tool would come through the wall of a pocket, and out of it through another one."""
    text = "D1 G00 X-30 Y0 F600\nG41 G01 X-10 Y0\nX40\nY30\nX0\nY-10\nG40 Y-30"
    with pytest.raises(ProgramError) as error:
        run(text, tools=ToolTable({1: Tool(radius=5.0)}, True))
    assert error.value.number == 21685
    assert str(error.value).endswith(
        "comes as near as 0.156 mm to line 6 'Y-10', its radius is 5 mm: it does not fit between them"
    )


def test_a_contour_that_continues_where_it_seemed_to_close_is_refused() -> None:
    """With five elements known the tool would be past the first one; the sixth is what leads away, but for the next."""
    text = "G41 G01 X15 Y5\nG03 X20 Y0 I5\nG01 X50\nX20 Y40\nX-10 Y0\nX20\nG03 X25 Y5 J5"
    tools = ToolTable({1: Tool(radius=3.0)}, True)
    head = "D1 G00 X20 Y12 F600\n"
    assert run(f"{head}{text}\nG40 G01 X20 Y12", tools=tools, radius=RadiusSettings(look_ahead=4))
    with pytest.raises(ProgramError) as error:
        run(f"{head}{text}\nG01 Y9\nG40 X20 Y12", tools=tools, radius=RadiusSettings(look_ahead=4))
    assert error.value.number == 21685


def test_a_corner_does_not_cut_into_the_arc_behind_it() -> None:
    """The tool rolls around the start of an arc that leads back inside the corner."""
    with pytest.raises(ProgramError) as error:
        run(
            "D1 G00 X-50 F600\nG41 G01 X0 Y0\nX0 Y3\nG03 X0 Y6 R-3\nG40 G01 X80",
            tools=ToolTable({1: Tool(radius=2.5)}, True),
        )
    assert error.value.number == 21685


def test_an_arc_of_which_nothing_is_left() -> None:
    """Its corner is joined to the next line; found by a random contour."""
    blocks = "G01 X4 Y0\nG03 X10 Y0 R-3\nG02 X16 Y0 R6\nG03 X16 Y4 R2\nG02 X16 Y-2 R-3\nG01 X12 Y-2\nG02 X12 Y0 R-2\nG01 X10 Y0"
    with pytest.raises(ProgramError) as error:
        run(
            f"D1 G00 X-50 F600\nG42 G01 X0 Y0\n{blocks}\nG40 X80",
            tools=ToolTable({1: Tool(radius=1.0)}, True),
            radius=ALL,
        )
    assert error.value.number == 21686


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


GRID = 1e-5
"""mm: on such a grid Shapely finds where a contour touches itself."""


def bounds(contour: list[Edge]) -> shapely.Geometry:
    """What of a contour bounds an area, by Shapely."""
    lines = [shapely.LineString(edge.chords()) for edge in contour if edge.centre or edge.start != edge.end]
    areas = shapely.polygonize([shapely.union_all(lines, grid_size=GRID)])
    return shapely.union_all([area.boundary for area in areas.geoms])


@pytest.mark.parametrize("corners", ["G25", "G26"])
def test_no_point_of_a_path_is_nearer_than_the_radius(corners: str) -> None:
    """Whatever the contour is: the path keeps its distance, or the program is refused by a number of its own.

    Of a contour that closes, from what bounds an area: the rest are its overruns.
    """
    clear = overran = 0
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
        points = np.vstack([edge.points(21) for edge in path])
        if distances(contour, points).min() > radius - EXACT:
            clear += 1
            continue
        walls = bounds(contour)
        assert not walls.is_empty, seed
        assert shapely.distance(walls, shapely.points(points)).min() > radius - 2.0 * GRID, seed
        overran += 1
    assert clear > 100
    assert overran > 0
