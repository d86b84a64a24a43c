"""The simulated probe of an axis: when and where its input switches, in blocks of any length."""

from __future__ import annotations

import pytest
from machine_support import axis_parameters

from cnc_ptp.axis.probe import Probe
from cnc_ptp.parameters.view.probe_view import ProbeParameters
from cnc_ptp.protocol.blocks import AxisBlock


def blocks(positions: list[float], count: int, offset: float = 0.0, **parameters: float) -> list[AxisBlock]:
    probe = Probe(ProbeParameters(measures=True, **parameters))
    made = []
    for first in range(0, len(positions), count):
        block = AxisBlock(first, count, actual_position=positions[first : first + count])
        probe.watch(block, offset)
        made.append(block)
    return made


@pytest.mark.parametrize("count", [1, 2, 5, 10])
def test_the_crossing_is_the_same_in_blocks_of_any_length(count: int) -> None:
    """A parabola: between two cycles the position is taken to go straight."""
    positions = [0.05 * n * n for n in range(20)]
    switched = [block for block in blocks(positions, count, above=2.0) if block.probe_switched]
    (block,) = switched
    assert block.first_cycle + block.probe_cycle == pytest.approx(6.0 + (2.0 - 1.8) / (2.45 - 1.8), abs=1e-12)
    assert block.probe_position == 2.0 and -1.0 <= block.probe_cycle < count


def test_both_surfaces_and_the_offset_of_the_coordinates() -> None:
    up, down = [0.0, 4.0, 8.0, 4.0, 0.0, -4.0, -8.0], 2.5
    made = blocks(up, 1, offset=down, above=3.0, below=-5.0)
    assert [block.probe_on for block in made] == [False, False, True, False, False, True, True]
    assert [(b.first_cycle, b.probe_cycle, b.probe_position) for b in made if b.probe_switched] == [
        (2, -1.0 + 1.5 / 4.0, 5.5),
        (5, -1.0 + 2.5 / 4.0, -2.5),
    ]


def test_only_the_first_switching_of_a_block_is_told() -> None:
    (block,) = blocks([0.0, 2.0, 0.0, 2.0], 4, above=1.0)
    assert block.probe_switched and block.probe_cycle == 0.5 and block.probe_on


def test_an_input_that_is_on_from_the_start_has_not_switched() -> None:
    first, second = blocks([5.0, 5.0, 0.0, 5.0], 2, above=1.0)
    assert first.probe_on and not first.probe_switched
    assert second.probe_switched and second.probe_cycle == pytest.approx(0.2)


def test_an_axis_that_does_not_measure_has_no_input() -> None:
    probe, block = Probe(axis_parameters().probe), AxisBlock(0, 2, actual_position=[-1e9, 1e9])
    probe.watch(block, 0.0)
    assert not block.probe_on and not block.probe_switched
