"""The pictures of docs/threads.md and docs/caxis.md show what their captions say."""

from __future__ import annotations

import numpy as np
import pytest
from figure_support import SCENARIOS, head_and_scenario, run_of, texts_of

from cnc_ptp.plots.svg import svg_text
from cnc_ptp.recording.thread_passes import ThreadPass, phase_against, thread_passes
from figures.kinds import draw
from figures.recorded import recorded
from figures.run import run_figure
from figures.scenario_head import FigureError, read_head

PROGRAM = "%P\nN10 G01 X5 F1000\nM30\n"


def passes(name: str) -> list[ThreadPass]:
    run = run_of(name)
    return thread_passes(recorded(read_head(SCENARIOS / f"{name}.yaml"), run), run.machine)


@pytest.mark.long
def test_five_passes_lie_in_one_groove() -> None:
    found = passes("thread_longitudinal")
    assert len(found) == 5
    assert [phase_against(found[0], each) for each in found] == pytest.approx([0.0] * 5, abs=0.02)
    assert max(each.largest("actual_pitch_error") for each in found) < 0.0005


def test_two_starts_lie_half_a_turn_apart() -> None:
    first, second = passes("thread_two_starts")
    assert abs(phase_against(first, second)) == pytest.approx(180.0, abs=0.02)
    assert first.lead == pytest.approx(3.0)


def test_the_pitch_of_the_taper_counts_along_x() -> None:
    [each] = passes("thread_tapered")
    assert (each.axis, each.lead) == ("x", pytest.approx(5.0))


def test_a_tapped_hole_is_one_pass() -> None:
    [each] = passes("thread_tapping")
    assert np.ptp(each.position) == pytest.approx(
        50.0, abs=0.02
    )  # the drive does not quite reach the point of reversal
    assert each.largest("actual_pitch_error") < 0.0001


@pytest.mark.parametrize(
    ("name", "texts"),
    [
        ("thread_two_starts", ["pass 1", "pass 2", "actual position of Z in mm"]),
        pytest.param(
            "caxis_surfaces",
            ["#FACE [X, C]: y over x in mm", "#CYL [Z, C, X25]: Z over the circumference in mm"],
            marks=pytest.mark.long,
        ),
    ],
)
def test_pictures_name_what_they_show(name: str, texts: list[str]) -> None:
    found = texts_of(svg_text(draw(read_head(SCENARIOS / f"{name}.yaml"), run_of(name)), title=name))
    assert set(texts) <= set(found)


@pytest.mark.parametrize(
    ("kind", "reason"),
    [("thread", "its program cuts no thread"), ("surfaces", "its program needs #FACE and #CYL")],
)
def test_programs_without_such_motion_are_refused(tmp_path, kind: str, reason: str) -> None:
    (tmp_path / "part.nc").write_text(PROGRAM, encoding="utf-8")
    head = {"title": "T", "caption": "C", "machine": "config/mill.yaml", "axes": "x, y"}
    file = head_and_scenario(tmp_path, {**head, "program": "part.nc", "kind": kind}, "[]\n")
    figure = read_head(file)
    with pytest.raises(FigureError) as error:
        draw(figure, run_figure(figure))
    assert str(error.value) == f"figure move.yaml: {reason}; no picture was drawn"
