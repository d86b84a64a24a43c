"""Target window: which cycle of standing says that the axis has not come into it."""

from __future__ import annotations

import pytest

from cnc_ptp.axis.target_window import TargetWindow


def overdue(window: TargetWindow, cycles: range, *, at: float = 0.0, target: float = 0.0) -> list[int]:
    """The cycles of `cycles` that are reported as overdue, with the setpoint at `target` and the axis at `at`."""
    return [cycle for cycle in cycles if window.overdue(cycle, target, at)]


def moved(*, window: float = 0.01, cycles: int = 50, target: float | None = None) -> TargetWindow:
    watched = TargetWindow(window=window, cycles=cycles)
    watched.watch(target)
    watched.moves()
    return watched


@pytest.mark.parametrize("cycles", [1, 50, 2000])
def test_told_once_after_its_time(cycles: int) -> None:
    window = moved(cycles=cycles)
    assert overdue(window, range(100, 5000), at=0.02) == [100 + cycles]


@pytest.mark.parametrize("at", [0.0, 0.01, -0.01])
def test_never_told_inside_the_window(at: float) -> None:
    assert overdue(moved(), range(100, 500), at=at) == []


def test_coming_into_the_window_in_time() -> None:
    window = moved()
    assert overdue(window, range(100, 150), at=0.02) == []
    assert overdue(window, range(150, 151), at=0.0) == []
    assert overdue(window, range(151, 500), at=5.0) == []  # it has been there


def test_a_time_of_0_switches_it_off() -> None:
    assert overdue(moved(cycles=0), range(100, 10_000), at=9.9) == []


def test_nothing_is_told_before_the_first_motion() -> None:
    window = TargetWindow(window=0.01, cycles=50)
    assert overdue(window, range(500), at=1.0) == []
    window.watch(100.0)
    assert overdue(window, range(500, 1000), at=0.0) == []


def test_a_pause_counts_from_its_own_begin() -> None:
    window = moved(target=10.0)
    assert overdue(window, range(100, 140), at=5.0) == []
    window.moves()
    assert overdue(window, range(200, 300), at=8.0) == [250]


def test_an_own_target_counts_and_not_the_setpoint() -> None:
    window = moved(target=10.0)
    assert window.reached(0.0, 10.005) and not window.reached(10.2, 10.2)
    assert window.error(10.2, 10.2) == pytest.approx(0.2)


def test_a_target_that_is_forgotten() -> None:
    window = moved(target=10.0)
    window.forget()
    assert not window.reached(10.0, 10.0)
    assert overdue(window, range(100, 500), at=0.0) == []
