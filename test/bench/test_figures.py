"""Figures, goals and peers as text and as JSON."""

import json
from collections.abc import Iterator
from types import SimpleNamespace

import pytest
from click.testing import CliRunner
from rich.console import Console

from bench import __main__ as command
from bench.figures import Effort, Figure, ShowProgress, goal_text, median_of, medians_of, number, table


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (123456.7, "123,457"),
        (42.25, "42.2"),
        (5.234, "5.23"),
        (0.1234, "0.123"),
        (0.01234, "0.0123"),
        (-17.04, "-17.0"),
    ],
)
def test_numbers_keep_three_digits(value: float, text: str) -> None:
    assert number(value) == text


def test_a_goal_is_a_lower_bound_unless_said_otherwise() -> None:
    assert Figure("speed", 25.0, "×", goal=20.0).met
    assert not Figure("speed", 15.0, "×", goal=20.0).met
    assert Figure("time", 15.0, "ms", goal=20.0, at_most=True).met
    assert not Figure("time", 25.0, "ms", goal=20.0, at_most=True).met
    assert Figure("time", 25.0, "ms").met is None


def test_goal_and_aim_stand_beside_the_figure() -> None:
    assert str(goal_text(Figure("speed", 25.0, "×", goal=20.0, aim=50.0))) == "≥ 20.0, aim 50.0 met"
    assert str(goal_text(Figure("time", 25.0, "ms", goal=20.0, at_most=True))) == "≤ 20.0 not met"
    assert str(goal_text(Figure("time", 25.0, "ms"))) == ""


def test_ratio_to_the_peer() -> None:
    assert Figure("plan", 3.0, "µs", peer="other", peer_value=1.5).ratio == 2.0
    assert Figure("plan", 3.0, "µs").ratio is None


def test_goal_of_a_ratio():
    figure = Figure("plan", 3.0, "µs", goal=1.5, at_most=True, of_ratio=True, peer="other", peer_value=1.5)
    assert str(goal_text(figure)) == "ratio ≤ 1.50 not met"
    faster = Figure("plan", 1.5, "µs", goal=1.5, at_most=True, of_ratio=True, peer="other", peer_value=1.5)
    assert faster.met


def test_medians_are_taken_in_turn() -> None:
    order: list[str] = []
    values = iter([5.0, 1.0, 9.0])

    def first() -> float:
        order.append("first")
        return next(values)

    def second() -> float:
        order.append("second")
        return 2.0

    assert medians_of(3, [first, second]) == [5.0, 2.0]
    assert order == ["first", "second"] * 3
    assert median_of(1, lambda: 4.0) == 4.0


def test_table_shows_every_figure() -> None:
    console = Console(width=120)
    with console.capture() as capture:
        console.print(table("topic", [Figure("plan", 3.0, "µs", goal=8.0, at_most=True, peer="other", peer_value=1.5)]))
    assert "plan" in capture.get()
    assert "≤ 8.00 met" in capture.get()
    assert "other 1.50, ratio 2.00" in capture.get()


def test_command_prints_tables_and_writes_json(monkeypatch: pytest.MonkeyPatch, tmp_path) -> None:
    def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
        show("something")
        yield Figure("blocks", 70_000.0 * effort.runs, "blocks/s", goal=60_000.0)

    monkeypatch.setattr(command, "import_module", lambda name: SimpleNamespace(figures=figures))
    result = CliRunner().invoke(command.main, ["interpreter", "motion", "--short", "--json", str(tmp_path / "f.json")])
    assert result.exit_code == 0
    assert result.output.count("210,000") == 2
    written = json.loads((tmp_path / "f.json").read_text())
    assert written["effort"]["runs"] == 3
    assert written["figures"]["motion"][0]["met"] is True
    assert set(written["figures"]) == {"interpreter", "motion"}


def test_unknown_topic_is_refused() -> None:
    result = CliRunner().invoke(command.main, ["speed"])
    assert result.exit_code == 2
    assert "'speed' is not one of" in result.output
