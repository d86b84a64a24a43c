"""Positions within the modulo range and the set direction in recorded states, against exact arithmetic."""

from __future__ import annotations

import math
import random
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from long_support import long
from recording_support import Blocks, record

from cnc_ptp.commands.run.simulate import simulate
from cnc_ptp.recording.reader import read_recording

PTP = (Path(__file__).parents[2] / "config" / "ptp.yaml").read_text()
KINDS = ("set_position", "actual_position")


def exact(position: float, begin: float, length: float) -> float:
    """begin + the rest of whole lengths, of the numbers as they are stored."""
    p, b, n = Fraction(position), Fraction(begin), Fraction(length)
    return float(b + (p - b) - math.floor((p - b) / n) * n)


def states(path: Path, positions: list[float], begin: float, length: float, velocities: list[float]) -> np.ndarray:
    """The recorded states of an axis x that had these positions and velocities in the cycles of a block."""
    block = Blocks(1).axis(0, len(positions))
    block.set_position, block.actual_position = positions, positions[::-1]
    block.set_velocity, block.modulo_begin, block.modulo_length = velocities, begin, length
    record(path, [("x", block)])
    return read_recording(path).states["/x/state"]


@pytest.mark.parametrize(("begin", "length"), [(0.0, 360.0), (-180.0, 360.0), (12.5, 0.1), (-3.0, 500.0), (0.0, 1e-4)])
@pytest.mark.parametrize("seed", [0, *long(range(1, 4))])
def test_a_position_differs_from_its_modulo_value_by_whole_turns(
    begin: float, length: float, seed: int, tmp_path: Path
) -> None:
    choice = random.Random(seed)
    near = [begin + n * length + e for n in (-3, -1, 0, 1, 1000) for e in (0.0, 1e-13, -1e-13)]
    positions = near + [choice.uniform(-1e6, 1e6) for _ in range(50)] + [-5e-324, 5e-324, -0.0]
    rows = states(tmp_path / "run.mcap", positions, begin, length, [0.0] * len(positions))
    for kind in KINDS:
        endless, within = rows[kind], rows[f"{kind}_modulo"]
        assert (within >= begin).all() and (within < begin + length).all()
        turns = (endless - within) / length
        assert np.abs(turns - np.round(turns)).max() <= 1e-9 * np.abs(endless).max() / length + 1e-9
        for position, value in zip(endless.tolist(), within.tolist(), strict=True):
            off = abs(value - exact(position, begin, length))
            assert min(off, length - off) <= 4.0 * math.ulp(max(abs(position), abs(begin) + length))


@pytest.mark.parametrize(
    ("velocity", "direction"), [(0.0, 0), (-0.0, 0), (1e-300, 1), (-1e-300, -1), (2000.0, 1), (-0.5, -1)]
)
def test_direction_is_the_sign_of_the_set_velocity(velocity: float, direction: int, tmp_path: Path) -> None:
    positions = [0.0, -720.5, 1e9, 359.9]
    rows = states(tmp_path / "run.mcap", positions, 0.0, 0.0, [velocity] * 4)
    assert rows["set_direction"].tolist() == [direction] * 4
    for kind in KINDS:
        assert rows[f"{kind}_modulo"].tolist() == rows[kind].tolist()  # an axis without a modulo range


def conveyor(text: str) -> str:
    """config/ptp.yaml with x as a linear axis that counts modulo 0 … 500 mm, without soft limits."""
    head, rest = text.split("/x:", 1)
    axis, others = rest.split("/y:", 1)
    axis = axis.replace(", swe_neg: -1000000000, swe_pos: 1000000000}", ", achs_mode: 0x4}", 1)
    axis = axis.replace("kv: 50000", "kv: 50000\n        modulou: 0\n        moduloo: 5000000", 1)
    return f"{head}/x:{axis}/y:{others}"


def test_a_run_with_a_conveyor_and_a_turntable(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Workpieces every 500 mm: 600 mm on, then to station 50 backwards, then two lengths and 250; c likewise."""
    machine, scenario, recording = (tmp_path / name for name in ("machine.yaml", "s.yaml", "run.mcap"))
    machine.write_text(conveyor(PTP))
    scenario.write_text(
        "- {at: 0.05, to: x, do: move_relative, distance: 600}\n"
        "- {at: 0.05, to: c, do: move_modulo, position: -450}\n"
        "- {at: 2.0, to: x, do: move_modulo, position: -50}\n"
        "- {at: 4.0, to: x, do: move_modulo, position: 1250}\n"
    )
    assert simulate(str(machine), None, str(scenario), None, str(recording), strict=True) == 0
    assert "refused" not in capsys.readouterr().out
    read = read_recording(recording).states
    x, c = read["/x/state"], read["/c/state"]
    ends = [x[cycle] for cycle in (1990, 3990, -1)]
    assert [round(float(row["set_position"]), 9) for row in ends] == [600.0, 550.0, 1750.0]
    assert [round(float(row["set_position_modulo"]), 9) for row in ends] == [100.0, 50.0, 250.0]
    assert c["set_position"][-1] == -630.0 and c["set_position_modulo"][-1] == 90.0
    for rows, length in ((x, 500.0), (c, 360.0)):
        expected = [exact(position, 0.0, length) for position in rows["set_position"].tolist()]
        assert rows["set_position_modulo"].tolist() == pytest.approx(expected, abs=1e-9)
        moves = np.diff(rows["set_position"])
        for sign in (1, -1):  # where the cycles before and after it agree
            assert (rows["set_direction"][1:-1][(sign * moves[:-1] > 1e-9) & (sign * moves[1:] > 1e-9)] == sign).all()
    assert set(x["set_direction"].tolist()) == {-1, 0, 1}
