"""The six orders of axis, activation position and new target, in both directions, with their ties (TX1250 2.4)."""

from __future__ import annotations

import itertools

import pytest

from cnc_ptp.axis.two_stage import Request, Stage, velocity_stage

CASES = [
    # (Pos, APos, EPos) for the positive direction; the readings: what needs a stop first, then the printed order
    ((1.0, 2.0, 3.0), Stage.LATER),  # 1: Pos < APos < EPos
    ((2.0, 1.0, 3.0), Stage.NOW),  # 2: APos < Pos < EPos
    ((3.0, 1.0, 2.0), Stage.NEVER),  # 3: APos < EPos < Pos: stop and return
    ((1.0, 3.0, 2.0), Stage.NEVER),  # 4: Pos < EPos < APos
    ((3.0, 2.0, 1.0), Stage.NEVER),  # 5: EPos < APos < Pos: stop and return
    ((2.0, 3.0, 1.0), Stage.NEVER),  # 6: EPos < Pos < APos: stop and return
    ((1.0, 1.0, 2.0), Stage.LATER),  # Pos = APos < EPos: 1 before 2; at the first cycle at or past APos, so at once
    ((1.0, 2.0, 2.0), Stage.LATER),  # Pos < APos = EPos: 1 before 4; it comes to nothing, the way is over there
    ((2.0, 1.0, 2.0), Stage.NEVER),  # APos < Pos = EPos: 3 before 2
    ((2.0, 1.0, 1.0), Stage.NEVER),  # APos = EPos < Pos: 3 before 5
    ((2.0, 2.0, 1.0), Stage.NEVER),  # EPos < Pos = APos: 5 before 6
    ((2.0, 3.0, 2.0), Stage.NEVER),  # EPos = Pos < APos: 6 before 4
    ((1.0, 1.0, 1.0), Stage.NEVER),
]


@pytest.mark.parametrize(("positions", "stage"), CASES)
@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("offset", [0.0, -100.0, 1e6])
def test_six_cases(positions: tuple[float, float, float], stage: Stage, direction: float, offset: float) -> None:
    at, activation, target = (offset + direction * place for place in positions)
    assert velocity_stage(direction, at, Request(target, 500.0, activation)) is stage


def test_the_cases_are_all_that_there_are() -> None:
    """Every order of three places, equal ones included, is among them (ranks 1 to 3)."""

    def ranks(places: tuple[float, ...]) -> tuple[int, ...]:
        return tuple(sorted(set(places)).index(place) for place in places)

    orders = {ranks(places) for places in itertools.product((1.0, 2.0, 3.0), repeat=3)}
    assert {ranks(places) for places, _ in CASES} <= orders
    assert orders - {ranks(places) for places, _ in CASES} == set()


def test_without_a_velocity_there_is_nothing_to_activate() -> None:
    assert velocity_stage(1.0, 0.0, Request(10.0)) is Stage.NEVER
