"""What `bench web` takes from the recording of its run."""

from __future__ import annotations

from pathlib import Path

import pytest
from lateness_support import write_lateness

from bench.lateness import lateness_p99, told

SECOND = 1_000_000_000


@pytest.mark.motion_unchecked("messages of one topic, of no machine")
def test_the_lateness_is_that_of_the_latest_node_while_the_scopes_were_looked_at(tmp_path: Path) -> None:
    """A hundred blocks a second: late by 90 ms in the first second, by 2 ms (y: 7.25 ms) in those that count, then by 50."""
    path, late = tmp_path / "run.mcap", [2_000] * 6
    late[0], late[5] = 90_000, 50_000
    write_lateness(path, [{"x": each, "y": 7_250 if each == 2_000 else each} for each in late])
    assert lateness_p99(told(path), SECOND + 1, 5 * SECOND + 1) == 7.3  # the upper end of its step
    assert lateness_p99(told(path), 5 * SECOND + 1, 7 * SECOND) == 50.1
