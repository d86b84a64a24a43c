"""A source that is no text: found by `python -m bench.random_commands 200 8`, in which the channel then broke off."""

from __future__ import annotations

import pytest
from machine_support import spindle_bench


def test_a_source_that_is_no_text_gets_no_answer_in_the_block() -> None:
    bench = spindle_bench()
    text = bench.refused("start", direction="cw", speed_rpm=100.0, source=1e300)
    assert text == "P-ERR-22001 spindle s: start refused: source = 1e+300 is not a source; nothing was changed"
    bench.run(10)
    assert bench.last.refused == []


def test_a_source_that_is_a_text_gets_it() -> None:
    bench = spindle_bench()
    bench.refused("start", direction="cw", speed_rpm=-1.0, source="channel")
    bench.run(10)
    assert [(refusal.source, refusal.number) for refusal in bench.last.refused] == [("channel", 24001)]


def test_a_source_that_the_machine_does_not_have_gets_none() -> None:
    """Not a number is a text in recordings: `bench.random_commands` with seed 22 found that a replay had one more."""
    bench = spindle_bench()
    bench.unit.sources = ["plc", "channel"]
    text = bench.refused("stop", source="nan")
    known = "nothing was changed. Known: plc, channel"
    assert text == f"P-ERR-22001 spindle s: stop refused: unknown source 'nan'; {known}"
    bench.refused("start", direction="cw", speed_rpm=-1.0, source="channel")
    bench.run(10)
    assert [refusal.source for refusal in bench.last.refused] == ["channel"]


@pytest.mark.parametrize("command", ["follow_path", "leave_path"])
def test_a_path_without_a_source_is_refused(command: str) -> None:
    """Found by `bench.fuzz command`."""
    text = f"P-ERR-22001 spindle s: {command} refused: argument 'source' is missing; nothing was changed"
    assert spindle_bench().refused(command) == text
