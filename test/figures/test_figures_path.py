"""The pictures of docs/path.md show what their captions say, by Shapely and by the limits of the machine file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from figure_support import SCENARIOS, head_and_scenario, run_of, texts_of
from shapely import LineString, Point

from cnc_ptp.plots.svg import svg_text
from figures.circle import named_turns
from figures.kinds import draw
from figures.over_path import path_columns
from figures.run import run_figure
from figures.scenario_head import FigureError, read_head

PROGRAM = "%P\nN10 G01 X5 F1000\nM30\n"


def test_each_corner_uses_its_tolerance() -> None:
    run, head = run_of("path_corners"), read_head(SCENARIOS / "path_corners.yaml")
    path = path_columns(head, run)
    places = np.column_stack([run.column(axis, "set_position") for axis in "xy"])[path.moving]
    programmed = LineString([(0, 0), (20, 0), (20, 20)])
    velocities = []
    for (name, blocks), tolerance in zip(named_turns(head), (0.1, 0.03, 0.01), strict=True):
        assert name == f"{tolerance:g} mm"
        chosen = np.isin(path.blocks, blocks)
        deviation = max(programmed.distance(Point(*place)) for place in places[chosen])
        assert 0.5 * tolerance < deviation <= tolerance * (1.0 + 1e-9)
        near = chosen & (np.hypot(places[:, 0] - 20.0, places[:, 1]) < 0.3)
        velocities.append(path.velocity[near].min())
    assert velocities[0] > velocities[1] > velocities[2] > 0.0


def test_the_contour_has_no_stop_and_keeps_the_limits() -> None:
    run, head = run_of("path_velocity"), read_head(SCENARIOS / "path_velocity.yaml")
    path = path_columns(head, run)
    assert path.velocity.min() > 0.0 and path.velocity.max() == pytest.approx(100.0)
    assert np.all(path.velocity <= path.feed + 1e-6) or path.feed.min() == pytest.approx(50.0)
    for name in head.axes:
        axis = run.machine.axes[name]
        acceleration, jerk = (np.abs(run.column(name, f"set_{field}")).max() for field in ("acceleration", "jerk"))
        assert acceleration <= max(axis.acceleration, axis.deceleration) * (1.0 + 1e-6)
        assert 0.9 * axis.jerk < jerk <= axis.jerk * (1.0 + 1e-6)


def refused(folder: Path, text: str, **head: str) -> str:
    (folder / "p.nc").write_text(text)
    keys = {"title": "t", "caption": "c", "machine": "config/mill.yaml", **head}
    figure = read_head(head_and_scenario(folder, keys, "[]\n"))
    with pytest.raises(FigureError) as caught:
        texts_of(svg_text(draw(figure, run_figure(figure)), title="t"))
    return str(caught.value)


@pytest.mark.parametrize("kind", ["corners", "over_path"])
def test_a_path_needs_a_program_and_two_axes(tmp_path: Path, kind: str) -> None:
    text = "figure move.yaml: a path needs 'program: ...' and two axes; no picture was drawn"
    assert refused(tmp_path, PROGRAM, kind=kind, axes="x", program="p.nc") == text
    keys = {"title": "t", "caption": "c", "machine": "config/mill.yaml", "axes": "x, y", "kind": kind}
    figure = read_head(
        head_and_scenario(tmp_path, keys, "- {at: 0, to: x, do: move_absolute, target: 5, velocity: 9}\n")
    )
    with pytest.raises(FigureError) as caught:
        draw(figure, run_figure(figure))
    assert str(caught.value) == text


def test_blocks_of_a_corner_that_do_not_move(tmp_path: Path) -> None:
    text = refused(tmp_path, PROGRAM, kind="corners", axes="x, y", program="p.nc", turns="a = N10; b = N20")
    assert text == "figure move.yaml: turns 'b': the program does not move there; no picture was drawn"


def test_a_program_that_does_not_move(tmp_path: Path) -> None:
    text = refused(tmp_path, "%P\nG04 0.1\nM30\n", kind="over_path", axes="x, y", program="p.nc")
    assert text == "figure move.yaml: its program does not move along a path; no picture was drawn"


LATHE = {"machine": "config/lathe.yaml", "axes": "x, z, s", "kind": "turned_part", "program": "p.nc"}


@pytest.mark.parametrize(
    ("head", "text"),
    [
        (
            {"machine": "config/mill.yaml", "axes": "x, y"},
            "a turned part needs 'program: ...' and a channel with X, Z and a C axis",
        ),
        ({"turns": "cut = N10 N99"}, "turns 'cut': the program is never in N10 and N99"),
        ({"turns": "cut = N10 N20"}, "none of its turns is drawn as Z over the length of arc in mm"),
    ],
)
def test_heads_that_make_no_turned_part(tmp_path: Path, head: dict[str, str], text: str) -> None:
    program = "%P\nN10 G01 X140 F2000\nN20 X141\nM30\n"
    assert refused(tmp_path, program, **{**LATHE, **head}) == f"figure move.yaml: {text}; no picture was drawn"
